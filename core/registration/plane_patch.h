// When a group of points counts as a plane, and what is known of it then: shared by all patch builders.
#pragma once

#include <Eigen/Core>

#include "core/registration/surface_elements.h"

namespace tiltmap {

// `values` are the eigenvalues of the group's covariance, ascending; `normal` the first eigenvector. Planar
// when the residual is below sqrt(2) sqrt((noise cos incidence)^2 + floor^2); metres, scan frame.
bool fitsPlane(const Eigen::Vector3d& mean, const Eigen::Vector3d& values, const Eigen::Vector3d& normal,
               double noise_m, double floor_m);

// Appends the patch of `count` points, its normal towards the scanner, its variances from its own residual.
// False, and nothing appended, where the points lie along a line and span no plane.
bool appendPatch(const Eigen::Vector3d& mean, const Eigen::Vector3d& values, const Eigen::Matrix3d& axes,
                 double count, SurfaceElements& out);

}  // namespace tiltmap
