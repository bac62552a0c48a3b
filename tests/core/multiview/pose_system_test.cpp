#include "core/multiview/pose_system.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

Pose randomPose(RandomStream& random, double angle_rad, double shift_m) {
  const auto part = [&](double scale) {
    return Eigen::Vector3d(random.normal() * scale, random.normal() * scale, random.normal() * scale);
  };
  return Pose(rotationExp(part(angle_rad)), part(shift_m));
}

struct Graph {
  std::vector<Pose> truth;
  std::vector<std::pair<int, int>> ties;
};

// A ring of poses far from the origin, with a few chords.
Graph ring(int count) {
  RandomStream random(5);
  Graph graph;
  const Pose far(Eigen::Quaterniond::Identity(), {4000.0, -2500.0, 30.0});
  for (int i = 0; i < count; ++i) {
    graph.truth.push_back(far * Pose::planar(10.0 * std::cos(0.5 * i), 10.0 * std::sin(0.5 * i), 0.5 * i) *
                          randomPose(random, 0.05, 0.2));
    graph.ties.emplace_back(i, (i + 1) % count);
  }
  for (int i = 0; i + 4 < count; i += 3) graph.ties.emplace_back(i + 4, i);
  return graph;
}

std::vector<PairTerm> termsOf(const Graph& graph, const std::vector<Pose>& poses,
                              const Matrix6d& information) {
  std::vector<PairTerm> terms;
  for (const auto& [a, b] : graph.ties) {
    const auto f = static_cast<std::size_t>(a), m = static_cast<std::size_t>(b);
    terms.push_back(measuredPoseTerm(a, b, poses[f].inverse() * poses[m],
                                     graph.truth[f].inverse() * graph.truth[m], information));
  }
  return terms;
}

Matrix6d someInformation() {
  Vector6d diagonal;
  diagonal << 4e6, 3e6, 9e6, 1e4, 2e4, 5e3;
  Matrix6d information = diagonal.asDiagonal();
  information(0, 4) = information(4, 0) = 3e4;
  return information;
}

TEST(PoseSystem, MeasuredPosesPullThePosesToTheTruth) {
  const Graph graph = ring(12);
  RandomStream random(7);
  std::vector<Pose> poses = graph.truth;
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i] = poses[i] * randomPose(random, 0.05, 0.4);
  std::vector<char> held(poses.size(), 0);
  held[0] = 1;
  for (int step = 0; step < 8; ++step) {
    const auto motions = solvePoses(poses.size(), held, termsOf(graph, poses, someInformation()), 1e-6);
    ASSERT_TRUE(motions.has_value());
    EXPECT_TRUE((*motions)[0].isZero());
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = poses[i] * Pose().moved((*motions)[i]);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseDifference off = difference(poses[i], graph.truth[i]);
    EXPECT_LT(off.translation_m, 1e-7) << i;
    EXPECT_LT(off.rotation_rad, 1e-8) << i;
  }
}

TEST(PoseSystem, OneTieMovesTheMovingPoseOntoItsMeasurementWhicheverIsHeld) {
  RandomStream random(3);
  const Pose measured = randomPose(random, 0.8, 5.0);
  const Pose off = measured.moved((Vector6d() << 1e-4, -2e-4, 1e-4, 1e-3, 2e-3, -1e-3).finished());
  const std::vector<Pose> poses = {Pose(), off};
  for (const int hold : {0, 1}) {
    std::vector<char> held(2, 0);
    held[static_cast<std::size_t>(hold)] = 1;
    const auto motions =
        solvePoses(2, held, {measuredPoseTerm(0, 1, off, measured, someInformation())}, 1e-9);
    ASSERT_TRUE(motions.has_value());
    const Pose first = poses[0] * Pose().moved((*motions)[0]),
               second = poses[1] * Pose().moved((*motions)[1]);
    const PoseDifference left = difference(first.inverse() * second, measured);
    EXPECT_LT(left.translation_m, 2e-6);
    EXPECT_LT(left.rotation_rad, 1e-7);
  }
}

