#include "core/registration/pose_strength.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/base/text.h"

namespace tiltmap {

namespace {

std::string turnWords(const Eigen::Vector3d& axis) {
  Eigen::Index most = 0;
  axis.cwiseAbs().maxCoeff(&most);
  return most == 0 ? "pitch" : most == 1 ? "roll" : "heading";
}

}  // namespace

PoseStrength strengthOf(const Matrix6d& information, const Pose& fixed_from_moving, double factor,
                        const Vector6d& pull) {
  Matrix6d held = information.allFinite() ? Matrix6d(information / factor) : Matrix6d(Matrix6d::Zero());
  // What is free stays finite.
  held.diagonal().head<3>().array() += 1.0 / (kFree_rad * kFree_rad);
  held.diagonal().tail<3>().array() += 1.0 / (kFree_m * kFree_m);
  const Matrix6d covariance = held.ldlt().solve(Matrix6d::Identity()) + pull * pull.transpose();
  const Matrix6d to_rig = rigFromFixed(fixed_from_moving);
  return strengthOfCovariance(to_rig * covariance * to_rig.transpose());
}

Matrix6d rigFromFixed(const Pose& fixed_from_moving) {
  // A small motion (w, v) of the fixed frame moves the scan at t by (w, v + w x t), seen from the scan.
  const Eigen::Matrix3d back = fixed_from_moving.rotation().transpose();
  const Eigen::Vector3d& t = fixed_from_moving.translation();
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  Matrix6d to_rig = Matrix6d::Zero();
  to_rig.topLeftCorner<3, 3>() = back;
  to_rig.bottomRightCorner<3, 3>() = back;
  to_rig.bottomLeftCorner<3, 3>() = -back * cross;
  return to_rig;
}

PoseStrength strengthOfCovariance(const Matrix6d& rig_covariance) {
  PoseStrength strength;
  strength.covariance = 0.5 * (rig_covariance + rig_covariance.transpose());
  const Vector6d deviation = strength.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  strength.pitch_rad = deviation[0], strength.roll_rad = deviation[1], strength.heading_rad = deviation[2];
  strength.right_m = deviation[3], strength.forward_m = deviation[4], strength.up_m = deviation[5];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turn(strength.covariance.topLeftCorner<3, 3>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> place(strength.covariance.bottomRightCorner<3, 3>());
  strength.weakest_rad = std::sqrt(std::max(0.0, turn.eigenvalues()[2]));
  strength.turn = turn.eigenvectors().col(2);
  strength.weakest_m = std::sqrt(std::max(0.0, place.eigenvalues()[2]));
  strength.weakest = place.eigenvectors().col(2);
  return strength;
}

std::string angleWords(double radians) {
  const double degrees = radians / kDegree, size = std::abs(degrees);
  return fixedReal(degrees, size < 0.095 ? 3 : size < 0.95 ? 2 : 1) + "°";
}

std::string lengthWords(double metres) {
  const double size = std::abs(metres);
  if (size < 0.0095) return fixedReal(1000.0 * metres, size < 0.00095 ? 1 : 0) + " mm";
  if (size < 0.995) return fixedReal(100.0 * metres, 0) + " cm";
  return fixedReal(metres, 1) + " m";
}

std::string directionWords(const Eigen::Vector3d& direction) {
  const double flat = direction.head<2>().norm();
  if (std::abs(direction.z()) > 1.5 * flat) return "up and down";
  // Left of ahead is positive; a direction and its opposite are the same.
  double left = std::atan2(-direction.x(), direction.y()) / kDegree;
  if (left > 90.0) left -= 180.0;
  if (left <= -90.0) left += 180.0;
  if (std::abs(left) < 15.0) return "ahead and back";
  if (std::abs(left) > 75.0) return "sideways";
  return fixedReal(std::abs(left), 0) + "° " + (left > 0.0 ? "left" : "right") + " of ahead";
}

std::string strengthSentence(const PoseStrength& strength, double weak_m, double weak_rad) {
  const bool slides = !(2.0 * strength.weakest_m <= weak_m),
             turns = !(2.0 * strength.weakest_rad <= weak_rad);
  const auto slide = [&]() -> std::string {
    if (strength.weakest_m > 0.3 * kFree_m)
      return "is free to slide along " + directionWords(strength.weakest);
    return "can slide " + lengthWords(2.0 * strength.weakest_m) + " along " +
           directionWords(strength.weakest);
  };
  const auto turn = [&]() -> std::string {
    if (strength.weakest_rad > 0.3 * kFree_rad) return "is free to turn in " + turnWords(strength.turn);
    return "can turn " + angleWords(2.0 * strength.weakest_rad) + " in " + turnWords(strength.turn);
  };
  if (slides && turns) return slide() + " and " + turn();
  if (slides) return slide();
  if (turns) return turn();
  return "held in all directions: weakest " + directionWords(strength.weakest) + ", within " +
         lengthWords(2.0 * strength.weakest_m) + ", and " + turnWords(strength.turn) + ", within " +
         angleWords(2.0 * strength.weakest_rad);
}

}  // namespace tiltmap
