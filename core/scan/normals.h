// Surface normals from the range matrix (thesis 4.2.2.2).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/scan/range_image.h"

namespace tiltmap {

// Equation 4.2.1 over the four neighbours: one slot a cell, unit and towards the origin (the scanner); zero
// where a cell or one of its neighbours holds no point, at the border, and near the poles, where the rows
// meet and the cross product is noise: there the two rows (or columns) are seen less than a fifth as far
// apart as on average. Zero also where the two differences are parallel. `points` are cellPoints() of the
// same image; another size throws std::invalid_argument. All zero for an unordered image.
std::vector<Eigen::Vector3d> matrixNormals(const RangeImage& image,
                                           const std::vector<Eigen::Vector3d>& points);

// Normals of an unordered cloud: the plane through the `neighbours` nearest points (the point itself is one
// of them), unit, towards `origin`; zero where they do not span a plane, that is lie on a line within a
// thousandth of its length. Throws std::invalid_argument for fewer than three neighbours or points that are
// not finite. The result does not depend on `threads` (0: all cores).
std::vector<Eigen::Vector3d> cloudNormals(const std::vector<Eigen::Vector3d>& points, int neighbours,
                                          const Eigen::Vector3d& origin, int threads = 1);

}  // namespace tiltmap
