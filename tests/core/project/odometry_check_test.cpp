#include "core/project/odometry_check.h"

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

// Five stops along a street, as measured and as found.
class OdometryCheckTest : public ::testing::Test {
 protected:
  OdometryCheckTest() {
    for (int i = 0; i < 5; ++i) {
      odometry_.push_back(Pose::planar(0.3 * i, 5.0 * i, 0.1 * i));
      // The ground leans and springs give way: no business of a measured place in the plane.
      poses_.push_back(odometry_.back() *
                       Pose().moved((Vector6d() << 0.05, -0.04, 0.02, 0.2, -0.3, 0.4).finished()));
    }
    poses_[0] = odometry_[0];
  }
  std::vector<OverruledRow> rows() const { return overruledRows(odometry_, poses_); }
  std::vector<Pose> odometry_, poses_;
};

TEST_F(OdometryCheckTest, AnOdometryThatHoldsIsLeftAlone) {
  EXPECT_TRUE(rows().empty());
  EXPECT_TRUE(overruledRows(std::vector<Pose>{}, std::vector<Pose>{}).empty());
  EXPECT_TRUE(overruledRows(std::vector<Pose>(1), std::vector<Pose>(1)).empty());
  EXPECT_THROW(overruledRows(odometry_, std::vector<Pose>(1)), std::invalid_argument);
}

TEST_F(OdometryCheckTest, ARowMeasuredWronglyIsNamedAlone) {
  odometry_[2] = Pose::planar(0.6, 11.4, 0.2);  // 1.4 m too far
  ASSERT_EQ(rows().size(), 1U);
  EXPECT_EQ(rows()[0].scan, 2U);
  EXPECT_NEAR(rows()[0].off_m, 1.4, 0.5);
  EXPECT_FALSE(rows()[0].carried_on);
  EXPECT_NE(rows()[0].sentence().find("odometry of scan 2 was overruled"), std::string::npos);
}

TEST_F(OdometryCheckTest, AHeadingMeasuredWronglyIsNamedOnce) {
  // Mid-drive it turns the step after it too; the last stop has none.
  for (const std::size_t at : {std::size_t{1}, std::size_t{3}, std::size_t{4}}) {
    const Pose right = odometry_[at];
    odometry_[at] = odometry_[at] * Pose::planar(0.0, 0.0, -80.0 * kDegree);
    ASSERT_EQ(rows().size(), 1U) << at;
    EXPECT_EQ(rows()[0].scan, at);
    EXPECT_NEAR(rows()[0].off_rad / kDegree, 80.0, 3.0);
    odometry_[at] = right;
  }
}

TEST_F(OdometryCheckTest, AStepThatCarriesOnIsToldAsTheWay) {
  for (std::size_t i = 2; i < 5; ++i) odometry_[i] = Pose::planar(0.0, 3.0, 0.0) * odometry_[i];
  ASSERT_EQ(rows().size(), 1U);
  EXPECT_EQ(rows()[0].scan, 2U);
  EXPECT_TRUE(rows()[0].carried_on);
  EXPECT_NE(rows()[0].sentence().find("the way to scan 2"), std::string::npos);
}

TEST_F(OdometryCheckTest, TwoRowsAreBothNamed) {
  odometry_[1] = odometry_[1] * Pose::planar(0.0, 1.5, 0.0);
  odometry_[4] = odometry_[4] * Pose::planar(0.0, 0.0, 1.4);
  ASSERT_EQ(rows().size(), 2U);
  EXPECT_EQ(rows()[0].scan, 1U);
  EXPECT_EQ(rows()[1].scan, 4U);
}

}  // namespace
}  // namespace tiltmap
