// What a registered pair must show to be trusted. Every default stands here as a member initialiser, once.
#pragma once

#include "core/base/parameter.h"
#include "core/geometry/pose.h"

namespace tiltmap {

// A figure within its `good` limit is no cause for doubt; beyond its `bad` one it condemns the pair.
struct JudgementSettings {
  // Of what both scans could see, the share that lies on each other, at least.
  double fit_good = 0.7, fit_bad = 0.5;
  // The share that stands where the other scan looked through, at most.
  double through_good = 0.02, through_bad = 0.06;
  // The share of the surfaces of one scan that lie on those of the other, at least, by the side that sees
  // more.
  double overlap_good = 0.1, overlap_bad = 0.05;
  // Their distance over what their own noise makes of it, medians, at most.
  double residual_good = 2.5, residual_bad = 8.0;
  // Deviation of the surfaces beyond what their own noise explains, at most.
  double excess_good_m = 0.02, excess_bad_m = 0.05;
  // Two deviations of the place and of the heading in the weakest direction, at most.
  double weak_good_m = 0.025, weak_bad_m = 0.3;
  double weak_good_rad = 0.3 * kDegree, weak_bad_rad = 3.0 * kDegree;
  // How far the surfaces still pull the pose, at most.
  double pull_good_m = 0.015, pull_bad_m = 0.06;
  double pull_good_rad = 0.15 * kDegree, pull_bad_rad = 0.6 * kDegree;
  // How far the pose lies from where the registration started, at most: a cause for doubt, never more.
  double moved_good_m = 4.0;
  double moved_good_rad = 40.0 * kDegree;
  // How far a link contradicts what the other links say, over what both are uncertain by, at most.
  double others_good = 2.5, others_bad = 5.0;
  // A difference smaller than both of these is no contradiction, however certain the links are of themselves.
  double others_least_m = 0.015, others_least_rad = 0.15 * kDegree;
  // Deviation that every link has beside its own: a scan is not quite rigid and undistorted.
  double others_floor_m = 0.002, others_floor_rad = 0.02 * kDegree;
  // Calibration: the covariance of the pose is so many times the inverse of the registration's information.
  double covariance_cells = 1.0;
  double covariance_patches = 1.0;
  // Below this overlap it grows as the overlap falls: few surfaces average nothing out.
  double covariance_overlap = 0.3;
};

// Descriptions, ranges and sources.
const ParameterTable<JudgementSettings>& judgementParameters();

}  // namespace tiltmap
