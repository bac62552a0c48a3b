#include "core/registration/seen_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tiltmap {

SeenSpace::SeenSpace(const Scan& scan) : cell_(static_cast<std::size_t>(kRows * kColumns)) {
  if (!scan.image) return;
  const RangeImage& image = *scan.image;
  const std::vector<Eigen::Vector3d> points = cellPoints(image, scan.geometry);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!image.hasPoint(i)) continue;
    int row = 0, column = 0;
    cellOf(points[i], row, column);
    Returns& returns = cell_[static_cast<std::size_t>(row * kColumns + column)];
    const auto range = static_cast<float>(points[i].norm());
    if (returns.nearest_m <= 0.0F || range < returns.nearest_m) returns.nearest_m = range;
    returns.furthest_m = std::max(returns.furthest_m, range);
  }
}

void SeenSpace::cellOf(const Eigen::Vector3d& p, int& row, int& column) {
  constexpr double kHalf = std::numbers::pi, kFull = 2.0 * std::numbers::pi;
  const double from_x = std::atan2(std::hypot(p.y(), p.z()), p.x());
  const double about = std::atan2(p.z(), p.y());
  column = std::clamp(static_cast<int>(from_x / kHalf * kColumns), 0, kColumns - 1);
  row = std::clamp(static_cast<int>((about < 0.0 ? about + kFull : about) / kFull * kRows), 0, kRows - 1);
}

SeenPlace SeenSpace::placeOf(const Eigen::Vector3d& p, double margin_m) const {
  if (!p.allFinite()) return SeenPlace::Unknown;
  int row = 0, column = 0;
  cellOf(p, row, column);
  if (cell_[static_cast<std::size_t>(row * kColumns + column)].nearest_m <= 0.0F) return SeenPlace::Unknown;
  float nearest = 0.0F, furthest = 0.0F;
  for (int r = row - 1; r <= row + 1; ++r) {
    const int wrapped = (r + kRows) % kRows;
    for (int c = std::max(0, column - 1); c <= std::min(kColumns - 1, column + 1); ++c) {
      const Returns& returns = cell_[static_cast<std::size_t>(wrapped * kColumns + c)];
      if (returns.nearest_m <= 0.0F) continue;
      if (nearest <= 0.0F || returns.nearest_m < nearest) nearest = returns.nearest_m;
      furthest = std::max(furthest, returns.furthest_m);
    }
  }
  const double range = p.norm();
  if (range < static_cast<double>(nearest) - margin_m) return SeenPlace::Through;
  if (range > static_cast<double>(furthest) + margin_m) return SeenPlace::Behind;
  return SeenPlace::Near;
}

}  // namespace tiltmap
