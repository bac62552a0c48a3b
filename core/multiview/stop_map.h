// The stops scanned so far with their poses: what the next one is registered against while it is scanned.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/registration/pair_judgement.h"

namespace tiltmap {

struct MapStop {
  std::string name;
  Pose world_from_scan;
  PreparedScanPtr prepared;
  JudgedScanPtr judged;
};

// Each scan is prepared once, when it is added (some 10 ms).
class StopMap {
 public:
  explicit StopMap(RegistrationSettings settings = {}) : settings_(std::move(settings)) {}

  // Throws std::invalid_argument for a scan without an image or a pose that is not finite.
  void add(const Scan& scan, const Pose& world_from_scan);
  // Of a stop that is there: relaxation may move it.
  void setPose(std::size_t stop, const Pose& world_from_scan);

  bool empty() const { return stops_.empty(); }
  std::size_t size() const { return stops_.size(); }
  const MapStop& operator[](std::size_t stop) const { return stops_.at(stop); }
  const RegistrationSettings& settings() const { return settings_; }

  // At most `most` stops within `within_m` of a place in the world, nearest first; the last stop is always
  // among them, whatever its distance.
  std::vector<std::size_t> neighbours(const Eigen::Vector3d& place_m, std::size_t most,
                                      double within_m) const;

 private:
  RegistrationSettings settings_;
  std::vector<MapStop> stops_;
};

}  // namespace tiltmap
