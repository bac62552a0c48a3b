#include "ui/scene/scene_camera.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tiltmap::ui {

using Eigen::Vector3d;

double SceneCamera::halfHeight() const {
  return distance() * std::tan(kHalfAngle_rad);
}

void SceneCamera::fit(const std::vector<Vector3d>& points, const Vector3d& direction, const Vector3d& upwards,
                      double aspect) {
  if (points.empty()) return;
  const Vector3d f = direction.normalized();
  const Vector3d r = f.cross(upwards).normalized();
  const Vector3d u = r.cross(f);
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  for (const Vector3d& p : points) {
    const Vector3d q(r.dot(p), u.dot(p), f.dot(p));
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  const Vector3d middle = 0.5 * (low + high);
  const double tan_y = std::tan(kHalfAngle_rad) / 1.08, tan_x = tan_y * std::max(aspect, 0.05);
  double away = 0.5;
  for (const Vector3d& p : points) {
    const Vector3d q = Vector3d(r.dot(p), u.dot(p), f.dot(p)) - middle;
    const double needed = std::max(std::abs(q.x()) / tan_x, std::abs(q.y()) / tan_y);
    // In perspective what is nearer than the middle needs more room.
    away = std::max(away, needed - (orthographic ? 0.0 : q.z()));
  }
  focus = middle.x() * r + middle.y() * u + middle.z() * f;
  position = focus - away * f;
  up = u;
}

void SceneCamera::turn(const Vector3d& pivot, double around_rad, double over_rad) {
  const Vector3d f = forward();
  const double lift = std::asin(std::clamp(f.z(), -1.0, 1.0));
  // Short of straight up or down, where there is no left and right to turn about.
  constexpr double kSteepest = 1.5533;
  const double target = std::clamp(lift + over_rad, -kSteepest, kSteepest);
  const double over = std::abs(lift) > kSteepest && std::abs(target) >= kSteepest ? 0.0 : target - lift;
  const Eigen::AngleAxisd about_right(over, right());
  const Eigen::AngleAxisd about_z(around_rad, Vector3d::UnitZ());
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(about_z) * Eigen::Quaterniond(about_right);
  position = pivot + rotation * (position - pivot);
  focus = pivot + rotation * (focus - pivot);
  up = rotation * up;
  if (std::abs(forward().z()) < 0.9995) up = Vector3d::UnitZ();
}

void SceneCamera::shift(double right_m, double up_m) {
  const Vector3d by = right_m * right() + up_m * trueUp();
  position += by;
  focus += by;
}

void SceneCamera::zoom(const Vector3d& pivot, double factor) {
  const double limited = std::clamp(factor, 0.05, 20.0);
  // Between a centimetre and a thousand kilometres.
  if (distance() / limited < 0.01 || distance() / limited > 1e6) return;
  position = pivot + (position - pivot) / limited;
  focus = pivot + (focus - pivot) / limited;
}

}  // namespace tiltmap::ui
