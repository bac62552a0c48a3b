// Which of the points a picture shows while the camera moves.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ui/scene/point_layer.h"
#include "ui/scene/scan_points.h"

namespace tiltmap::ui {

using Eigen::Vector3d;

std::vector<std::size_t> PointLayer::fewOf(int side) const {
  // How much of each scan the camera sees, from its first points, which are spread over all of it.
  constexpr std::size_t kSample = 128;
  std::vector<double> seen(batches_.size(), 0.0);
  std::size_t total = 0;
  for (std::size_t i = 0; i < batches_.size(); ++i) {
    const PointBatch& batch = *batches_[i];
    if (!batch.visible) continue;
    total += batch.points->size();
    const Pose& world_from_scan = batch.world_from_scan[static_cast<std::size_t>(side)];
    const Eigen::Matrix4d clip_from_scan = look_.clip_from_world * world_from_scan.matrix();
    const std::size_t count = std::min(kSample, batch.points->size());
    std::size_t inside = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const float* xyz = batch.points->xyz.data() + 3 * k;
      const Eigen::Vector4d clip = clip_from_scan * Eigen::Vector4d(xyz[0], xyz[1], xyz[2], 1.0);
      if (!(clip.head<3>().cwiseAbs().maxCoeff() <= clip.w())) continue;
      if (look_.box && !look_.box->contains(world_from_scan * Vector3d(xyz[0], xyz[1], xyz[2]))) continue;
      ++inside;
    }
    // A scan of which none of them is seen may still have a corner in the picture.
    if (count > 0) seen[i] = std::max(static_cast<double>(inside), 0.25) / static_cast<double>(count);
  }
  const auto counts = [&](double density) {
    std::vector<std::size_t> result(batches_.size(), 0);
    for (std::size_t i = 0; i < batches_.size(); ++i)
      if (batches_[i]->visible) result[i] = batches_[i]->points->countAtDensity(density);
    return result;
  };
  const auto enough = [&](const std::vector<std::size_t>& some) {
    double inside = 0.0, all = 0.0;
    for (std::size_t i = 0; i < some.size(); ++i) {
      inside += seen[i] * static_cast<double>(some[i]);
      all += static_cast<double>(some[i]);
    }
    // Points out of the picture cost little, but not nothing.
    return inside >= static_cast<double>(budget_) || all >= 3.0 * static_cast<double>(budget_);
  };
  if (total <= budget_) return counts(std::numeric_limits<double>::infinity());
  double low = -30.0, high = 40.0;  // logarithms of the density
  for (int step = 0; step < 40; ++step) {
    const double middle = 0.5 * (low + high);
    (enough(counts(std::exp(middle))) ? high : low) = middle;
  }
  return counts(std::exp(high));
}

}  // namespace tiltmap::ui