TEST(PoseSystem, TheOrderOfFixedAndMovingDoesNotMatter) {
  Graph graph = ring(8);
  RandomStream random(11);
  std::vector<Pose> poses = graph.truth;
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i] = poses[i] * randomPose(random, 1e-3, 1e-2);
  std::vector<char> held(poses.size(), 0);
  held[0] = 1;
  const Matrix6d unit = Matrix6d::Identity() * 1e6;
  const auto there = solvePoses(poses.size(), held, termsOf(graph, poses, unit), 1e-6);
  for (auto& tie : graph.ties) std::swap(tie.first, tie.second);
  const auto back = solvePoses(poses.size(), held, termsOf(graph, poses, unit), 1e-6);
  ASSERT_TRUE(there.has_value() && back.has_value());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    // Exact where all measurements agree, so equal up to second order in the
    // error.
    EXPECT_LT(((*there)[i] - (*back)[i]).norm(), 0.05 * (*there)[i].norm() + 1e-9) << i;
    if (i > 0) {
      EXPECT_GT((*there)[i].norm(), 1e-4) << i;
    }
  }
}

TEST(PoseSystem, WhatNoTermDeterminesDoesNotMove) {
  Matrix6d information = Matrix6d::Zero();
  information(3, 3) = 1e6;  // along x alone
  const Pose measured(Eigen::Quaterniond::Identity(), {1.0, 1.0, 1.0});
  const auto motions = solvePoses(2, {1, 0}, {measuredPoseTerm(0, 1, Pose(), measured, information)}, 1.0);
  ASSERT_TRUE(motions.has_value());
  EXPECT_NEAR((*motions)[1][3], 1.0, 1e-5);
  EXPECT_NEAR((*motions)[1].norm(), 1.0, 1e-5);
}

TEST(PoseSystem, HeldPosesAndNoPosesAreFine) {
  const auto none = solvePoses(0, {}, {}, 1.0);
  ASSERT_TRUE(none.has_value());
  EXPECT_TRUE(none->empty());
  const auto held = solvePoses(
      2, {1, 1}, {measuredPoseTerm(0, 1, Pose(), Pose::planar(1, 2, 0.1), Matrix6d::Identity())}, 1.0);
  ASSERT_TRUE(held.has_value());
  for (const Vector6d& motion : *held) EXPECT_TRUE(motion.isZero());
}

TEST(PoseSystem, NumbersThatAreNoneAreRefused) {
  Matrix6d information = Matrix6d::Identity();
  information(2, 2) = std::nan("");
  EXPECT_FALSE(
      solvePoses(2, {1, 0}, {measuredPoseTerm(0, 1, Pose(), Pose::planar(1, 2, 0.1), information)}, 1.0));
}

TEST(PoseSystem, ThousandsOfPosesAreSolved) {
  const Graph graph = ring(3000);
  std::vector<Pose> poses = graph.truth;
  RandomStream random(2);
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i] = poses[i] * randomPose(random, 1e-4, 1e-3);
  std::vector<char> held(poses.size(), 0);
  held[0] = 1;
  const auto motions = solvePoses(poses.size(), held, termsOf(graph, poses, someInformation()), 1e-6);
  ASSERT_TRUE(motions.has_value());
  double worst = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i)
    worst = std::max(worst, difference(poses[i] * Pose().moved((*motions)[i]), graph.truth[i]).translation_m);
  EXPECT_LT(worst, 1e-4);
}

TEST(PoseSystem, TiesReachThroughOthers) {
  std::vector<PairTerm> terms(3);
  terms[0].fixed = 0, terms[0].moving = 2;
  terms[1].fixed = 4, terms[1].moving = 2;
  terms[2].fixed = 1, terms[2].moving = 3;
  EXPECT_EQ(tiedToHeld(6, {1, 0, 0, 0, 0, 0}, terms), (std::vector<char>{1, 0, 1, 0, 1, 0}));
  EXPECT_EQ(tiedToHeld(6, {1, 0, 0, 1, 0, 0}, terms), (std::vector<char>{1, 1, 1, 1, 1, 0}));
}

}  // namespace
}  // namespace tiltmap
