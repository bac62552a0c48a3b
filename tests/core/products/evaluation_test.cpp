#include "core/products/evaluation.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

TEST(Evaluation, MeasuresEachStopAndLeavesTheFirstOutOfTheMean) {
  const std::vector<Pose> truth = {Pose(), Pose::planar(1, 0, 0), Pose::planar(2, 0, 0)};
  const std::vector<Pose> estimated = {Pose(), Pose::planar(1.3, 0.4, 0), Pose::planar(2, 0, 3 * kDegree)};
  const auto result = evaluateTrajectory(estimated, truth);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->stops.size(), 3U);
  EXPECT_EQ(result->stops[2].index, 2U);
  EXPECT_EQ(result->stops[0].translation_error_m, 0.0);
  EXPECT_NEAR(result->stops[1].translation_error_m, 0.5, 1e-12);
  EXPECT_NEAR(result->stops[1].rotation_error_deg, 0.0, 1e-9);
  EXPECT_NEAR(result->stops[2].rotation_error_deg, 3.0, 1e-9);
  EXPECT_NEAR(result->rmse_translation_m, std::sqrt(0.25 / 2), 1e-12);
  EXPECT_NEAR(result->rmse_rotation_deg, std::sqrt(9.0 / 2), 1e-9);
}

TEST(Evaluation, TakesBothTrajectoriesFromTheirFirstStop) {
  // The same drive, once in a frame of its own and once in a national one, tilted for good measure.
  const Pose world(Eigen::Quaterniond(0.9, 0.1, -0.2, 0.4), Eigen::Vector3d(1000, -500, 20));
  const std::vector<Pose> truth = {Pose(), Pose::planar(3, 1, 0.4), Pose::planar(5, 4, 1.3)};
  std::vector<Pose> estimated;
  for (const Pose& pose : truth) estimated.push_back(world * pose);
  const auto same = evaluateTrajectory(estimated, truth);
  ASSERT_TRUE(same);
  EXPECT_LT(same->rmse_translation_m, 1e-9);
  EXPECT_LT(same->rmse_rotation_deg, 1e-6);

  // Not aligned otherwise: a first stop that is turned by 0.1 rad swings every later one.
  estimated = truth;
  estimated[0] = Pose::planar(0, 0, 0.1);
  const auto swung = evaluateTrajectory(estimated, truth);
  ASSERT_TRUE(swung);
  EXPECT_NEAR(swung->stops[1].translation_error_m, 2 * std::sin(0.05) * std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(swung->stops[2].rotation_error_deg, 0.1 / kDegree, 1e-9);
}

TEST(Evaluation, TellsAPoseFromItsInverse) {
  const std::vector<Pose> truth = {Pose(), Pose::planar(2, 0, 90 * kDegree)};
  const std::vector<Pose> inverted = {Pose(), truth[1].inverse()};  // at (0, 2), looking along +x
  const auto result = evaluateTrajectory(inverted, truth);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->rmse_translation_m, std::sqrt(8.0), 1e-9);
  EXPECT_NEAR(result->rmse_rotation_deg, 180.0, 1e-6);
}

TEST(Evaluation, MeasuresRotationsAboutAnyAxisUpToHalfATurn) {
  const std::vector<Pose> truth = {Pose(), Pose()};
  for (const double angle : {0.001, 1.0, 90.0, 179.9}) {
    const Pose turned(rotationExp(Eigen::Vector3d(1, -2, 2).normalized() * angle * kDegree), {0, 0, 0});
    const auto result = evaluateTrajectory({Pose(), turned}, truth);
    ASSERT_TRUE(result);
    EXPECT_NEAR(result->stops[1].rotation_error_deg, angle, 1e-7);
  }
}

TEST(Evaluation, RefusesWhatCannotBeCompared) {
  EXPECT_FALSE(evaluateTrajectory({}, {}));
  EXPECT_FALSE(evaluateTrajectory({Pose()}, {Pose()}));
  const auto uneven = evaluateTrajectory({Pose(), Pose()}, {Pose(), Pose(), Pose()});
  ASSERT_FALSE(uneven);
  EXPECT_EQ(uneven.error().what, "there are 2 poses but 3 true ones");
  const Pose broken(Eigen::Quaterniond::Identity(), {0, std::numeric_limits<double>::quiet_NaN(), 0});
  const auto nan = evaluateTrajectory({Pose(), broken}, {Pose(), Pose()});
  ASSERT_FALSE(nan);
  EXPECT_EQ(nan.error().where, "evaluation, stop 1");
}

}  // namespace
}  // namespace tiltmap
