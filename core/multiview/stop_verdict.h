// What an operator is told when a sweep is done: move on, scan again, or come closer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/multiview/sweep_registration.h"
#include "core/scan/scan_health.h"

namespace tiltmap {

enum class StopLight {
  MoveOn,  // the scan is whole and holds on to the map
  Rescan,  // something was wrong with this sweep or its place
  Closer,  // it has too little in common with the map, or is held too weakly
};
const std::string& stopLightName(StopLight light);  // "move on", "rescan", "closer"

struct StopVerdictSettings {
  JudgementSettings judgement;
  ScanHealthSettings health;
  int neighbours = 3;       // stops that the scan is registered to, the previous one first
  double within_m = 40.0;   // and how far away they may be
  double most_ms = 250.0;   // once these have passed nothing further is tried
  double surprise_m = 1.0;  // an odometry that is further off is told
  double surprise_rad = 15.0 * kDegree;
};

// The scan against one stop of the map.
struct StopLink {
  std::size_t stop = 0;  // of the map
  Pose stop_from_scan;
  PairJudgement judgement;
};

struct StopVerdict {
  StopLight light = StopLight::Rescan;
  std::string reason;  // one or two short sentences for the operator
  ScanHealth health;
  std::vector<StopLink> links;      // those tried, the previous stop first
  std::optional<std::size_t> best;  // of links: the one that the pose is taken from
  Pose world_from_scan;             // by it; where there is none the odometry
  bool placed = false;              // world_from_scan is by a link judged good
  double overlap = 0.0;             // of the best link
  std::string weak_directions;      // of the best link, in a sentence; empty where there is none
  PoseDifference moved;             // from the odometry
  double milliseconds = 0.0;
};

// `scan` is whole; `estimate`, where there is one, is what its lines gave (it is tried first). The first stop
// is judged by its health alone. Some 10 to 100 ms, never much above most_ms. Throws std::invalid_argument
// for a scan without an image or an odometry (world_from_scan) that is not finite.
StopVerdict stopVerdict(const StopMap& map, const Scan& scan, const Pose& odometry,
                        const SweepEstimate* estimate = nullptr, const StopVerdictSettings& settings = {},
                        const JobControl& control = {});

}  // namespace tiltmap
