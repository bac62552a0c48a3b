#include "core/scan/scanner_geometry.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/geometry/pose.h"

namespace tiltmap {
namespace {

using Eigen::Vector3d;

ScannerGeometry calibrated() {
  ScannerGeometry g;
  g.tilt_zero_rad = 0.6 * kDegree;
  g.lever_arm_m = {0.01, 0.05, 0.09};
  g.mounting = rotationExp(Vector3d(0.02, -0.015, 0.01));
  g.range_offset_m = -0.03;
  return g;
}

TEST(ScannerGeometry, LooksWhereTheFrameSays) {
  const ScannerGeometry g;
  EXPECT_LT((g.direction(0, 0) - Vector3d(1, 0, 0)).norm(), 1e-15);               // right
  EXPECT_LT((g.direction(0, 90 * kDegree) - Vector3d(0, 1, 0)).norm(), 1e-15);    // forward
  EXPECT_LT((g.direction(0, 180 * kDegree) - Vector3d(-1, 0, 0)).norm(), 1e-15);  // left
  EXPECT_GT(g.direction(30 * kDegree, 90 * kDegree).z(), 0.49);                   // a positive tilt looks up
  EXPECT_NEAR(g.tiltOfRow(0), -30 * kDegree, 1e-12);
  EXPECT_NEAR(g.tiltOfRow(100), 50 * kDegree, 1e-12);
  EXPECT_NEAR(g.azimuthOfColumn(360), 180 * kDegree, 1e-12);
}

TEST(ScannerGeometry, FollowsThePrintedFormulaWithoutCalibration) {
  const ScannerGeometry g;
  const double e = 0.3, a = 1.1, r = 7.0;
  const Vector3d expected = r * Vector3d(std::cos(a), std::sin(a) * std::cos(e), std::sin(a) * std::sin(e));
  EXPECT_LT((g.point(e, a, r) - expected).norm(), 1e-14);
  EXPECT_LT((g.direction(e, a) - expected / r).norm(), 1e-15);
}

TEST(ScannerGeometry, AppliesEachPartOfTheCalibrationInItsPlace) {
  const double e = 0.2, a = 1.3, r = 6.0;
  ScannerGeometry g;
  g.tilt_zero_rad = 0.05;
  EXPECT_LT((g.point(e, a, r) - ScannerGeometry().point(e + 0.05, a, r)).norm(), 1e-14);
  g = {};
  g.range_offset_m = 0.25;
  EXPECT_LT((g.point(e, a, r) - ScannerGeometry().point(e, a, r + 0.25)).norm(), 1e-14);
  g = {};
  g.lever_arm_m = {0, 0, 0.1};  // the mirror above the axis: tilting up carries it backwards
  const Vector3d shift = g.point(e, a, r) - ScannerGeometry().point(e, a, r);
  EXPECT_LT((shift - 0.1 * Vector3d(0, -std::sin(e), std::cos(e))).norm(), 1e-14);
  g = {};
  g.mounting = rotationExp(Vector3d(0, 0, 0.04));  // turned left in its own plane: the azimuth grows
  EXPECT_LT((g.point(e, a, r) - ScannerGeometry().point(e, a + 0.04, r)).norm(), 1e-14);
}

class PlaceOfPoint : public ::testing::TestWithParam<ScannerGeometry> {};

TEST_P(PlaceOfPoint, FindsTheCellAgain) {
  const ScannerGeometry g = GetParam();
  RandomStream random(11);
  for (int i = 0; i < 2000; ++i) {
    const double row = random.uniform(0, g.rows - 1), column = random.uniform(4, g.columns - 5);
    const double range = random.uniform(0.5, 80.0);
    const double e = g.tilt_start_rad + row * g.tilt_step_rad,
                 a = g.azimuth_start_rad + column * g.azimuth_step_rad;
    // Beside the tilt axis, as near as the lever arm is long, two beams of the matrix may see the same point.
    if (range * std::abs(std::sin(a)) < 0.3) continue;
    const auto place = g.place(g.point(e, a, range));
    ASSERT_TRUE(place) << row << " " << column << " " << range;
    EXPECT_NEAR(place->row, row, 1e-7);
    EXPECT_NEAR(place->column, column, 1e-7);
    EXPECT_NEAR(place->range_m, range, 1e-9);
  }
}

TEST_P(PlaceOfPoint, GivesAPlaceWhoseBeamHitsAnyPoint) {
  const ScannerGeometry g = GetParam();
  RandomStream random(12);
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d point(random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-30, 30));
    const auto place = g.place(point);
    if (!place) continue;  // beside the swept part, possible where the beam plane is mounted askew
    ++found;
    const Vector3d again = g.point(g.tilt_start_rad + place->row * g.tilt_step_rad,
                                   g.azimuth_start_rad + place->column * g.azimuth_step_rad, place->range_m);
    EXPECT_LT((again - point).norm(), 1e-9 * (1.0 + point.norm())) << point.transpose();
  }
  EXPECT_GT(found, 1900);
}

