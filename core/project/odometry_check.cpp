#include "core/project/odometry_check.h"

#include <cmath>
#include <stdexcept>
#include <variant>

#include "core/base/text.h"
#include "core/registration/pose_strength.h"

namespace tiltmap {

namespace {

struct Off {
  double place_m = 0.0;
  double heading_rad = 0.0;
};

// How far the step from one scan to another differs, in the plane.
Off stepOff(std::span<const Pose> odometry, std::span<const Pose> poses, std::size_t from, std::size_t to) {
  const Pose measured = odometry[from].inverse() * odometry[to];
  const Pose found = poses[from].inverse() * poses[to];
  const Eigen::Vector3d a = measured.heading(), b = found.heading();
  const double turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  return {(measured.translation() - found.translation()).head<2>().norm(), std::abs(turn)};
}

}  // namespace

std::string OverruledRow::sentence() const {
  return std::string("the odometry ") + (carried_on ? "of the way to scan " : "of scan ") +
         std::to_string(scan) + " was overruled: it is " + lengthWords(off_m) + " and " +
         fixedReal(off_rad / kDegree, 1) + "° off where the scans put it";
}

std::vector<OverruledRow> overruledRows(std::span<const Pose> odometry, std::span<const Pose> poses,
                                        const OdometryLimits& limits) {
  if (odometry.size() != poses.size()) throw std::invalid_argument("overruledRows: not as many of both");
  const auto beyond = [&](const Off& off) {
    return off.place_m > limits.off_m || off.heading_rad > limits.off_rad;
  };
  std::vector<OverruledRow> rows;
  std::size_t before = 0;  // the last stop whose row holds
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Off off = stepOff(odometry, poses, before, i);
    if (!beyond(off)) {
      before = i;
      continue;
    }
    const bool last = i + 1 == poses.size();
    const bool alone = last || !beyond(stepOff(odometry, poses, before, i + 1));
    rows.push_back({i, off.place_m, off.heading_rad, !alone});
    if (!alone) before = i;
  }
  return rows;
}

std::vector<OverruledRow> overruledRows(const ProjectSnapshot& snapshot, Stage stage) {
  std::vector<Pose> odometry, poses;
  std::vector<std::size_t> index;
  const auto of_stage = snapshot.poses(stage);
  for (std::size_t i = 0; i < of_stage.size(); ++i) {
    if (!of_stage[i]) continue;
    odometry.push_back(snapshot.scans()[i].odometry());
    poses.push_back(*of_stage[i]);
    index.push_back(i);
  }
  std::vector<OverruledRow> rows = overruledRows(odometry, poses);
  for (OverruledRow& row : rows) row.scan = index[row.scan];
  return rows;
}

std::vector<OverruledRow> overruledRows(const ProjectSnapshot& snapshot, const ProjectEdit& edit) {
  std::vector<Pose> odometry, poses;
  for (const EditStep& step : edit.steps)
    if (const auto* set = std::get_if<SetPoses>(&step); set && set->poses.size() == snapshot.scans().size())
      for (std::size_t i = 0; i < set->poses.size(); ++i) {
        if (i == 0) odometry.clear(), poses.clear();
        odometry.push_back(snapshot.scans()[i].odometry());
        poses.push_back(set->poses[i].second);
      }
  return overruledRows(odometry, poses);
}

}  // namespace tiltmap
