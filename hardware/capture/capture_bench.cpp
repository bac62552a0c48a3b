#include "hardware/capture/capture_bench.h"

#include <thread>

namespace tiltmap {

namespace {

// What happens in virtual time is shown as slowly as it happened, or so many times as fast.
class PacedClock : public VirtualClock {
 public:
  explicit PacedClock(double speed) : speed_(speed) {}
  void sleepUntil(Instant until) override {
    VirtualClock::sleepUntil(until);
    std::this_thread::sleep_until(begun_ + durationOf(secondsOf(now() - Instant{}) / speed_));
  }

 private:
  double speed_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace

bool replays(const CaptureSettings& settings) {
  return settings.emulate == CaptureDrive::None && settings.scanner.find(":replay:") != std::string::npos &&
         settings.tilt.find(":replay:") != std::string::npos;
}

Result<std::unique_ptr<CaptureBench>> CaptureBench::open(const CaptureSettings& settings, int stops,
                                                         const AskOperator& ask) {
  auto bench = std::make_unique<CaptureBench>();
  if (tiltmap::replays(settings)) {
    const auto url = parseDeviceUrl(settings.scanner, scannerSchemes());
    if (!url) return fail(url.error());
    const auto speed = url->number("speed", 0.01, 1000.0);
    if (!speed) return fail(speed.error());
    bench->replay_clock_ = std::make_unique<PacedClock>(speed->value_or(1.0));
    auto replayed = replayedInstruments(settings.scanner, settings.tilt, *bench->replay_clock_);
    if (!replayed) return fail(replayed.error());
    bench->instruments_ = std::move(*replayed);
    return bench;
  }
  if (settings.emulate == CaptureDrive::None) {
    bench->clock_ = std::make_unique<RealClock>();
    auto named = namedInstruments(settings.scanner, settings.tilt, *bench->clock_, ask);
    if (!named) return fail(named.error());
    bench->instruments_ = std::move(*named);
    return bench;
  }
  auto experiment =
      Experiment::make(experimentOf(settings.emulate), static_cast<std::uint64_t>(settings.seed), stops);
  if (!experiment) return fail(experiment.error());
  bench->experiment_.emplace(*experiment);
  RigSettings rig;
  rig.start_rad = settings.start_rad;
  rig.step_rad = settings.step_rad;
  auto emulated = EmulatedBench::make(*experiment, rig, settings.speed, settings.baud);
  if (!emulated) return fail(emulated.error());
  bench->emulated_ = std::move(*emulated);
  bench->instruments_ = bench->emulated_->instruments();
  return bench;
}

Clock& CaptureBench::clock() {
  if (emulated_) return emulated_->clock();
  return replay_clock_ ? static_cast<Clock&>(*replay_clock_) : *clock_;
}

}  // namespace tiltmap
