// How far estimated stops are from the true ones.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

struct StopError {
  std::size_t index = 0;
  double translation_error_m = 0.0;
  double rotation_error_deg = 0.0;  // angle of the rotation between the two, 0 to 180
};

struct TrajectoryEvaluation {
  std::vector<StopError> stops;  // one a stop; the first is zero by definition
  // Root of the mean square over all stops but the first: that one is the world in both trajectories, and
  // counting its zero would make a short survey look better than a long one.
  double rmse_translation_m = 0.0;
  double rmse_rotation_deg = 0.0;
};

// Both trajectories are world_from_scan, and are taken relative to their own first stop; they are not aligned
// in any other way, since scan 0 is the world of a map.
// Error: different numbers of stops, fewer than two, or a pose that is not finite.
Result<TrajectoryEvaluation> evaluateTrajectory(const std::vector<Pose>& estimated,
                                                const std::vector<Pose>& truth);

}  // namespace tiltmap
