// Many poses and the measured motions between them, some of which may be false: a robust pose graph.
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

// A measured relative pose.
struct GraphLink {
  int fixed = 0;
  int moving = 0;
  Pose fixed_from_moving;
  // Inverse covariance for Pose::moved (rotation, translation), fixed frame, rad^-2 and m^-2; it may lack
  // rank.
  Matrix6d information = Matrix6d::Zero();
  bool doubted = false;  // may be false (a loop closure), and is then left out
};

struct PoseGraphSettings {
  // Beyond this square of deviations, in six dimensions together, a doubted link is false: what a right one
  // exceeds once in a thousand (chi-square, six degrees of freedom).
  double false_beyond = 22.46;
  // Deviations that every link has beside its own: surfaces are never as good as their noise says. Ours.
  double excess_m = 0.005;
  double excess_rad = 0.02 * kDegree;
};

struct PoseGraphResult {
  std::vector<Pose> poses;  // world_from_scan
  // Of the doubted links, one a link of the input: the square of the deviations by which it missed the rest
  // when its turn came; 0 for the others.
  std::vector<double> misclosure;
  std::vector<int> rejected;  // links, ascending
};

// The poses that fit the links best, `held` ones as they start. First from the links beyond doubt; then the
// doubted ones are taken one by one, those first that fit best, each only where it misses what was taken
// before by no more than both their covariances allow (after Latif, Cadena and Neira 2013, who realise and
// reverse clusters of closures). What no link ties to a held pose keeps its start. Grows with the doubted
// links times the size of the graph. Throws std::invalid_argument where sizes differ or a link joins no two
// poses. Error: the equations could not be solved.
Result<PoseGraphResult> solvePoseGraph(const std::vector<Pose>& starts, const std::vector<char>& held,
                                       const std::vector<GraphLink>& links,
                                       const PoseGraphSettings& settings = {});

}  // namespace tiltmap
