// The scanner's intrinsic errors from ordinary overlapping scans, found together with their poses.
#pragma once

#include <string>
#include <vector>

#include "core/base/parameter.h"
#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/calibration/scanner_errors.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// Plain data, SI units. Describe and set it through calibrationParameters().
struct CalibrationSettings {
  bool tilt_zero = true;
  bool lever_arm = true;
  bool mounting = true;
  bool range_offset = true;
  double ground_radius_m = 1.0;  // about the machine's foot: the ground that it stands on
  // An estimate that is known worse than this is not taken.
  double angle_limit_rad = 0.1 * kDegree;
  double length_limit_m = 0.01;
};
const ParameterTable<CalibrationSettings>& calibrationParameters();

enum class EstimateState {
  Estimated,
  Held,       // not asked for
  Undefined,  // no scans of any kind tell it
  Weak,       // these scans do not tell it
};

struct ErrorEstimate {
  ScannerError error = ScannerError::TiltZero;
  EstimateState state = EstimateState::Held;
  double before = 0.0;     // rad or m
  double value = 0.0;      // the one before unless estimated
  double deviation = 0.0;  // one sigma; Weak: of what would have been estimated; else 0
  std::string reason;      // of any state but Estimated, a sentence for people
};

struct Calibration {
  ScannerGeometry geometry;  // with the estimated values; rows and steps of the first scan
  std::vector<Pose> poses;   // world_from_scan under that geometry, of the scans used: the rest keep theirs
  std::vector<ErrorEstimate> estimates;  // of every ScannerError, in their order
  double residual_before_m = 0.0;  // median of what cells are off the other scans' patches, poses relaxed
  double residual_after_m = 0.0;
  int scans = 0;            // used
  std::size_t links = 0;    // pairs of scans
  std::size_t patches = 0;  // that cells of another scan lie on
  int ground_stops = 0;     // whose ground told the tilt zero
  int iterations = 0;
  std::vector<std::string> warnings;
};

// Relaxes the scans from the poses given, then varies poses and errors together until each scan's cells lie
// on the others' plane patches, as evenly as they can; twice, so that pairs which fit only under the better
// geometry take part. Scan 0 stays where it is, unless the tilt zero turns it in itself: its pose stays.
//
// Not told by any overlap, and so not estimated from it: the lever arm's x (a shift of every scan along the
// tilt axis), the mounting's x (the same as the tilt zero with another lever arm), and the tilt zero itself,
// which comes from the ground (ground_tilt.h).
//
// Error: fewer than three scans, a scan that is no regular matrix or has another calibration than the first,
// no planes, too little overlap, all from one place, cancelled.
Result<Calibration> calibrate(const std::vector<Scan>& scans, const std::vector<Pose>& world_from_scan,
                              const CalibrationSettings& settings, int threads = 0,
                              const JobControl& control = {});

}  // namespace tiltmap
