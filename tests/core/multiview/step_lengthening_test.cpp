#include "core/multiview/step_lengthening.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

std::vector<Vector6d> steps(double first, double second) {
  std::vector<Vector6d> list(2, Vector6d::Zero());
  list[0][4] = first;
  list[1][0] = second;
  return list;
}

TEST(StepLengthening, AStepThatFallsShortByTheSameShareIsMadeUpFor) {
  StepLengthening lengthening;
  // Half of what is left each time, from 1 m and 0.1 rad.
  std::vector<Vector6d> first = steps(0.5, 0.05), second = steps(0.25, 0.025);
  lengthening.lengthen(first, 10.0);
  EXPECT_DOUBLE_EQ(first[0][4], 0.5) << "nothing is known of the share yet";
  lengthening.lengthen(second, 10.0);
  EXPECT_NEAR(second[0][4], 0.5, 1e-12);
  EXPECT_NEAR(second[1][0], 0.05, 1e-12);
}

TEST(StepLengthening, NeverShortensNorGoesToInfinity) {
  StepLengthening back;
  std::vector<Vector6d> first = steps(0.5, 0.0), second = steps(-0.25, 0.0);
  back.lengthen(first, 10.0);
  back.lengthen(second, 10.0);
  EXPECT_DOUBLE_EQ(second[0][4], -0.25);

  StepLengthening crawling;
  std::vector<Vector6d> slow = steps(0.1, 0.0), slower = steps(0.0999, 0.0), same = steps(0.0999, 0.0);
  crawling.lengthen(slow, 10.0);
  crawling.lengthen(slower, 10.0);
  EXPECT_LE(slower[0][4], 0.7);
  crawling.lengthen(same, 10.0);
  EXPECT_TRUE(std::isfinite(same[0][4]));
}

TEST(StepLengthening, AnotherProblemBeginsAnew) {
  StepLengthening lengthening;
  std::vector<Vector6d> first = steps(0.5, 0.0), second = steps(0.25, 0.0);
  lengthening.lengthen(first, 10.0);
  lengthening.restart();
  lengthening.lengthen(second, 10.0);
  EXPECT_DOUBLE_EQ(second[0][4], 0.25);
}

}  // namespace
}  // namespace tiltmap
