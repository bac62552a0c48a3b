#include "core/geometry/body_axes.h"

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

void expectSame(const Pose& a, const Pose& b) {
  EXPECT_LT(difference(a, b).translation_m, 1e-9);
  EXPECT_LT(difference(a, b).rotation_rad, 1e-7);
}

// A vehicle in a frame of ROS: heading from +x, left positive.
Pose rosPose(double x, double y, double yaw_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d(x, y, 0.0)};
}

TEST(BodyAxes, ForwardOfTheBodyIsForwardOfTheScan) {
  const Pose scan_from_body = scanFromBody(BodyAxes::ForwardLeftUp);
  EXPECT_LT((scan_from_body * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);  // forward
  EXPECT_LT((scan_from_body * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-12);  // left
  EXPECT_LT((scan_from_body * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);   // up
  EXPECT_EQ(scanFromBody(BodyAxes::RightForwardUp), Pose());
}

TEST(BodyAxes, TwoMetresAheadAndAQuarterTurnLeft) {
  const Pose x = scanFromBody(BodyAxes::ForwardLeftUp);
  // Facing +x of its world, it drives 2 m ahead and turns left.
  expectSame(stepBetween(rosPose(0, 0, 0), rosPose(2, 0, 90.0 * kDegree), x),
             Pose::planar(0.0, 2.0, 90.0 * kDegree));
  // One metre to its left, without turning.
  expectSame(stepBetween(rosPose(5, 5, 0), rosPose(5, 6, 0), x), Pose::planar(-1.0, 0.0, 0.0));
  // And back: the inverse of the step.
  expectSame(stepBetween(rosPose(2, 0, 90.0 * kDegree), rosPose(0, 0, 0), x),
             Pose::planar(0.0, 2.0, 90.0 * kDegree).inverse());
}

TEST(BodyAxes, TheFrameOfTheWorldCancels) {
  const Pose x = scanFromBody(BodyAxes::ForwardLeftUp);
  const Pose last = rosPose(1, 2, 0.3), next = rosPose(4, 1, -0.7);
  const Pose elsewhere(Eigen::Quaterniond(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized())),
                       Eigen::Vector3d(100, -50, 7));
  expectSame(stepBetween(last, next, x), stepBetween(elsewhere * last, elsewhere * next, x));
}

TEST(BodyAxes, OurOwnAxesAndOneStepAreTheSameMotionInBothFrames) {
  // The same drive written by us and by ROS gives the same step.
  const Pose x = scanFromBody(BodyAxes::ForwardLeftUp);
  const Pose last = Pose::planar(3, 4, 0.2),
             next = Pose::planar(3.5, 9, 0.5) *
                    Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX())),
                         Eigen::Vector3d(0, 0, 0.3));
  const Pose ours = stepBetween(last, next, scanFromBody(BodyAxes::RightForwardUp));
  expectSame(ours, last.inverse() * next);
  expectSame(stepBetween(x.inverse() * last * x, x.inverse() * next * x, x), ours);
}

TEST(BodyAxes, AScannerAheadOfTheBodysOriginIsSwungAround) {
  // Half a metre ahead of the point that the vehicle turns about: seen from the scanner the body's origin
  // lies half a metre behind. After a quarter turn to the left it stands further left and further back.
  const Pose x(scanFromBody(BodyAxes::ForwardLeftUp).quaternion(), Eigen::Vector3d(0, -0.5, 0));
  const Pose step = stepBetween(rosPose(0, 0, 0), rosPose(0, 0, 90.0 * kDegree), x);
  expectSame(step, Pose::planar(-0.5, -0.5, 90.0 * kDegree));
}

}  // namespace
}  // namespace tiltmap
