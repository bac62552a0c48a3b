#include "core/multiview/stop_map.h"

#include <algorithm>
#include <stdexcept>

namespace tiltmap {

void StopMap::add(const Scan& scan, const Pose& world_from_scan) {
  if (!world_from_scan.isFinite()) throw std::invalid_argument("StopMap::add: the pose is not finite");
  MapStop stop;
  stop.name = scan.name;
  stop.world_from_scan = world_from_scan;
  stop.prepared = prepare(scan, settings_);
  stop.judged = judgedScan(stop.prepared);
  stops_.push_back(std::move(stop));
}

void StopMap::setPose(std::size_t stop, const Pose& world_from_scan) {
  if (!world_from_scan.isFinite()) throw std::invalid_argument("StopMap::setPose: the pose is not finite");
  stops_.at(stop).world_from_scan = world_from_scan;
}

std::vector<std::size_t> StopMap::neighbours(const Eigen::Vector3d& place_m, std::size_t most,
                                             double within_m) const {
  std::vector<std::pair<double, std::size_t>> found;
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const double distance = (stops_[i].world_from_scan.translation() - place_m).norm();
    if (distance <= within_m || i + 1 == stops_.size()) found.emplace_back(distance, i);
  }
  std::ranges::sort(found);
  std::vector<std::size_t> chosen;
  for (const auto& [distance, stop] : found) {
    if (chosen.size() == most) break;
    chosen.push_back(stop);
  }
  if (!stops_.empty() && most > 0 && std::ranges::find(chosen, stops_.size() - 1) == chosen.end())
    chosen.back() = stops_.size() - 1;
  return chosen;
}

}  // namespace tiltmap
