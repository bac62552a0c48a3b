#include "hardware/emulator/emulator_thread.h"

#include <algorithm>
#include <poll.h>

namespace tiltmap {

namespace {

// A byte every 20 microseconds is not worth a wake-up each: they go out in heaps, as from a USB adapter.
constexpr auto kShortest = std::chrono::microseconds(500);
// Commands from other threads are seen within this.
constexpr auto kLongest = std::chrono::milliseconds(20);

}  // namespace

EmulatorThread::EmulatorThread(RealClock& clock, std::vector<Instrument> instruments)
    : clock_(clock), instruments_(std::move(instruments)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

EmulatorThread::~EmulatorThread() = default;

void EmulatorThread::run(const std::stop_token& stop) {
  std::vector<pollfd> watched;
  while (!stop.stop_requested()) {
    Instant next = kNever;
    watched.clear();
    {
      const std::lock_guard lock(mutex_);
      const Instant now = clock_.now();
      for (const Instrument& instrument : instruments_) {
        instrument.actor->act(now);
        next = std::min(next, instrument.actor->nextEvent());
        if (instrument.wire && instrument.wire->descriptor() >= 0)
          watched.push_back({instrument.wire->descriptor(), POLLIN, 0});
      }
    }
    auto wait = std::chrono::steady_clock::duration(kLongest);
    if (next != kNever) wait = std::min(wait, clock_.systemTime(next) - std::chrono::steady_clock::now());
    wait = std::max<std::chrono::steady_clock::duration>(wait, kShortest);
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(wait);
    const timespec limit{seconds.count(), std::chrono::nanoseconds(wait - seconds).count()};
    ppoll(watched.data(), watched.size(), &limit, nullptr);
  }
}

}  // namespace tiltmap
