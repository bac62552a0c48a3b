// The tilt zero from the ground that the machine stands on.
//
// A wrong tilt zero turns every scan as a whole about its x axis, and a turned scan fits its neighbours as
// well as before: no overlap can tell it. What can is that the machine stands on the ground it maps: the
// ground at its wheels, as the scans together see it, has the direction of the scan frame's x and y axes, on
// average over the stops.
#pragma once

#include <span>
#include <vector>

#include "core/registration/prepared_scan.h"

namespace tiltmap {

// The ground under one stop, in its scan frame.
struct GroundUnderStop {
  int scan = 0;
  std::size_t points = 0;
  double pitch_rad = 0.0;      // what the tilt zero would have to grow by for the ground to be level in y
  double roll_rad = 0.0;       // likewise about y
  double deviation_rad = 0.0;  // of the pitch, from the points alone
};

struct GroundTilt {
  std::vector<GroundUnderStop> stops;  // whose ground is seen well enough
  double change_rad = 0.0;             // of the tilt zero: the mean of the pitches
  double deviation_rad = 0.0;          // of it, from how the stops differ
  double roll_rad = 0.0;               // mean, which no parameter of the scanner explains
};

// Prepared with cells (blocks of a matrix). `radius_m` about the scanner's foot counts as the ground that it
// stands on. Stops whose ground is hardly seen are left out; there may be none.
GroundTilt groundTilt(std::span<const PreparedScanPtr> scans, std::span<const Pose> world_from_scan,
                      double radius_m, int threads);

}  // namespace tiltmap
