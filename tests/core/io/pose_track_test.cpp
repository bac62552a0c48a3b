#include "core/io/pose_track.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::TemporaryFolder;

constexpr const char* kThree =
    "# stamp x y z qx qy qz qw\n"
    "100.0 0 0 0 0 0 0 1\r\n"
    "\n"
    "100.5 1 2 3 0 0 0.70710678 0.70710678\n"
    "102.25 2 2 3 0 0 0 1";

TEST(StampedPose, EightNumbersInTheirOrder) {
  const auto pose = parseStampedPose(" 12.5\t1 2 3 0 0 0.70710678 0.70710678 ", "here");
  ASSERT_TRUE(pose) << pose.error().what;
  EXPECT_EQ(pose->stamp_s, 12.5);
  EXPECT_EQ(pose->world_from_body.translation(), Eigen::Vector3d(1, 2, 3));
  // A quarter turn to the left: x becomes y.
  EXPECT_LT((pose->world_from_body.rotation() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
            1e-7);
}

TEST(StampedPose, WhatIsWrongIsNamed) {
  const std::pair<const char*, const char*> wrong[] = {
      {"1 2 3", "there are 3"},
      {"1 2 3 4 0 0 0 1 9", "there are 9"},
      {"", "there are 0"},
      {"now 1 2 3 0 0 0 1", "stamp: \"now\""},
      {"nan 1 2 3 0 0 0 1", "stamp: \"nan\""},
      {"1 a 2 3 0 0 0 1", "x: \"a\""},
      {"1 1 nan 3 0 0 0 1", "y: \"nan\""},
      {"1 1 2 inf 0 0 0 1", "z: \"inf\""},
      {"1 1 2 1e12 0 0 0 1", "z: \"1e12\" is too large"},
      {"1 1 2 3 - 0 0 1", "qx: \"-\""},
      {"1 1 2 3 0 0x1 0 1", "qy: \"0x1\""},
      {"1 1 2 3 0 0 1,0 1", "qz: \"1,0\""},
      {"1 1 2 3 0 0 0 NaN", "qw: \"NaN\""},
      {"1 1 2 3 0 0 0 0", "length 0.000"},
      {"1 1 2 3 0 0 0 1.02", "length 1.020"},
      {"1 1 2 3 0 0 0 0.985", "length 0.985"},
  };
  for (const auto& [line, told] : wrong) {
    const auto pose = parseStampedPose(line, "feed, line 7");
    ASSERT_FALSE(pose) << line;
    EXPECT_NE(pose.error().what.find(told), std::string::npos) << line << " gave: " << pose.error().what;
    EXPECT_EQ(pose.error().where, "feed, line 7");
    EXPECT_FALSE(pose.error().remedy.empty());
  }
  // Within one per cent it is rounding.
  const auto rounded = parseStampedPose("1 1 2 3 0 0 0 1.009", "here");
  ASSERT_TRUE(rounded);
  EXPECT_EQ(rounded->world_from_body.quaternion().w(), 1.0);
  EXPECT_THROW((void)parsePoseWords({}, "here"), std::invalid_argument);
}

TEST(PoseTrack, ReadsAFileWithStamps) {
  const TemporaryFolder folder;
  const auto track = PoseTrack::read(folder.write("drive.tum", kThree));
  ASSERT_TRUE(track) << track.error().what;
  ASSERT_EQ(track->size(), 3U);
  EXPECT_EQ(track->at(1).stamp_s, 100.5);
  EXPECT_EQ(track->at(2).world_from_body.translation().x(), 2.0);
  EXPECT_THROW((void)track->at(3), std::out_of_range);
}

TEST(PoseTrack, WhatIsWrongIsToldWithFileAndLine) {
  const std::pair<const char*, const char*> wrong[] = {
      {"0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0\n", "f.tum:2"},
      {"# a remark\n\n0 0 0 0 0 0 0 2\n", "f.tum:3"},
      {"5 0 0 0 0 0 0 1\n5 0 0 0 0 0 0 1\n", "f.tum:2"},  // twice
      {"5 0 0 0 0 0 0 1\n4 0 0 0 0 0 0 1\n", "f.tum:2"},  // back in time
      {"\n# nothing\n", "f.tum"},
      {"", "f.tum"},
  };
  for (const auto& [text, where] : wrong) {
    const auto track = PoseTrack::parse(text, "f.tum");
    ASSERT_FALSE(track) << text;
    EXPECT_EQ(track.error().where, where) << text;
  }
  EXPECT_FALSE(PoseTrack::read("/there/is/none.tum"));
}

TEST(PoseTrack, TheNearestStamp) {
  const auto track = PoseTrack::parse(kThree, "f");
  ASSERT_TRUE(track);
  EXPECT_EQ(track->nearest(100.0, 0.0).value(), 0U);
  EXPECT_EQ(track->nearest(100.2, 0.5).value(), 0U);
  EXPECT_EQ(track->nearest(100.25, 0.5).value(), 0U) << "equally near: the earlier";
  EXPECT_EQ(track->nearest(100.3, 0.5).value(), 1U);
  EXPECT_EQ(track->nearest(102.5, 0.5).value(), 2U);
  EXPECT_EQ(track->nearest(99.6, 0.5).value(), 0U);
  for (const double stamp : {99.0, 101.2, 103.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(track->nearest(stamp, 0.5)) << stamp;
  const auto none = track->nearest(101.2, 0.5);
  EXPECT_NE(none.error().what.find("100.5"), std::string::npos) << none.error().what;
}

TEST(PoseTrack, AStepBetweenTwoStamps) {
  const auto track = PoseTrack::parse(kThree, "f");
  ASSERT_TRUE(track);
  const Pose step = stepInTrack(*track, 99.9, 100.6, 0.5, Pose()).value();
  EXPECT_LT(
      difference(step, track->at(0).world_from_body.inverse() * track->at(1).world_from_body).translation_m,
      1e-12);
  // The other way round it is the inverse; other axes give other numbers.
  EXPECT_LT(difference(stepInTrack(*track, 100.6, 99.9, 0.5, Pose()).value(), step.inverse()).translation_m,
            1e-9);
  const Pose ros = stepInTrack(*track, 99.9, 100.6, 0.5, Pose::planar(0, 0, 90.0 * kDegree)).value();
  EXPECT_LT((ros.translation() - Eigen::Vector3d(-2, 1, 3)).norm(), 1e-9);
  EXPECT_FALSE(stepInTrack(*track, 99.9, 100.2, 0.5, Pose())) << "the same pose";
  EXPECT_FALSE(stepInTrack(*track, 50.0, 100.5, 0.5, Pose()));
  EXPECT_FALSE(stepInTrack(*track, 100.0, 200.0, 0.5, Pose()));
}

}  // namespace
}  // namespace tiltmap
