#include "core/geometry/pose.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d randomVector(RandomStream& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

Pose randomPose(RandomStream& random) {
  return {rotationExp(randomVector(random, 1.7)), randomVector(random, 20.0)};
}

void expectSame(const Pose& a, const Pose& b, double tolerance = 1e-12) {
  const PoseDifference apart = difference(a, b);
  EXPECT_LT(apart.translation_m, tolerance);
  EXPECT_LT(apart.rotation_rad, tolerance);
}

TEST(Pose, StartsAsTheIdentity) {
  EXPECT_EQ(Pose().matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(Pose().heading(), Eigen::Vector3d::UnitY());
}

TEST(Pose, PlanarTurnsLeftForAPositiveHeading) {
  const Pose world_from_scan = Pose::planar(2.0, 3.0, kPi / 2);
  EXPECT_LT((world_from_scan.heading() - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-15);
  // What is one metre ahead of the scanner lies one metre to the left of where it stands.
  EXPECT_LT((world_from_scan * Eigen::Vector3d(0, 1, 0) - Eigen::Vector3d(1, 3, 0)).norm(), 1e-15);
}

TEST(Pose, ProductsInversesAndMatricesAgree) {
  RandomStream random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose a = randomPose(random), b = randomPose(random), c = randomPose(random);
    const Eigen::Vector3d p = randomVector(random, 30.0);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-12);
    EXPECT_LT((a.isometry() * p - a * p).norm(), 1e-12);
    EXPECT_LT((a.inverse() * (a * p) - p).norm(), 1e-12);
    expectSame(a * a.inverse(), Pose());
    expectSame(a.inverse() * a, Pose());
    expectSame((a * b).inverse(), b.inverse() * a.inverse());
    expectSame((a * b) * c, a * (b * c));
    expectSame(Pose(a.rotation(), a.translation()), a);
  }
}

TEST(Pose, InverseIsTheOtherDirection) {
  const Pose world_from_scan = Pose::planar(5.0, 0.0, 0.3);
  // At the stop itself the two differ; a test that cannot tell them apart tests nothing.
  EXPECT_GT(difference(world_from_scan, world_from_scan.inverse()).rotation_rad, 0.5);
  EXPECT_LT((world_from_scan.inverse() * Eigen::Vector3d(5, 0, 0)).norm(), 1e-15);
}

TEST(Pose, NormalisesAndRefusesWhatIsNoRotation) {
  EXPECT_NEAR(Pose(Eigen::Quaterniond(2, 0, 0, 2), Eigen::Vector3d::Zero()).quaternion().norm(), 1.0, 1e-15);
  EXPECT_THROW(Pose(Eigen::Quaterniond(0, 0, 0, 0), Eigen::Vector3d::Zero()), std::invalid_argument);
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -1).asDiagonal();
  EXPECT_THROW(Pose(mirror, Eigen::Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(Pose(Eigen::Matrix3d::Zero().eval(), Eigen::Vector3d::Zero()), std::invalid_argument);
}

TEST(Pose, TellsWhenItIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(Pose::planar(1, 2, 3).isFinite());
  EXPECT_FALSE(Pose::planar(nan, 0, 0).isFinite());
  EXPECT_FALSE(Pose(Eigen::Quaterniond(nan, 0, 0, 1), Eigen::Vector3d::Zero()).isFinite());
}

TEST(Pose, MovedAppliesRotationThenShiftOnTheLeft) {
  RandomStream random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose pose = randomPose(random);
    Vector6d d;
    d << randomVector(random, 0.4), randomVector(random, 2.0);
    const Eigen::Vector3d p = randomVector(random, 10.0);
    const Eigen::Vector3d expected = rotationExp(d.head<3>()) * (pose * p) + d.tail<3>();
    EXPECT_LT((pose.moved(d) * p - expected).norm(), 1e-12);
    expectSame(pose.moved(d), Pose(rotationExp(d.head<3>()), d.tail<3>()) * pose);
  }
  expectSame(Pose::planar(1, 2, 0.5).moved(Vector6d::Zero()), Pose::planar(1, 2, 0.5));
}

TEST(Pose, MovedHasTheDerivativeThatSolversUse) {
  // d(moved * p) for a small (w, v) is w x (R p + t) + v.
  const Pose pose(rotationExp({0.3, -0.2, 0.9}), {1, 2, 3});
  const Eigen::Vector3d p(4, -5, 6);
  for (int k = 0; k < 6; ++k) {
    Vector6d d = Vector6d::Zero();
    d[k] = 1e-6;
    const Eigen::Vector3d slope = (pose.moved(d) * p - pose.moved(-d) * p) / 2e-6;
    const Eigen::Vector3d expected =
        k < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k).cross(pose * p)) : Eigen::Vector3d::Unit(k - 3);
    EXPECT_LT((slope - expected).norm(), 1e-8) << k;
  }
}

