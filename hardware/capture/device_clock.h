// When something happened by an instrument's own clock, as an instant of ours.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "hardware/transport/clock.h"

namespace tiltmap {

// The instrument stamps its telegrams with ticks of a counter that wraps. Telegrams arrive late, never early:
// the least difference between arrival and stamp that was seen is what lies between the clocks, give or take
// the shortest way that a telegram may take. So a telegram that was held up on its way is not taken for a
// younger one.
class DeviceClock {
 public:
  // Ticks of so many seconds, counted modulo 2^bits. The clocks may drift apart by `drift` (seconds a
  // second).
  DeviceClock(double tick_s, int bits, double drift = 200e-6)
      : tick_s_(tick_s), mask_(bits >= 32 ? 0xFFFFFFFFU : (1U << bits) - 1U), drift_(drift) {}

  void reset() { last_.reset(); }

  // The instant of a stamp, told by the telegram that arrived just now: not before it was made, at most as
  // late as it arrived.
  Instant heard(std::uint32_t stamp, Instant arrival) {
    stamp &= mask_;
    if (!last_) {
      ticks_ = 0;
      offset_ = arrival;
    } else {
      // Forwards by less than half of the counter; backwards it was switched off and on.
      const std::uint32_t ahead = (stamp - *last_) & mask_;
      if (ahead > mask_ / 2) {
        ticks_ = 0;
        offset_ = arrival;
      } else {
        ticks_ += ahead;
        const Instant here = arrival - durationOf(static_cast<double>(ticks_) * tick_s_);
        const Instant drifted = offset_ + durationOf(drift_ * secondsOf(arrival - last_arrival_));
        offset_ = std::min(here, drifted);
      }
    }
    last_ = stamp;
    last_arrival_ = arrival;
    return offset_ + durationOf(static_cast<double>(ticks_) * tick_s_);
  }

  // From one stamp to a later one of the same counter.
  Duration between(std::uint32_t earlier, std::uint32_t later) const {
    return durationOf(static_cast<double>((later - earlier) & mask_) * tick_s_);
  }

 private:
  double tick_s_;
  std::uint32_t mask_;
  double drift_;
  std::optional<std::uint32_t> last_;
  std::int64_t ticks_ = 0;  // since the first stamp
  Instant offset_{};        // of that first stamp
  Instant last_arrival_{};
};

}  // namespace tiltmap
