// Surface normals from the range matrix (thesis 4.2.2.2).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/scan/range_image.h"

namespace tiltmap {

// Equation 4.2.1 over the four neighbours: one slot a cell, unit and towards the scanner; zero where a cell or one
// of its neighbours holds no point, at the border, and near the poles, where the rows meet and the cross product
// is noise. `points` are cellPoints() of the same image.
std::vector<Eigen::Vector3d> matrixNormals(const RangeImage& image, const std::vector<Eigen::Vector3d>& points);

// Normals of an unordered cloud: the plane through the `neighbours` nearest points, towards `origin`; zero where
// fewer than three neighbours span a plane.
std::vector<Eigen::Vector3d> cloudNormals(const std::vector<Eigen::Vector3d>& points, int neighbours,
                                          const Eigen::Vector3d& origin);

}  // namespace tiltmap
