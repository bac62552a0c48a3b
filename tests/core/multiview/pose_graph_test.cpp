#include "core/multiview/pose_graph.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

constexpr int kStops = 40;
constexpr double kNoise_m = 0.002;
constexpr double kNoise_rad = 0.01 * kDegree;

Matrix6d informationOf(double deviation_m, double deviation_rad) {
  Vector6d d;
  d << Eigen::Vector3d::Constant(1.0 / (deviation_rad * deviation_rad)),
      Eigen::Vector3d::Constant(1.0 / (deviation_m * deviation_m));
  return d.asDiagonal();
}

// A drive round a block, back to where it began, each step measured with noise.
class PoseGraphTest : public ::testing::Test {
 protected:
  PoseGraphTest() {
    for (int i = 0; i < kStops; ++i) {
      const double turn = 360.0 * kDegree * i / kStops;
      truth_.push_back(Pose::planar(35.0 * std::cos(turn) - 35.0, 35.0 * std::sin(turn), turn));
    }
    for (int i = 1; i < kStops; ++i) add(i - 1, i, false);
    // As chained: errors add up.
    starts_ = {truth_[0]};
    for (int i = 1; i < kStops; ++i)
      starts_.push_back(starts_.back() * links_[static_cast<std::size_t>(i - 1)].fixed_from_moving);
    held_.assign(kStops, 0);
    held_[0] = 1;
  }
  Pose between(int fixed, int moving) const {
    return truth_[static_cast<std::size_t>(fixed)].inverse() * truth_[static_cast<std::size_t>(moving)];
  }
  int add(int fixed, int moving, bool doubted, const Pose& off = {}) {
    Vector6d noise;
    for (int k = 0; k < 6; ++k) noise[k] = (k < 3 ? kNoise_rad : kNoise_m) * random_.normal();
    links_.push_back({fixed, moving, (off * between(fixed, moving)).moved(noise),
                      informationOf(kNoise_m, kNoise_rad), doubted});
    return static_cast<int>(links_.size()) - 1;
  }
  PoseGraphResult solved() const {
    const auto result = solvePoseGraph(starts_, held_, links_);
    EXPECT_TRUE(result);
    return result.value_or(PoseGraphResult{});
  }
  double furthest(const std::vector<Pose>& poses) const {
    double furthest = 0.0;
    for (std::size_t i = 0; i < truth_.size(); ++i)
      furthest = std::max(furthest, difference(poses[i], truth_[i]).translation_m);
    return furthest;
  }
  RandomStream random_{7};
  std::vector<Pose> truth_, starts_;
  std::vector<char> held_;
  std::vector<GraphLink> links_;
};

TEST_F(PoseGraphTest, AChainStaysAsItIs) {
  const PoseGraphResult result = solved();
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    const PoseDifference off = difference(result.poses[i], starts_[i]);
    EXPECT_LT(off.translation_m, 1e-4) << i;
    EXPECT_LT(off.rotation_rad, 1e-5) << i;
  }
  EXPECT_TRUE(result.rejected.empty());
}

TEST_F(PoseGraphTest, ARightClosureIsTakenAndHelps) {
  const double before = furthest(starts_);
  add(0, kStops - 1, true);
  const PoseGraphResult result = solved();
  EXPECT_TRUE(result.rejected.empty());
  EXPECT_LT(furthest(result.poses), 0.95 * before);
  EXPECT_LT(result.misclosure.back(), 22.46);
  EXPECT_EQ(result.misclosure.front(), 0.0);
}

TEST_F(PoseGraphTest, FalseClosuresPlantedByHandAreRejectedAndChangeNothing) {
  add(0, kStops - 1, true);
  add(1, kStops - 2, true);
  const PoseGraphResult without = solved();
  std::vector<int> planted;
  planted.push_back(add(3, 22, true, Pose::planar(2.0, 0.0, 0.0)));
  planted.push_back(add(5, 30, true, Pose::planar(0.0, 0.0, 5.0 * kDegree)));
  planted.push_back(add(0, 20, true, Pose::planar(0.0, -1.0, 0.0)));
  planted.push_back(add(10, 12, true, Pose::planar(0.2, 0.0, 0.0)));
  // Two that agree with each other, not with the rest.
  planted.push_back(add(8, 35, true, Pose::planar(3.0, 3.0, 0.1)));
  planted.push_back(add(8, 35, true, Pose::planar(3.0, 3.0, 0.1)));
  const PoseGraphResult result = solved();
  EXPECT_EQ(result.rejected, planted);
  for (std::size_t i = 0; i < truth_.size(); ++i)
    EXPECT_LT(difference(result.poses[i], without.poses[i]).translation_m, 1e-6) << i;
  for (const int k : planted) EXPECT_GT(result.misclosure[static_cast<std::size_t>(k)], 22.46);

  // Believed, they would bend the map.
  for (const int k : planted) links_[static_cast<std::size_t>(k)].doubted = false;
  EXPECT_GT(furthest(solved().poses), 0.2);
}

TEST_F(PoseGraphTest, RightClosuresAreHardlyEverRejected) {
  int rejected = 0, all = 0;
  for (int k = 0; k < 20; ++k, ++all) add(k, kStops - 1 - (k * 7) % 19, true);
  rejected = static_cast<int>(solved().rejected.size());
  EXPECT_EQ(rejected, 0) << "of " << all;
}

TEST_F(PoseGraphTest, ALinkThatLeavesADirectionFreeDoesNotJudgeThere) {
  // Knows nothing of x: being off there by metres is no contradiction, nor does it pull.
  const int k = add(10, 20, true, Pose::planar(4.0, 0.0, 0.0));
  links_[static_cast<std::size_t>(k)].fixed_from_moving = Pose::planar(4.0, 0.0, 0.0) * between(10, 20);
  links_[static_cast<std::size_t>(k)].information.row(3).setZero();
  links_[static_cast<std::size_t>(k)].information.col(3).setZero();
  const PoseGraphResult result = solved();
  EXPECT_TRUE(result.rejected.empty());
  EXPECT_LT(furthest(result.poses), 1.5 * furthest(starts_));
}

TEST_F(PoseGraphTest, WhatNothingTiesKeepsItsStartUntilADoubtedLinkDoes) {
  links_.erase(links_.begin() + 20);  // 20 to 21
  for (int i = 21; i < kStops; ++i)
    starts_[static_cast<std::size_t>(i)] = Pose::planar(1.0, 1.0, 0.0) * starts_[static_cast<std::size_t>(i)];
  EXPECT_EQ(solved().poses[30], starts_[30]);
  add(0, kStops - 1, true);
  const PoseGraphResult tied = solved();
  EXPECT_TRUE(tied.rejected.empty());
  EXPECT_LT(furthest(tied.poses), 0.1);
}

TEST_F(PoseGraphTest, RefusesWhatMakesNoSense) {
  EXPECT_THROW(solvePoseGraph(starts_, {1}, links_), std::invalid_argument);
  links_[0].moving = kStops;
  EXPECT_THROW(solvePoseGraph(starts_, held_, links_), std::invalid_argument);
  links_[0].moving = links_[0].fixed;
  EXPECT_THROW(solvePoseGraph(starts_, held_, links_), std::invalid_argument);
  EXPECT_TRUE(solvePoseGraph({}, {}, {}));
}

}  // namespace
}  // namespace tiltmap
