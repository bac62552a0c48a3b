// Where the 3D view looks from; plain geometry, no VTK.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace tiltmap::ui {

// World frame, z up. Perspective and orthographic pictures agree at the focus.
struct SceneCamera {
  Eigen::Vector3d position{0, -10, 0};
  Eigen::Vector3d focus{0, 0, 0};
  Eigen::Vector3d up{0, 0, 1};
  bool orthographic = false;

  static constexpr double kHalfAngle_rad = 0.2617993877991494;  // half the vertical field of view: 15 degrees

  double distance() const { return (focus - position).norm(); }
  Eigen::Vector3d forward() const { return (focus - position).normalized(); }
  Eigen::Vector3d right() const { return forward().cross(up).normalized(); }
  Eigen::Vector3d trueUp() const { return right().cross(forward()); }
  // Half the height of what is seen at the focus, metres.
  double halfHeight() const;

  // Looks along `direction` so that all points are in a picture of this width against height.
  void fit(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction,
           const Eigen::Vector3d& upwards, double aspect);
  // Angles in radians, about a vertical line and a level line through the pivot; never over the top.
  void turn(const Eigen::Vector3d& pivot, double around_rad, double over_rad);
  // Sideways and up, metres.
  void shift(double right_m, double up_m);
  // Above 1: closer to the pivot, which stays where it is in the picture.
  void zoom(const Eigen::Vector3d& pivot, double factor);
};

}  // namespace tiltmap::ui
