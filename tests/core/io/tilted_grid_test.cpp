#include "core/io/tilted_grid.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/geometry/pose.h"

namespace tiltmap {
namespace {

struct Sweep {
  ScannerGeometry geometry;
  std::vector<Eigen::Vector3d> points;
  std::vector<bool> valid;
};

// Ranges from 1 to 30 m at random, some cells empty.
Sweep sweep(int rows, int columns, double azimuth_start_deg, double azimuth_step_deg, double tilt_start_deg,
            double tilt_step_deg, double empty = 0.05) {
  Sweep s;
  s.geometry.rows = rows;
  s.geometry.columns = columns;
  s.geometry.azimuth_start_rad = azimuth_start_deg * kDegree;
  s.geometry.azimuth_step_rad = azimuth_step_deg * kDegree;
  s.geometry.tilt_start_rad = tilt_start_deg * kDegree;
  s.geometry.tilt_step_rad = tilt_step_deg * kDegree;
  RandomStream random(11);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const bool valid = random.uniform() >= empty;
      s.valid.push_back(valid);
      s.points.push_back(valid
                             ? s.geometry.point(s.geometry.tiltOfRow(row), s.geometry.azimuthOfColumn(column),
                                                random.uniform(1.0, 30.0))
                             : Eigen::Vector3d::Zero());
    }
  }
  return s;
}

void expectRegained(const Sweep& s) {
  const auto grid = fitTiltedGrid(s.geometry.rows, s.geometry.columns, s.points, s.valid, 1e-4);
  ASSERT_TRUE(grid);
  for (int row = 0; row < s.geometry.rows; ++row) {
    for (int column = 0; column < s.geometry.columns; ++column) {
      const auto cell = static_cast<std::size_t>(row * s.geometry.columns + column);
      if (!s.valid[cell]) {
        EXPECT_EQ(grid->range_m[cell], 0.0F);
        continue;
      }
      const Eigen::Vector3d again = grid->geometry.point(grid->line_tilt_rad[static_cast<std::size_t>(row)],
                                                         grid->geometry.azimuthOfColumn(column),
                                                         static_cast<double>(grid->range_m[cell]));
      ASSERT_LT((again - s.points[cell]).norm(), 1e-5) << row << " " << column;
    }
  }
}

TEST(TiltedGrid, TheDefaultScannerIsRegained) {
  const Sweep s = sweep(101, 361, 0, 0.5, -30, 0.8);
  expectRegained(s);
  const auto grid = fitTiltedGrid(101, 361, s.points, s.valid, 1e-4);
  ASSERT_TRUE(grid);
  EXPECT_NEAR(grid->geometry.azimuth_start_rad, 0.0, 1e-12);
  EXPECT_NEAR(grid->geometry.azimuth_step_rad, 0.5 * kDegree, 1e-12);
  EXPECT_NEAR(grid->geometry.tilt_start_rad, -30 * kDegree, 1e-9);
  EXPECT_NEAR(grid->geometry.tilt_step_rad, 0.8 * kDegree, 1e-9);
}

TEST(TiltedGrid, OtherScannersAreRegained) {
  expectRegained(sweep(40, 100, 40, 1, -20, 1));          // 100 degrees
  expectRegained(sweep(40, 100, 140, -1, -20, 1));        // the other way round
  expectRegained(sweep(40, 100, 40, 1, 50, -1.5));        // from above to below
  expectRegained(sweep(60, 541, -45, 0.5, -30, 1));       // 270 degrees, behind itself
  expectRegained(sweep(20, 181, 0, 1.0 / 3.0, -100, 3));  // an odd step, beyond straight down
  expectRegained(sweep(90, 180, 0, 2, -80, 2));           // full circle
  expectRegained(sweep(2, 8, 20, 10, 0, 5, 0.0));         // the smallest list that counts
}

