#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/tilt/tilt_unit.h"

namespace tiltmap {
namespace {

TEST(TiltDrive, CountsOfTheThesisGear) {
  const TiltDrive drive;
  EXPECT_DOUBLE_EQ(drive.counts_per_turn, 512.0 * 4.0 * 1526.0);
  EXPECT_EQ(drive.countsOf(0.8 * kDegree), 6945);
  EXPECT_EQ(drive.countsOf(80.0 * kDegree), 694500) << "absolute: no error adds up over a hundred steps";
  EXPECT_NEAR(drive.angleOf(694500) / kDegree, 80.0, 0.0001);
}

TEST(TiltDrive, TheLevelCountIsLevel) {
  TiltDrive drive;
  drive.level_count = 312525;
  EXPECT_DOUBLE_EQ(drive.angleOf(312525), 0.0);
  EXPECT_NEAR(drive.angleOf(0) / kDegree, -36.0, 0.001);
  drive.counts_per_turn = -drive.counts_per_turn;
  EXPECT_NEAR(drive.angleOf(0) / kDegree, 36.0, 0.001) << "a motor the other way round";
  for (const double degrees : {-30.0, 0.0, 12.8, 50.0})
    EXPECT_NEAR(drive.angleOf(drive.countsOf(degrees * kDegree)) / kDegree, degrees, 0.0001);
}

TEST(TiltDrive, AStepTakesWhatItsRampsTake) {
  const TiltDrive drive;
  EXPECT_NEAR(drive.moveDuration(6945), 2.0 * std::sqrt(6945.0 / 2.0) * 0.001, 1e-9);
  EXPECT_NEAR(drive.moveDuration(-24000), 0.001 * (24000.0 / 120.0 + 60.0), 1e-9);
  EXPECT_EQ(drive.moveDuration(0), 0.0);
}

TEST(TiltDrive, NoSegmentTakesLongerThanItMay) {
  for (const double speed : {5.0, 40.0, 120.0, 200.0}) {
    for (const double acceleration : {0.2, 2.0, 20.0}) {
      TiltDrive drive;
      drive.speed = speed;
      drive.acceleration = acceleration;
      ASSERT_TRUE(drive.check());
      std::int64_t at = -300000;
      for (const std::int64_t station : segmentsOf(drive, at, 400000)) {
        EXPECT_LE(drive.moveDuration(static_cast<double>(station - at)), 0.2);
        EXPECT_GT(station, at);
        at = station;
      }
      EXPECT_EQ(at, 400000);
    }
  }
}

TEST(TiltDrive, TargetsAreReachedFromBelow) {
  const TiltDrive drive;
  const auto down = segmentsOf(drive, 100000, 0);
  EXPECT_EQ(down.back(), 0);
  EXPECT_LE(*std::ranges::min_element(down), drive.countsOf(-drive.approach_rad) + 1);
  EXPECT_LT(down[down.size() - 2], 0);
  // At the lower limit there is no room below.
  const std::int64_t lowest = drive.countsOf(drive.minimum_rad);
  for (const std::int64_t station : segmentsOf(drive, 0, lowest)) EXPECT_GE(station, lowest);
  // The motor the other way round: below is still below.
  TiltDrive turned;
  turned.counts_per_turn = -turned.counts_per_turn;
  const auto up = segmentsOf(turned, 0, turned.countsOf(0.2));
  EXPECT_EQ(up.size(), segmentsOf(drive, 0, drive.countsOf(0.2)).size());
  EXPECT_GT(segmentsOf(turned, turned.countsOf(0.2), 0).size(), up.size());
  EXPECT_EQ(segmentsOf(drive, 5, 5), std::vector<std::int64_t>{5});
}

TEST(TiltDrive, NonsenseIsRefused) {
  const auto refused = [](auto change) {
    TiltDrive drive;
    change(drive);
    return !drive.check();
  };
  EXPECT_TRUE(TiltDrive{}.check());
  EXPECT_TRUE(refused([](TiltDrive& d) { d.speed = 1000.0; }))
      << "the controller would do it, the motor would not";
  EXPECT_TRUE(refused([](TiltDrive& d) { d.speed = 0.0; }));
  EXPECT_TRUE(refused([](TiltDrive& d) { d.acceleration = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](TiltDrive& d) { d.minimum_rad = d.maximum_rad; }));
  EXPECT_TRUE(refused([](TiltDrive& d) { d.counts_per_turn = 0.0; }));
  EXPECT_TRUE(refused([](TiltDrive& d) { d.longest_segment_s = 0.5; }));
  EXPECT_TRUE(refused([](TiltDrive& d) { d.settle_s = -1.0; }));
}

}  // namespace
}  // namespace tiltmap
