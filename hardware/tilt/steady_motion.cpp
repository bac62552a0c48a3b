#include "hardware/tilt/steady_motion.h"

#include <cmath>

namespace tiltmap {

// The ramps together go as far as one of them at full speed.
double SteadyMotion::duration() const {
  return rate_rad_s > 0.0 ? std::abs(to_rad - from_rad) / rate_rad_s + ramp_s : 0.0;
}

double SteadyMotion::angle(Instant at) const {
  return from_rad + signedRate() * (secondsOf(at - start) - 0.5 * ramp_s);
}

Instant SteadyMotion::when(double angle_rad) const {
  if (!(rate_rad_s > 0.0)) return kNever;
  return start + durationOf(0.5 * ramp_s + (angle_rad - from_rad) / signedRate());
}

}  // namespace tiltmap
