#include "ui/models/step_words.h"

#include <gtest/gtest.h>

namespace tiltmap::ui {
namespace {

TEST(StepWords, EveryDirectionHasItsWord) {
  const auto words = [](double x, double y, double z, double turn_deg) {
    return stepInWords(Pose(Pose::planar(0, 0, turn_deg * kDegree).quaternion(), Eigen::Vector3d(x, y, z)));
  };
  EXPECT_EQ(words(0, 2, 0, 15), "2.00 m forward, turned 15° to the left");
  EXPECT_EQ(words(0, -2, 0, -7.26), "2.00 m back, turned 7.3° to the right");
  EXPECT_EQ(words(0.3, 0, 0, 0), "0.30 m to the right");
  EXPECT_EQ(words(-0.3, 0, 0.05, 0), "0.30 m to the left, 0.05 m up");
  EXPECT_EQ(words(0, 1, -0.2, 180), "1.00 m forward, 0.20 m down, turned 180° to the left");
  EXPECT_EQ(words(0, 0, 0, 0), "did not move");
  EXPECT_EQ(words(0.004, -0.004, 0.004, 0.04), "did not move");
}

TEST(StepWords, TiltingIsTold) {
  const Pose uphill(Eigen::Quaterniond(Eigen::AngleAxisd(3.0 * kDegree, Eigen::Vector3d::UnitX())),
                    Eigen::Vector3d(0, 5, 0.2));
  EXPECT_EQ(stepInWords(uphill), "5.00 m forward, 0.20 m up, tilted by 3°");
}

TEST(StepWords, TheTurnIsThatOfTheHeading) {
  for (const double deg : {-170.0, -90.0, -1.0, 0.0, 45.0, 90.0, 179.0})
    EXPECT_NEAR(headingChange(Pose::planar(1, 2, deg * kDegree)), deg * kDegree, 1e-9);
}

}  // namespace
}  // namespace tiltmap::ui
