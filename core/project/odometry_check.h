// Which measured rows of an odometry the registered scans contradict.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/project/project_edit.h"

namespace tiltmap {

// A stop whose measured place is not where the scans stand. Told of horizontal place and heading against the
// stop before it: an odometry knows no other.
struct OverruledRow {
  std::size_t scan = 0;  // index
  double off_m = 0.0;
  double off_rad = 0.0;
  // The stops after it are measured from the same wrong place, so that only the step to it is wrong; else the
  // row alone, as in a list of measured places.
  bool carried_on = false;

  // "the odometry of scan 13 was overruled: it is 0.2 m and 80.5° off where the scans put it"
  std::string sentence() const;
};

// What counts as overruled: more than the odometry of such a robot is ever off from stop to stop (the thesis'
// tables: up to 0.8 m and 10.6 deg). Ours.
struct OdometryLimits {
  double off_m = 1.0;
  double off_rad = 20.0 * kDegree;
};

// Ascending; world_from_scan both, as many of each.
std::vector<OverruledRow> overruledRows(std::span<const Pose> odometry, std::span<const Pose> poses,
                                        const OdometryLimits& limits = {});
// Against the poses of a stage; none where the project does not have it. Scans without such a pose are left
// out.
std::vector<OverruledRow> overruledRows(const ProjectSnapshot& snapshot, Stage stage);
// Against the poses that an edit sets for all scans.
std::vector<OverruledRow> overruledRows(const ProjectSnapshot& snapshot, const ProjectEdit& edit);

}  // namespace tiltmap