ScannerGeometry wide() {
  ScannerGeometry g;  // 270 degrees, from behind on the right to behind on the left
  g.columns = 1081;
  g.azimuth_start_rad = -45 * kDegree;
  g.azimuth_step_rad = 0.25 * kDegree;
  g.rows = 61;
  g.lever_arm_m = {0, 0.02, 0.06};
  return g;
}
ScannerGeometry downwards() {
  ScannerGeometry g = calibrated();
  g.tilt_start_rad = 50 * kDegree;
  g.tilt_step_rad = -0.8 * kDegree;
  g.azimuth_start_rad = 180 * kDegree;
  g.azimuth_step_rad = -0.5 * kDegree;
  return g;
}
INSTANTIATE_TEST_SUITE_P(Geometries, PlaceOfPoint,
                         ::testing::Values(ScannerGeometry{}, calibrated(), wide(), downwards()));

TEST(ScannerGeometryPlace, GivesPointsOnTheTiltAxisTheMiddleRow) {
  const ScannerGeometry g;
  const auto right = g.place({4, 0, 0});
  ASSERT_TRUE(right);
  EXPECT_NEAR(right->row, 50.0, 1e-9);
  EXPECT_NEAR(right->column, 0.0, 1e-9);
  EXPECT_NEAR(right->range_m, 4.0, 1e-12);
  const auto left = g.place({-4, 0, 0});
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->column, 360.0, 1e-9);
}

TEST(ScannerGeometryPlace, FindsNothingWhereNoBeamGoes) {
  ScannerGeometry g;
  EXPECT_FALSE(g.place({0, 0, 0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(g.place({nan, 1, 0}));
  g.lever_arm_m = {0, 0, 0.1};
  EXPECT_FALSE(g.place({3, 0, 0}));  // the plane of the beams passes the axis at 0.1 m
  EXPECT_FALSE(g.place({3, 0.05, 0.05}));
  EXPECT_FALSE(g.place({0, 0, 0.1}));  // the mirror itself
  g = {};
  g.range_offset_m = 0.5;
  EXPECT_FALSE(g.place({0.3, 0.2, 0}));  // nearer than any range the scanner can print
}

TEST(ScannerGeometryPlace, TellsOutsideFromInside) {
  const ScannerGeometry g;
  const auto above = g.place(g.point(60 * kDegree, 90 * kDegree, 5));
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->row, 112.5, 1e-7);
  const auto behind = g.place({1.0, -5.0, 0.0});
  ASSERT_TRUE(behind);
  EXPECT_TRUE(behind->row < 0 || behind->row > 100 || behind->column < 0 || behind->column > 360);
}

TEST(ScannerGeometry, ChecksItself) {
  EXPECT_TRUE(ScannerGeometry().check());
  EXPECT_TRUE(calibrated().check());
  const auto refuses = [](auto change) {
    ScannerGeometry g;
    change(g);
    return !g.check();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([](auto& g) { g.rows = 0; }));
  EXPECT_TRUE(refuses([](auto& g) { g.columns = -3; }));
  EXPECT_TRUE(refuses([](auto& g) { g.rows = g.columns = 2000000000; }));
  EXPECT_TRUE(refuses([](auto& g) { g.tilt_step_rad = 0; }));
  EXPECT_TRUE(refuses([](auto& g) { g.azimuth_step_rad = 0; }));
  EXPECT_TRUE(refuses([&](auto& g) { g.tilt_zero_rad = nan; }));
  EXPECT_TRUE(refuses([&](auto& g) { g.lever_arm_m.x() = nan; }));
  EXPECT_TRUE(refuses([](auto& g) { g.mounting = Eigen::Quaterniond(1, 1, 0, 0); }));
  EXPECT_TRUE(refuses([](auto& g) { g.minimum_range_m = -1; }));
  EXPECT_TRUE(refuses([](auto& g) { g.minimum_range_m = 5, g.maximum_range_m = 4; }));
}

}  // namespace
}  // namespace tiltmap
