// Matching a horizontal slice instead of the whole scan, as thesis 4.1 tells of and turns down.
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/registration/registration.h"

namespace tiltmap {

struct SliceSettings {
  double height_m = 0.5;        // of the slice above the scanner's origin
  double thickness_m = 0.3;     // points within half of it above and below count
  double max_distance_m = 5.0;  // at the start, then Zhang's; as the preset `thesis`
  double good_distance_m = 0.5;
  double min_change = 1e-3;
  int max_iterations = 100;
  int min_pairs = 12;
};

struct SliceStep {
  Pose fixed_from_moving;  // after the step: a turn about z and a shift in the plane
  double rms_m = 0.0;      // of the kept pairs before its motion
  std::size_t pairs = 0;
};
struct SliceResult {
  std::vector<Eigen::Vector3d> fixed, moving;  // the slices, scan frames, metres, laid flat (z = 0)
  Pose start;                                  // the planar part of the one given
  Pose fixed_from_moving;
  std::vector<SliceStep> steps;
  StopReason stop_reason = StopReason::TooFewPairs;
  bool succeeded() const { return isSuccess(stop_reason); }
};

// Point to point ICP in the plane (nearest point, Zhang's statistics, closed form). It is only right where
// the robot moves on level ground: height, roll and pitch stay zero whatever the scans say. Too few points in
// a slice is a result whose stop reason says so. Error: a scan without a matrix, a start that is not finite,
// a thickness or distance that is not positive.
Result<SliceResult> registerSlices(const Scan& fixed, const Scan& moving, const Pose& start_fixed_from_moving,
                                   const SliceSettings& settings = {});

// What the slice misses against the pose from the whole scans: fixed_from_moving of both.
struct SliceComparison {
  double shift_m = 0.0;      // in the plane
  double heading_rad = 0.0;  // not negative
  double height_m = 0.0;     // of the whole scans' pose: the slice has none
  double tilt_rad = 0.0;     // angle between the vertical axes, likewise
};
SliceComparison compareSlice(const Pose& slice, const Pose& whole);

}  // namespace tiltmap
