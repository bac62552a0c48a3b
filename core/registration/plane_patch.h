// When a group of points counts as a plane, and what is known of it then: shared by all patch builders.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/registration/surface_elements.h"

namespace tiltmap {

inline constexpr double kResidualFloor_m = 0.002;  // no surface measured by us is known better, ours
inline constexpr double kOffsetFloor_m = 0.0005;   // nor a plane's place
inline constexpr double kPlaneFreedom = 3.0;       // degrees that a plane takes of its points
inline constexpr double kLongestSpot_m = 2.0;      // from 2 s to 2 s; an LMS' pulse is some 2.5 m long

// A covariance's eigenvalues, ascending, and its eigenvectors, a column each: unit, at right angles, of any
// sign.
struct PlaneAxes {
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

// For groups that are about planes: Newton's method finds the least root of the characteristic polynomial
// from below, and what is left is a quadratic. No trigonometry; several times faster than a solver for any
// matrix. `covariance` must be symmetric and not negative. Where the two smaller eigenvalues are nearly the
// same (points along a line), they may be off by a hundredth of themselves and their axes by any turn about
// the line.
PlaneAxes planeAxes(const Eigen::Matrix3d& covariance);

// A bound from below on the least eigenvalue, at least a third of it: the first of Newton's steps.
double leastResidual(const Eigen::Matrix3d& covariance);

// `values` are the eigenvalues of the group's covariance, ascending; `normal` the first eigenvector. Planar
// when the residual is below sqrt(2) sqrt((noise cos incidence)^2 + floor^2); metres, scan frame.
bool fitsPlane(const Eigen::Vector3d& mean, const Eigen::Vector3d& values, const Eigen::Vector3d& normal,
               double noise_m, double floor_m);

// How much too short the ranges of a slanted surface are to a scanner whose light has the deviation spot_rad
// across the beam, metres; nothing where the spot is drawn out longer than a pulse, so that it cannot be
// told.
std::optional<double> shortRange(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal, double spot_rad);

// What is known of a patch's residual before its points are seen: range noise, counting as much as so many
// points.
struct ResidualPrior {
  double noise_m = 0.0;  // along the beam
  double points = 0.0;   // 0: nothing is known
};

// Appends the patch of `count` points, more than three, its normal towards the scanner. Its variances come
// from its own residual, free of the three degrees of freedom that the plane took, and from the prior. False,
// and nothing appended, where the points lie along a line and span no plane.
bool appendPatch(const Eigen::Vector3d& mean, const Eigen::Vector3d& values, const Eigen::Matrix3d& axes,
                 double count, SurfaceElements& out, const ResidualPrior& prior = {});

}  // namespace tiltmap