TEST(TiltedGrid, LinesWithoutAnyPointGetTheTiltBetweenTheirNeighbours) {
  Sweep s = sweep(30, 91, 0, 2, -30, 2);
  for (const int row : {0, 7, 8, 29})
    for (int column = 0; column < 91; ++column) s.valid[static_cast<std::size_t>(row * 91 + column)] = false;
  const auto grid = fitTiltedGrid(30, 91, s.points, s.valid, 1e-4);
  ASSERT_TRUE(grid);
  EXPECT_NEAR(grid->line_tilt_rad[7], -16 * kDegree, 1e-6);
  EXPECT_NEAR(grid->line_tilt_rad[29], 28 * kDegree, 1e-6);
}

TEST(TiltedGrid, UnevenTiltsAreKeptLineByLine) {
  Sweep s = sweep(30, 91, 0, 2, -30, 2, 0.0);
  const double odd = 0.7 * kDegree;
  for (int column = 0; column < 91; ++column) {
    auto& p = s.points[static_cast<std::size_t>(12 * 91 + column)];
    p = Eigen::AngleAxisd(odd, Eigen::Vector3d::UnitX()) * p;
  }
  const auto grid = fitTiltedGrid(30, 91, s.points, s.valid, 1e-4);
  ASSERT_TRUE(grid);
  EXPECT_NEAR(grid->line_tilt_rad[12], -6 * kDegree + odd, 1e-7);
  EXPECT_NEAR(grid->line_tilt_rad[13], -4 * kDegree, 1e-7);
}

TEST(TiltedGrid, OnePointOffByMoreThanTheToleranceIsNoGrid) {
  Sweep s = sweep(30, 91, 0, 2, -30, 2, 0.0);
  s.points[1000] += 2e-4 * Eigen::Vector3d(1, 1, 1);
  EXPECT_FALSE(fitTiltedGrid(30, 91, s.points, s.valid, 1e-4));
  s.valid[1000] = false;
  EXPECT_TRUE(fitTiltedGrid(30, 91, s.points, s.valid, 1e-4));
}

TEST(TiltedGrid, WhatIsNoSweepIsNoGrid) {
  RandomStream random(1);
  std::vector<Eigen::Vector3d> cloud(200);
  for (auto& p : cloud) p = {random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)};
  EXPECT_FALSE(fitTiltedGrid(10, 20, cloud, std::vector<bool>(200, true), 1e-4));
  EXPECT_FALSE(fitTiltedGrid(10, 20, cloud, std::vector<bool>(200, false), 1e-4));
  EXPECT_FALSE(fitTiltedGrid(1, 200, cloud, std::vector<bool>(200, true), 1e-4));
  const std::vector<Eigen::Vector3d> same(200, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(fitTiltedGrid(10, 20, same, std::vector<bool>(200, true), 1e-4));
}

TEST(LineLength, IsFoundInAListWithHoles) {
  for (const double empty : {0.0, 0.05, 0.4}) {
    const Sweep s = sweep(50, 361, 0, 0.5, -30, 0.8, empty);
    EXPECT_EQ(lineLength(s.points, s.valid), 361) << empty;
  }
  const Sweep backwards = sweep(50, 180, 179, -1, -30, 0.8);
  EXPECT_EQ(lineLength(backwards.points, backwards.valid), 180);
  const Sweep wide = sweep(50, 541, -45, 0.5, -30, 0.8);
  EXPECT_EQ(lineLength(wide.points, wide.valid), 541);
}

TEST(LineLength, IsNotMadeUp) {
  RandomStream random(1);
  std::vector<Eigen::Vector3d> cloud(1009);  // a prime
  for (auto& p : cloud) p = {random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)};
  EXPECT_FALSE(lineLength(cloud, std::vector<bool>(1009, true)));
  EXPECT_FALSE(lineLength({}, {}));
  const Sweep one_line = sweep(1, 361, 0, 0.5, -30, 0.8);
  EXPECT_FALSE(lineLength(one_line.points, one_line.valid));
}

}  // namespace
}  // namespace tiltmap
