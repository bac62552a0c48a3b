#include "core/registration/manual_start.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/registration/slice_registration.h"
#include "support/room_scene.h"

namespace tiltmap {
namespace {

using test_support::almostEmptyScan;
using test_support::roomScene;
using test_support::sceneScan;

const Pose kTruth(rotationExp({0.01, -0.02, 0.06}), {0.20, 0.30, 0.05});

TEST(PointPairs, GiveTheMotionAndWhatIsLeft) {
  const std::vector<Eigen::Vector3d> moving = {{1, 2, 0}, {-3, 4, 1}, {2, 6, -1}, {0, 1, 2}};
  std::vector<Eigen::Vector3d> fixed;
  for (const auto& p : moving) fixed.push_back(kTruth * p);
  const auto exact = fitPointPairs(fixed, moving);
  ASSERT_TRUE(exact);
  EXPECT_LT(difference(exact->fixed_from_moving, kTruth).translation_m, 1e-9);
  EXPECT_LT(exact->rms_m, 1e-9);
  fixed[1] += Eigen::Vector3d(0.4, 0.0, 0.0);
  const auto off = fitPointPairs(fixed, moving);
  ASSERT_TRUE(off);
  ASSERT_EQ(off->residual_m.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(off->residual_m[i], (off->fixed_from_moving * moving[i] - fixed[i]).norm(), 1e-12);
  EXPECT_GT(off->rms_m, 0.05);
}

TEST(PointPairs, TooFewOrOnALineAreRefusedInWords) {
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const auto two = fitPointPairs(std::span(line).first(2), std::span(line).first(2));
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().what.find("three"), std::string::npos);
  EXPECT_FALSE(fitPointPairs(line, line));
  EXPECT_FALSE(fitPointPairs(line, std::span(line).first(2)));
  std::vector<Eigen::Vector3d> bad = {{0, 0, 0}, {1, 0, 0}, {0, std::nan(""), 0}};
  EXPECT_FALSE(fitPointPairs(bad, bad));
}

TEST(HeadingSweep, FindsTheTurnThatWasTakenAway) {
  const Scan fixed = sceneScan(roomScene(), Pose(), 0.005, 1),
             moving = sceneScan(roomScene(), kTruth, 0.005, 2);
  RegistrationSettings thesis = registrationParameters().presetSettings("thesis").value();
  thesis.sampling_step = 20;
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis}) {
    const PreparedScanPtr f = prepare(fixed, settings), m = prepare(moving, settings);
    for (const double wrong : {0.0, 60.0, -45.0}) {
      const Pose start = turnedStart(kTruth, wrong * kDegree);
      const auto sweep = sweepHeadings(*f, *m, start, settings);
      ASSERT_TRUE(sweep);
      EXPECT_EQ(sweep->scores.size(), 121U);
      EXPECT_NEAR(sweep->scores.front().turned_rad, -std::acos(-1.0), 1e-9);
      EXPECT_NEAR(sweep->bestScore().turned_rad, -wrong * kDegree, 3.1 * kDegree);
      EXPECT_GT(sweep->bestScore().score, 0.5);
      EXPECT_LE(sweep->bestScore().score, 1.0);
      EXPECT_LT(difference(turnedStart(start, sweep->bestScore().turned_rad), kTruth).rotation_rad,
                3.1 * kDegree);
    }
  }
}

TEST(HeadingSweep, RefusesWhatItCannotDo) {
  const RegistrationSettings settings;
  const PreparedScanPtr room = prepare(sceneScan(roomScene(), Pose(), 0.005, 1), settings);
  const PreparedScanPtr nothing = prepare(almostEmptyScan(0), settings);
  EXPECT_FALSE(sweepHeadings(*nothing, *room, Pose(), settings));
  EXPECT_FALSE(sweepHeadings(*room, *nothing, Pose(), settings));
  EXPECT_FALSE(sweepHeadings(*room, *room, Pose(), settings, {0.0, 0.3}));
  std::stop_source source;
  source.request_stop();
  const auto stopped = sweepHeadings(*room, *room, Pose(), settings, {}, {{}, source.get_token()});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().what, kCancelled);
}

TEST(Slices, MatchInThePlaneAndMissTheRest) {
  const Scan fixed = sceneScan(roomScene(), Pose(), 0.005, 1);
  const Pose level = Pose::planar(0.3, 0.4, 0.05);
  const auto flat = registerSlices(fixed, sceneScan(roomScene(), level, 0.005, 2), Pose());
  ASSERT_TRUE(flat);
  EXPECT_TRUE(flat->succeeded()) << stopReasonName(flat->stop_reason);
  const SliceComparison near = compareSlice(flat->fixed_from_moving, level);
  EXPECT_LT(near.shift_m, 0.3);  // half a metre at the start
  EXPECT_LT(near.heading_rad, 2.0 * kDegree);
  for (const Eigen::Vector3d& p : flat->fixed) EXPECT_EQ(p.z(), 0.0);
  EXPECT_GT(flat->moving.size(), 100U);
  EXPECT_EQ(flat->fixed_from_moving.translation().z(), 0.0);

  // Off the level the whole scans' pose has a height and a tilt that no slice can have.
  const Pose tilted(rotationExp({0.1, 0.0, 0.05}), {0.3, 0.4, 0.5});
  const auto missed = registerSlices(fixed, sceneScan(roomScene(), tilted, 0.005, 2), Pose());
  ASSERT_TRUE(missed);
  const SliceComparison far = compareSlice(missed->fixed_from_moving, tilted);
  EXPECT_NEAR(far.height_m, 0.5, 1e-12);
  EXPECT_NEAR(far.tilt_rad, 0.1, 0.01);
}

TEST(Slices, NothingInTheSliceIsNoResult) {
  const Scan room = sceneScan(roomScene(), Pose(), 0.005, 1);
  SliceSettings high;
  high.height_m = 40.0;
  const auto nothing = registerSlices(room, room, Pose(), high);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->stop_reason, StopReason::TooFewPairs);
  EXPECT_FALSE(nothing->succeeded());
  EXPECT_FALSE(registerSlices(Scan(), room, Pose()));
  SliceSettings flat;
  flat.thickness_m = 0.0;
  EXPECT_FALSE(registerSlices(room, room, Pose(), flat));
}

}  // namespace
}  // namespace tiltmap
