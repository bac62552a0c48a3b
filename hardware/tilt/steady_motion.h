// A tilt that moves on at one speed while the scanner looks.
#pragma once

#include "hardware/transport/clock.h"

namespace tiltmap {

// From standing to standing with even ramps. Angles in radians, 0 level, positive up.
struct SteadyMotion {
  Instant start{};
  double from_rad = 0.0, to_rad = 0.0;
  double rate_rad_s = 0.0;  // between the ramps, never negative
  double ramp_s = 0.0;      // of each

  double duration() const;
  Instant end() const { return start + durationOf(duration()); }
  // The steady part.
  Instant steadyFrom() const { return start + durationOf(ramp_s); }
  Instant steadyTo() const { return end() - durationOf(ramp_s); }
  // Inside of the steady part; before and after it, of the line through it.
  double angle(Instant at) const;
  // When the line through the steady part has that angle.
  Instant when(double angle_rad) const;
  double signedRate() const { return to_rad < from_rad ? -rate_rad_s : rate_rad_s; }
};

// What a tilt unit can do of a rate that is wished.
struct SteadySpeed {
  double rate_rad_s = 0.0;  // 0: it cannot move steadily
  double ramp_s = 0.0;
  double play_rad = 0.0;  // of the gear: so far it has to move upwards before an angle counts
};

}  // namespace tiltmap
