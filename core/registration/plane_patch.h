// When a group of points counts as a plane, and what is known of it then: shared by all patch builders.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/registration/surface_elements.h"

namespace tiltmap {

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
