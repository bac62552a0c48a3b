#include "core/geometry/pose.h"

#include <cmath>
#include <stdexcept>

namespace tiltmap {

Pose::Pose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m)
    : rotation_(rotation.normalized()), translation_(translation_m) {
  if (rotation.squaredNorm() == 0.0) throw std::invalid_argument("Pose: a zero quaternion is no rotation");
}

Pose::Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m)
    : rotation_(Eigen::Quaterniond(rotation).normalized()), translation_(translation_m) {
  if (rotation.determinant() <= 0.0)
    throw std::invalid_argument("Pose: the matrix is a reflection or singular");
}

Pose Pose::restored(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m) {
  Pose pose(rotation, translation_m);
  if (std::abs(rotation.squaredNorm() - 1.0) < 1e-12) pose.rotation_ = rotation;
  return pose;
}

Pose Pose::planar(double x_m, double y_m, double heading_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ())), {x_m, y_m, 0.0}};
}

Pose Pose::fromHeading(const Eigen::Vector3d& position_m, const Eigen::Vector3d& heading) {
  const double level = std::hypot(heading.x(), heading.y());
  if (!(level > 1e-9)) throw std::invalid_argument("Pose::fromHeading: the heading is vertical or zero");
  const double yaw = std::atan2(-heading.x(), heading.y());
  const double pitch = std::atan2(heading.z(), level);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX())),
          position_m};
}

Eigen::Isometry3d Pose::isometry() const {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = rotation();
  result.translation() = translation_;
  return result;
}

Pose Pose::inverse() const {
  const Eigen::Quaterniond back = rotation_.conjugate();
  return {back, -(back * translation_)};
}

Pose Pose::operator*(const Pose& other) const {
  return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
}

Pose Pose::moved(const Vector6d& d) const {
  const Eigen::Quaterniond turn = rotationExp(d.head<3>());
  return {turn * rotation_, turn * translation_ + d.tail<3>()};
}

PoseDifference difference(const Pose& a, const Pose& b) {
  return {(a.translation() - b.translation()).norm(),
          rotationLog(a.quaternion().conjugate() * b.quaternion()).norm()};
}

Eigen::Quaterniond rotationExp(const Eigen::Vector3d& rotation_vector_rad) {
  const double angle = rotation_vector_rad.norm();
  // sin(angle/2)/angle by its series where the quotient would lose digits.
  const double factor = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  const Eigen::Vector3d v = factor * rotation_vector_rad;
  return Eigen::Quaterniond(std::cos(0.5 * angle), v.x(), v.y(), v.z()).normalized();
}

Eigen::Vector3d rotationLog(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const double s = rotation.vec().norm();
  const double angle = 2.0 * std::atan2(s, sign * rotation.w());
  const double factor = s < 1e-9 ? 2.0 : angle / s;
  return sign * factor * rotation.vec();
}

std::vector<Pose> chained(const Pose& world_from_0, const std::vector<Pose>& links) {
  std::vector<Pose> poses{world_from_0};
  poses.reserve(links.size() + 1);
  for (const Pose& link : links) poses.push_back(poses.back() * link);
  return poses;
}

std::vector<Pose> rebased(const std::vector<Pose>& world_from_scan) {
  std::vector<Pose> result;
  result.reserve(world_from_scan.size());
  for (const Pose& pose : world_from_scan) result.push_back(world_from_scan.front().inverse() * pose);
  if (!result.empty()) result.front() = Pose();  // exactly, not to rounding
  return result;
}

}  // namespace tiltmap
