// A scan registered while it is being taken: the lines so far against the stops around it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/multiview/stop_map.h"

namespace tiltmap {

struct SweepSettings {
  int first_lines = 12;       // fewer are not tried
  int neighbours = 3;         // stops of the map that are tried
  double within_m = 40.0;     // and how far away they may be
  double most_weak_m = 0.10;  // two deviations in the weakest direction: worse is not handed out
  double most_weak_rad = 1.0 * kDegree;
  double least_overlap = 0.15;  // of the lines so far
  double most_apart_m = 0.10;   // two neighbours that both fit must put the scan in the same place
  double most_apart_rad = 1.0 * kDegree;
};

struct SweepEstimate {
  // Whether the lines so far hold the pose. Where not, the pose is the last one that was held, else the
  // odometry.
  bool sure = false;
  bool from_odometry = true;  // world_from_scan is still the odometry
  Pose world_from_scan;
  int lines = 0;         // that the estimate rests on
  std::string sentence;  // "not yet: the pose is free to slide along ahead and back", "held within 2 cm"
  double overlap = 0.0;  // share of the surfaces so far that lie on the best neighbour's
  double deviation_m = kFree_m;  // of the place in the weakest direction; of a turn
  double deviation_rad = kFree_rad;
  std::optional<std::size_t> neighbour;    // stop of the map it was registered to
  std::optional<PairJudgement> judgement;  // against it
  PoseDifference moved;                    // from the odometry
  double milliseconds = 0.0;
};

// One sweep: made when it begins, told the lines so far every few lines. One thread.
class SweepRegistration {
 public:
  // The map must not change meanwhile; it may be empty. Throws std::invalid_argument for no map or an
  // odometry (world_from_scan) that is not finite.
  SweepRegistration(std::shared_ptr<const StopMap> map, const Pose& odometry,
                    const SweepSettings& settings = {});

  // `so_far`: the matrix of the sweep, lines not taken yet as kNotScanned (its odometry is not used). Starts
  // from the last pose that was held, else from the odometry.
  const SweepEstimate& update(const Scan& so_far);
  const SweepEstimate& estimate() const { return estimate_; }
  const Pose& odometry() const { return odometry_; }

 private:
  struct Found;
  std::optional<Found> registered(std::size_t stop, const PreparedScanPtr& moving,
                                  const JudgedScanPtr& judged) const;
  void conclude(const std::vector<Found>& found);

  std::shared_ptr<const StopMap> map_;
  Pose odometry_;
  SweepSettings settings_;
  SweepEstimate estimate_;
};

}  // namespace tiltmap
