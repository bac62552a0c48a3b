// How far the points of a scan lie from the surfaces that another scan of the same stop saw.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "core/scan/range_image.h"

namespace tiltmap::test {

struct MapDistance {
  double median_m = 0.0, ninety_m = 0.0;  // half and nine tenths of the points are nearer
  int points = 0;
};

// Both scans in the same frame; the fixed one's lines at their nominal tilts. Points whose surroundings in
// the fixed scan are no plane (edges, vegetation) do not count.
inline MapDistance mapDistance(const Scan& fixed, const Scan& moving) {
  const auto model = cellPoints(*fixed.image, fixed.geometry);
  const auto data = cellPoints(*moving.image, moving.geometry);
  const RangeImage& image = *fixed.image;
  std::vector<double> distances;
  for (std::size_t cell = 0; cell < data.size(); ++cell) {
    if (!moving.image->hasPoint(cell)) continue;
    const auto place = fixed.geometry.place(data[cell]);
    if (!place) continue;
    const int row = static_cast<int>(std::lround(place->row)),
              column = static_cast<int>(std::lround(place->column));
    constexpr int kAcross = 2, kAlong = 3;
    if (row < kAcross || column < kAlong || row + kAcross >= image.rows() ||
        column + kAlong >= image.columns())
      continue;
    // A plane through the cells around, if all of them lie on it.
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    int count = 0;
    bool whole = true;
    for (int i = -kAcross; i <= kAcross && whole; ++i)
      for (int j = -kAlong; j <= kAlong && whole; ++j) {
        whole = image.hasPoint(row + i, column + j);
        if (whole) mean += model[image.index(row + i, column + j)], ++count;
      }
    if (!whole) continue;
    mean /= count;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (int i = -kAcross; i <= kAcross; ++i)
      for (int j = -kAlong; j <= kAlong; ++j) {
        const Eigen::Vector3d d = model[image.index(row + i, column + j)] - mean;
        spread += d * d.transpose();
      }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread / count);
    if (axes.eigenvalues()[0] > 0.02 * 0.02 || axes.eigenvalues()[1] < 0.05 * 0.05) continue;
    distances.push_back(std::abs(axes.eigenvectors().col(0).dot(data[cell] - mean)));
  }
  MapDistance result;
  result.points = static_cast<int>(distances.size());
  if (distances.empty()) return result;
  const auto at = [&](double share) {
    const auto place =
        distances.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(distances.size() - 1));
    std::nth_element(distances.begin(), place, distances.end());
    return *place;
  };
  result.median_m = at(0.5);
  result.ninety_m = at(0.9);
  return result;
}

}  // namespace tiltmap::test
