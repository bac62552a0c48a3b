// Starts that a person finds: from pairs of points they picked, or from a sweep of headings.
#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/registration/prepared_scan.h"

namespace tiltmap {

struct PointPairFit {
  Pose fixed_from_moving;
  std::vector<double> residual_m;  // one a pair: how far the moving point comes to lie from the fixed one
  double rms_m = 0.0;
};
// The motion that brings the picked points of the moving scan (its frame) onto those of the fixed one (its
// frame), metres. Error: fewer than three pairs, unequal numbers, points on a line, a coordinate that is not
// finite.
Result<PointPairFit> fitPointPairs(std::span<const Eigen::Vector3d> fixed,
                                   std::span<const Eigen::Vector3d> moving);

struct HeadingScore {
  double turned_rad = 0.0;  // against the start given, left positive, -pi to pi
  double score = 0.0;       // 0 to 1: share of the moving scan's elements that have a fitting partner there
};
struct HeadingSweep {
  std::vector<HeadingScore> scores;  // ascending by angle
  std::size_t best = 0;              // of equal ones that nearest to the start
  double step_rad = 0.0;

  const HeadingScore& bestScore() const { return scores[best]; }
};
struct HeadingSweepSettings {
  double step_rad = 3.0 * kDegree;
  double fitting_m = 0.3;  // loss scale at which pairs are sought and judged
};
// The moving scan turned on the spot all round, the pairs of each heading counted; nothing is moved
// otherwise. The scans are as prepared for `settings`. Error: cancelled, a start that is not finite, a step
// out of 0.1 to 90 degrees, a scan without elements.
Result<HeadingSweep> sweepHeadings(const PreparedScan& fixed, const PreparedScan& moving,
                                   const Pose& start_fixed_from_moving, const RegistrationSettings& settings,
                                   const HeadingSweepSettings& sweep = {}, const JobControl& control = {});
// The start with the moving scan turned on the spot.
Pose turnedStart(const Pose& start_fixed_from_moving, double turned_rad);

}  // namespace tiltmap
