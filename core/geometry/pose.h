// Rigid motions. A pose is named b_from_a: p_in_b = b_from_a * p_in_a, so that a product reads by eye:
// world_from_2 = world_from_1 * one_from_2.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tiltmap {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Rotation and translation, metres. The only rigid motion in an API.
class Pose {
 public:
  Pose() = default;  // the identity
  // The quaternion is normalised here. Zero, a reflection or a singular matrix throws std::invalid_argument;
  // what is not finite passes and is told by isFinite().
  Pose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m);
  Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_m);

  // The same bits that quaternion() and translation() gave when the pose was stored: normalising a unit
  // quaternion again may move its last bit. One that is not unit within 1e-12 is normalised.
  static Pose restored(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation_m);

  // A stop on level ground: position in metres, heading in radians, left (counter-clockwise) positive from
  // +y.
  static Pose planar(double x_m, double y_m, double heading_rad);
  // Shortest rotation that brings +y onto the given heading vector (thesis 5.1), keeping z as upright as it
  // can be. Throws std::invalid_argument for a vertical or zero heading.
  static Pose fromHeading(const Eigen::Vector3d& position_m, const Eigen::Vector3d& heading);

  const Eigen::Quaterniond& quaternion() const { return rotation_; }
  Eigen::Matrix3d rotation() const { return rotation_.toRotationMatrix(); }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Isometry3d isometry() const;
  Eigen::Matrix4d matrix() const { return isometry().matrix(); }

  Pose inverse() const;
  Pose operator*(const Pose& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation_ * point + translation_; }

  // R * (0,1,0), the thesis' heading (5.1.6).
  Eigen::Vector3d heading() const { return rotation_ * Eigen::Vector3d::UnitY(); }

  // A small motion applied on the left: rotation vector w (rad) and shift v (m), d = (w, v):
  // p -> Exp(w) * (R p + t) + v. The solvers' update and covariance use this order: rotation first.
  Pose moved(const Vector6d& d) const;

  // The same numbers, not merely the same motion.
  bool operator==(const Pose& other) const {
    return rotation_.coeffs() == other.rotation_.coeffs() && translation_ == other.translation_;
  }
  bool isFinite() const { return rotation_.coeffs().allFinite() && translation_.allFinite(); }

 private:
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

// How far two poses of the same frames differ. Compare differences, never norms of single poses.
struct PoseDifference {
  double translation_m = 0.0;  // distance of the origins
  double rotation_rad = 0.0;   // angle of the rotation between them, 0 to pi
};
PoseDifference difference(const Pose& a, const Pose& b);

// Rotation vector to rotation and back (angles up to pi).
Eigen::Quaterniond rotationExp(const Eigen::Vector3d& rotation_vector_rad);
Eigen::Vector3d rotationLog(const Eigen::Quaterniond& rotation);

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;

// Localisation (thesis 5.1.5): world_from_i = world_from_0 * H(0,1) * ... * H(i-1,i).
// links[k] is k_from_(k+1); the result has one pose more than there are links.
std::vector<Pose> chained(const Pose& world_from_0, const std::vector<Pose>& links);
// The same poses in the frame of the first: the first becomes the identity.
std::vector<Pose> rebased(const std::vector<Pose>& world_from_scan);

}  // namespace tiltmap
