// A part of the world, cut out by an upright box.
#pragma once

#include <Eigen/Core>

namespace tiltmap::ui {

// Axis-aligned, world frame.
struct PointBox {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
  bool operator==(const PointBox&) const = default;
  bool contains(const Eigen::Vector3d& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
};

}  // namespace tiltmap::ui
