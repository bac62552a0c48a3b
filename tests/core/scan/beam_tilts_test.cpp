#include "core/scan/beam_tilts.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/registration/grid_moments.h"

namespace tiltmap {
namespace {

constexpr double kWay = 0.003;  // radians in a turn: about 13 deg/s

ScannerGeometry smallGeometry(double step_deg = 0.5) {
  ScannerGeometry geometry;
  geometry.rows = 4;
  geometry.columns = 41;
  geometry.azimuth_start_rad = 1.2;
  geometry.azimuth_step_rad = step_deg * kDegree;
  geometry.tilt_zero_rad = 0.02;
  geometry.lever_arm_m = {0.1, -0.05, 0.2};
  geometry.range_offset_m = 0.03;
  return geometry;
}

RangeImageData dataOf(const ScannerGeometry& geometry) {
  RangeImageData data;
  data.rows = geometry.rows;
  data.columns = geometry.columns;
  for (int row = 0; row < data.rows; ++row) {
    data.line_tilt_rad.push_back(geometry.tiltOfRow(row) + 0.001 * row);
    for (int column = 0; column < data.columns; ++column) {
      data.range_m.push_back(static_cast<float>(4.0 + 0.1 * row + 0.01 * column));
      data.code.push_back(column % 7 == 3 ? cell_code::kLmsNoSignal : cell_code::kMeasured);
    }
  }
  return data;
}

RangeImagePtr moving(const ScannerGeometry& geometry) {
  RangeImageData data = dataOf(geometry);
  setTurnTilts(data, {kWay, 0.0, -kWay, 2.0 * kWay});
  return *RangeImage::make(std::move(data));
}

TEST(BeamTilts, TurnsOfTheMirror) {
  EXPECT_EQ(mirrorTurns(smallGeometry(1.0)), 1);
  EXPECT_EQ(mirrorTurns(smallGeometry(0.5)), 2);
  EXPECT_EQ(mirrorTurns(smallGeometry(0.25)), 4);
  EXPECT_EQ(mirrorTurns(smallGeometry(-0.5)), 2);
  // Scanners that see more than half a circle fire all beams in one turn.
  ScannerGeometry wide = smallGeometry(0.5);
  wide.columns = 361;
  EXPECT_EQ(mirrorTurns(wide), 2) << "half a circle";
  wide.columns = 381;
  EXPECT_EQ(mirrorTurns(wide), 1) << "190 degrees";
  EXPECT_NEAR(beamTurns(wide, 1), 0.5 / 360.0, 1e-12);
  const ScannerGeometry geometry = smallGeometry();
  EXPECT_DOUBLE_EQ(beamTurns(geometry, 0), 0.0);
  EXPECT_NEAR(beamTurns(geometry, 2), 1.0 / 360.0, 1e-12) << "a degree on, in the same turn";
  EXPECT_NEAR(beamTurns(geometry, 1), 1.0 + 0.5 / 360.0, 1e-12) << "odd beams a whole turn later";
}

TEST(BeamTilts, TheTiltOfALineIsThatOfItsEnd) {
  const ScannerGeometry geometry = smallGeometry();
  const RangeImagePtr image = moving(geometry);
  ASSERT_TRUE(tiltMoved(*image));
  EXPECT_EQ(lineTurnTilt(*image, 3), 2.0 * kWay);
  // The first beam is fired two turns before the end.
  EXPECT_NEAR(beamTilt(*image, geometry, 0, 0), image->lineTilt(0) - 2.0 * kWay, 1e-12);
  EXPECT_NEAR(beamTilt(*image, geometry, 0, 1) - beamTilt(*image, geometry, 0, 0), kWay * (1.0 + 0.5 / 360.0),
              1e-12);
  EXPECT_EQ(beamTilt(*image, geometry, 1, 17), image->lineTilt(1)) << "this one stood";
  EXPECT_GT(beamTilt(*image, geometry, 2, 0), image->lineTilt(2)) << "downwards";
}

TEST(BeamTilts, EveryPointLiesWhereItsOwnTiltPutsIt) {
  const ScannerGeometry geometry = smallGeometry();
  const RangeImagePtr image = moving(geometry);
  const auto points = cellPoints(*image, geometry);
  double apart = 0.0;
  for (int row = 0; row < image->rows(); ++row)
    for (int column = 0; column < image->columns(); ++column) {
      if (!image->hasPoint(row, column)) continue;
      const Eigen::Vector3d expected =
          geometry.point(beamTilt(*image, geometry, row, column), geometry.azimuthOfColumn(column),
                         static_cast<double>(image->range(row, column)));
      EXPECT_NEAR((points[image->index(row, column)] - expected).norm(), 0.0, 1e-12);
      EXPECT_EQ(cellPoint(*image, geometry, row, column), expected);
      apart = std::max(apart, (geometry.point(image->lineTilt(row), geometry.azimuthOfColumn(column),
                                              static_cast<double>(image->range(row, column))) -
                               expected)
                                  .norm());
    }
  EXPECT_GT(apart, 0.02) << "it matters";
}

TEST(BeamTilts, MomentsAreThoseOfThePoints) {
  const ScannerGeometry geometry = smallGeometry();
  const RangeImagePtr image = moving(geometry);
  const MomentGrid grid = tileMoments(*image, geometry, 2, 10, false);
  Moments expected;
  for (int row = 0; row < 2; ++row)
    for (int column = 10; column < 20; ++column) {
      if (!image->hasPoint(row, column)) continue;
      const Eigen::Vector3d p = cellPoint(*image, geometry, row, column);
      expected += {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
                   p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
    }
  const Moments& found = grid.at(0, 1);
  EXPECT_EQ(found.n, expected.n);
  EXPECT_NEAR(found.x, expected.x, 1e-9);
  EXPECT_NEAR(found.yz, expected.yz, 1e-9);
  EXPECT_NEAR(found.zz, expected.zz, 1e-9);
}

// A wall straight ahead: nothing of it is an edge, however the beams of the two turns interlace.
TEST(BeamTilts, AWallSeenOnTheWayHasNoEdges) {
  ScannerGeometry geometry;
  geometry.rows = 9;
  geometry.columns = 81;
  geometry.azimuth_start_rad = 70.0 * kDegree;
  RangeImageData data;
  data.rows = geometry.rows;
  data.columns = geometry.columns;
  for (int row = 0; row < data.rows; ++row) data.line_tilt_rad.push_back(0.5 + geometry.tilt_step_rad * row);
  data.range_m.assign(data.cells(), 1.0F);
  data.code.assign(data.cells(), cell_code::kMeasured);
  setTurnTilts(data, std::vector<double>(9, kWay));
  const RangeImagePtr blank = *RangeImage::make(data);
  for (int row = 0; row < data.rows; ++row)
    for (int column = 0; column < data.columns; ++column) {
      const Eigen::Vector3d beam =
          geometry.direction(beamTilt(*blank, geometry, row, column), geometry.azimuthOfColumn(column));
      data.range_m[blank->index(row, column)] = static_cast<float>(10.0 / beam.y());
    }
  const auto used = [&](const RangeImagePtr& image) {
    const MomentGrid grid = tileMoments(*image, geometry, 9, 81, true);
    return grid.at(0, 0).n;
  };
  EXPECT_EQ(used(*RangeImage::make(data)), 7.0 * 77.0) << "all but the border";
}

TEST(BeamTilts, WithoutThemEveryLineIsTakenAsOne) {
  const ScannerGeometry geometry = smallGeometry();
  const RangeImagePtr image = moving(geometry);
  const RangeImagePtr flat = *withoutBeamTilts(*image, geometry);
  EXPECT_FALSE(tiltMoved(*flat));
  EXPECT_NEAR(flat->lineTilt(0), image->lineTilt(0) - kWay, 1e-12) << "the middle of two turns";
  EXPECT_EQ(flat->lineTilt(1), image->lineTilt(1));
  EXPECT_EQ(flat->data().range_m, image->data().range_m);
}

TEST(BeamTilts, TheTableOfARowIsTheSame) {
  const ScannerGeometry geometry = smallGeometry();
  const RangeImagePtr image = moving(geometry);
  BeamTilts tilts(*image, geometry);
  for (const int row : {3, 0, 1, 2, 0}) {
    tilts.setRow(row);
    for (int column = 0; column < image->columns(); ++column) {
      const double e = beamTilt(*image, geometry, row, column) + geometry.tilt_zero_rad;
      EXPECT_NEAR(tilts.cosine(static_cast<std::size_t>(column)), std::cos(e), 1e-12);
      EXPECT_NEAR(tilts.sine(static_cast<std::size_t>(column)), std::sin(e), 1e-12);
    }
  }
}

TEST(BeamTilts, WaysThatDoNotFitAreRefused) {
  const ScannerGeometry geometry = smallGeometry();
  RangeImageData data = dataOf(geometry);
  EXPECT_THROW(setTurnTilts(data, {kWay}), std::invalid_argument);
  setTurnTilts(data, {0.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(data.line_tilt_rad.size(), 4U) << "it stood";
  data.line_tilt_rad.push_back(kWay);
  EXPECT_FALSE(RangeImage::make(data)) << "neither one nor two a row";
  data = dataOf(geometry);
  setTurnTilts(data, {kWay, std::nan(""), kWay, kWay});
  EXPECT_FALSE(RangeImage::make(data));
}

}  // namespace
}  // namespace tiltmap
