#include "hardware/transport/clock.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>

namespace tiltmap {

namespace {

// Where virtual time begins: 2026-01-01 00:00 UTC.
constexpr double kVirtualEpoch = 1767225600.0;

}  // namespace

RealClock::RealClock(double speed)
    : speed_(speed),
      start_(std::chrono::steady_clock::now()),
      start_unix_s_(
          std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count()) {
  if (!(speed > 0.0) || !std::isfinite(speed))
    throw std::invalid_argument("RealClock: the speed must be a positive number");
}

Instant RealClock::now() const {
  const auto passed = std::chrono::steady_clock::now() - start_;
  if (speed_ == 1.0) return start_ + passed;
  return start_ + durationOf(secondsOf(passed) * speed_);
}

std::chrono::steady_clock::time_point RealClock::systemTime(Instant at) const {
  // A wait without end stays one, whatever the speed.
  if (at == kNever || speed_ == 1.0) return at;
  if (at <= start_) return start_;  // long ago, as for a question without waiting
  return start_ + durationOf(secondsOf(at - start_) / speed_);
}

void RealClock::sleepUntil(Instant until) {
  std::this_thread::sleep_until(systemTime(until));
}

double RealClock::unixTime(Instant at) const {
  return start_unix_s_ + secondsOf(at - start_);
}

double VirtualClock::unixTime(Instant at) const {
  return kVirtualEpoch + secondsOf(at.time_since_epoch());
}

std::chrono::steady_clock::time_point VirtualClock::systemTime(Instant) const {
  throw std::logic_error("VirtualClock: there is nothing to wait for outside of it");
}

bool VirtualClock::step(Instant limit) {
  Actor* first = nullptr;
  Instant when = limit;
  for (Actor* actor : actors_) {
    const Instant event = actor->nextEvent();
    if (event > limit || (first && event >= when)) continue;
    first = actor;
    when = event;
  }
  if (!first) {
    now_ = std::max(now_, limit);
    return false;
  }
  now_ = std::max(now_, when);
  first->act(now_);
  return true;
}

void VirtualClock::sleepUntil(Instant until) {
  if (until == kNever) throw std::logic_error("VirtualClock: a sleep without end");
  while (step(until)) {
  }
}

void VirtualClock::attach(Actor& actor) {
  actors_.push_back(&actor);
}

void VirtualClock::detach(Actor& actor) {
  std::erase(actors_, &actor);
}

}  // namespace tiltmap