TEST(Rotation, ExpAndLogAreInverseFromNearZeroToNearPi) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  for (const double angle : {0.0, 1e-15, 1e-9, 9.9e-7, 1.01e-6, 1e-3, 1.0, 3.0, kPi - 1e-6, kPi - 1e-9}) {
    const Eigen::Vector3d vector = angle * axis;
    const Eigen::Quaterniond rotation = rotationExp(vector);
    EXPECT_LT((rotationLog(rotation) - vector).norm(), 1e-15 + 1e-12 * angle) << angle;
    // A quaternion and its negative are the same rotation.
    const Eigen::Quaterniond negative(-rotation.w(), -rotation.x(), -rotation.y(), -rotation.z());
    EXPECT_LT((rotationLog(negative) - vector).norm(), 1e-15 + 1e-12 * angle) << angle;
    EXPECT_LT((rotation.toRotationMatrix() - Eigen::AngleAxisd(angle, axis).toRotationMatrix()).norm(),
              1e-14);
  }
  EXPECT_NEAR(rotationLog(rotationExp(kPi * axis)).norm(), kPi, 1e-12);  // either axis will do
  EXPECT_NEAR(rotationLog(rotationExp((2 * kPi - 0.1) * axis)).norm(), 0.1, 1e-12);
}

TEST(Difference, MeasuresDistanceAndAngle) {
  const Pose a = Pose::planar(0, 0, 0.2);
  const PoseDifference apart = difference(a, Pose::planar(3, 4, -0.1));
  EXPECT_DOUBLE_EQ(apart.translation_m, 5.0);
  EXPECT_NEAR(apart.rotation_rad, 0.3, 1e-15);
  EXPECT_NEAR(difference(Pose::planar(0, 0, 3.1), Pose::planar(0, 0, -3.1)).rotation_rad, 2 * kPi - 6.2,
              1e-12);
  EXPECT_NEAR(difference(a, Pose::planar(0, 0, 0.2 + 1e-10)).rotation_rad, 1e-10, 1e-16);
  EXPECT_EQ(difference(a, a).rotation_rad, 0.0);
}

TEST(FromHeading, TurnsForwardOntoTheHeadingsOfTheThesis) {
  // Table 5.2 and 6.2 print headings like these; not all have length one.
  for (const Eigen::Vector3d& heading :
       {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(-0.707, 0.707, 0), Eigen::Vector3d(1, 0, 0),
        Eigen::Vector3d(0.05, 0.99, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0.1, 0.9, -0.2)}) {
    const Pose pose = Pose::fromHeading({1, 2, 3}, heading);
    EXPECT_LT((pose.heading() - heading.normalized()).norm(), 1e-14);
    EXPECT_NEAR((pose.rotation() * Eigen::Vector3d::UnitX()).z(), 0.0, 1e-15);  // no roll
    EXPECT_GT((pose.rotation() * Eigen::Vector3d::UnitZ()).z(), 0.0);
    EXPECT_EQ(pose.translation(), Eigen::Vector3d(1, 2, 3));
  }
  expectSame(Pose::fromHeading({0, 0, 0}, {0, 1, 0}), Pose());
  expectSame(Pose::fromHeading({1, 2, 0}, {-std::sin(0.4), std::cos(0.4), 0}), Pose::planar(1, 2, 0.4));
}

TEST(FromHeading, RefusesAVerticalOrEmptyHeading) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Eigen::Vector3d& heading :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(nan, 0, 0)})
    EXPECT_THROW(Pose::fromHeading({0, 0, 0}, heading), std::invalid_argument);
}

TEST(Chained, MultipliesLinksFromTheLeft) {
  const std::vector<Pose> links{Pose::planar(0, 2, kPi / 2), Pose::planar(0, 3, 0)};
  const auto poses = chained(Pose::planar(1, 0, 0), links);
  ASSERT_EQ(poses.size(), 3U);
  expectSame(poses[0], Pose::planar(1, 0, 0));
  expectSame(poses[1], Pose::planar(1, 2, kPi / 2));
  expectSame(poses[2], Pose::planar(-2, 2, kPi / 2));  // forward is to the left by now
  EXPECT_EQ(chained(Pose(), {}).size(), 1U);
}

TEST(Rebased, PutsTheFirstAtTheIdentityAndKeepsTheLinks) {
  RandomStream random(3);
  std::vector<Pose> poses;
  for (int i = 0; i < 5; ++i) poses.push_back(randomPose(random));
  const auto moved = rebased(poses);
  ASSERT_EQ(moved.size(), poses.size());
  EXPECT_EQ(moved[0].matrix(), Eigen::Matrix4d::Identity());
  for (std::size_t i = 1; i < poses.size(); ++i)
    expectSame(moved[i - 1].inverse() * moved[i], poses[i - 1].inverse() * poses[i], 1e-11);
  EXPECT_TRUE(rebased({}).empty());
}

}  // namespace
}  // namespace tiltmap
