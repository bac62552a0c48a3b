#include "core/world/simulated_scanner.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Ground pit() {
  return Ground([](double, double) { return -50.0; }, {-10, -10}, {10, 10});
}
// A wall across the view, its face at y = distance; reflectivity as given.
Site wallAt(double distance, double reflectivity, double left = -200.0) {
  return Site(pit(), {Hull::box(Isometry3d::Identity(), {left, distance, -40.0},
                                {200.0, distance + 1.0, 80.0}, reflectivity)});
}
TiltFunction still(double tilt) {
  return [tilt](double) { return tilt; };
}

TEST(SimulatedScanner, WallIsWhereItIs) {
  const Site site = wallAt(12.0, 0.6);
  LmsBeam beam;
  beam.noise_m = 0.0;
  const ScannerGeometry geometry;
  const auto echoes = castLine(site, Pose(), geometry, still(0.2), 0.0, RandomStream(1), beam);
  ASSERT_EQ(echoes.size(), 361U);
  for (int j = 60; j <= 300; ++j) {
    const Echo& echo = echoes[static_cast<std::size_t>(j)];
    ASSERT_EQ(echo.code, cell_code::kMeasured) << j;
    const double expected = 12.0 / geometry.direction(0.2, geometry.azimuthOfColumn(j)).y();
    // Half a centimetre of rounding, and the spot's mean over a slanted wall.
    EXPECT_NEAR(echo.range_m, expected, 0.006 + 1e-4 * expected) << j;
    EXPECT_NEAR(echo.intensity, 255.0 * 0.6, 25.0);
  }
}

TEST(SimulatedScanner, RangesComeInWholeCentimetres) {
  for (const Echo& echo : castLine(wallAt(9.0, 0.6), Pose(), {}, still(0.0), 0.0, RandomStream(1)))
    if (echo.code == cell_code::kMeasured) {
      EXPECT_NEAR(echo.range_m * 100.0, std::round(echo.range_m * 100.0), 2e-3);
    }
}

TEST(SimulatedScanner, NoiseHasTwelveMillimetres) {
  const Site site = wallAt(10.0, 0.7);
  LmsBeam beam;
  beam.resolution_m = 0.0;
  const ScannerGeometry geometry;
  LmsBeam quiet = beam;
  quiet.noise_m = 0.0;
  double sum = 0.0, squares = 0.0;
  int count = 0;
  const auto clean = castLine(site, Pose(), geometry, still(0.0), 0.0, RandomStream(0), quiet);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto noisy = castLine(site, Pose(), geometry, still(0.0), 0.0, RandomStream(seed), beam);
    for (std::size_t j = 90; j <= 270; ++j) {
      const double error = double{noisy[j].range_m} - double{clean[j].range_m};
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 0.0, 0.0006);  // 7240 ranges: 0.14 mm
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.012, 0.0005);
}

TEST(SimulatedScanner, EdgeStrikesLieInBetween) {
  // Two walls 1.2 m apart in depth; the nearer one ends in the middle of the view.
  const Site site(pit(), {Hull::box(Isometry3d::Identity(), {-50, 10.0, -40}, {0.0, 10.1, 40}, 0.5),
                          Hull::box(Isometry3d::Identity(), {-50, 11.2, -40}, {50, 11.4, 40}, 0.5)});
  LmsBeam beam;
  beam.noise_m = 0.0;
  int between = 0, near = 0, far = 0;
  for (double x = -0.15; x <= 0.15; x += 0.005) {
    const Vector3d direction = Vector3d(x, 10.0, 0.0).normalized();
    const Pulse pulse = castPulse(site, {Vector3d::Zero(), direction}, Vector3d::UnitX(), beam);
    ASSERT_TRUE(pulse.any);
    if (pulse.range_m < 10.05)
      ++near;
    else if (pulse.range_m > 11.15)
      ++far;
    else
      ++between;
  }
  // The spot is 13.5 cm wide there.
  EXPECT_GE(between, 15);
  EXPECT_GE(near, 10);
  EXPECT_GE(far, 10);
}

TEST(SimulatedScanner, FarBehindAnEdgeTheFirstPulseCounts) {
  const Site site(pit(), {Hull::box(Isometry3d::Identity(), {-50, 10.0, -40}, {0.0, 10.1, 40}, 0.5),
                          Hull::box(Isometry3d::Identity(), {-50, 25.0, -40}, {50, 25.4, 40}, 0.5)});
  const Pulse pulse = castPulse(site, {Vector3d::Zero(), Vector3d::UnitY()}, Vector3d::UnitX(), {});
  EXPECT_NEAR(pulse.range_m, 10.0, 0.02);
}

TEST(SimulatedScanner, CodesTellNothingFromFarAndDark) {
  std::map<CellCode, int> nothing, far, dark;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (const Echo& echo : castLine(Site(pit(), {}), Pose(), {}, still(0.3), 0.0, RandomStream(seed)))
      ++nothing[echo.code];
    const auto far_line = castLine(wallAt(83.0, 0.99), Pose(), {}, still(0.0), 0.0, RandomStream(seed),
                                   {.sensitivity_m = 60.0});
    const auto dark_line = castLine(wallAt(60.0, 0.1), Pose(), {}, still(0.0), 0.0, RandomStream(seed));
    for (std::size_t j = 170; j < 190; ++j) {
      ++far[far_line[j].code];
      ++dark[dark_line[j].code];
    }
  }
  EXPECT_EQ(nothing[cell_code::kLmsNoSignal] + nothing[cell_code::kLmsOverflow], 4 * 361);
  EXPECT_GT(nothing[cell_code::kLmsNoSignal], 800);
  EXPECT_GT(nothing[cell_code::kLmsOverflow], 200);
  EXPECT_EQ(far[cell_code::kLmsFirst], 80);
  EXPECT_EQ(dark[cell_code::kMeasured], 0);
  EXPECT_EQ(dark[cell_code::kLmsFirst], 0);
  // 10 % is seen to 42 m.
  for (const Echo& echo : castLine(wallAt(36.0, 0.11), Pose(), {}, still(0.0), 0.0, RandomStream(1)))
    if (echo.code == cell_code::kMeasured) ++dark[cell_code::kMeasured];
  EXPECT_GT(dark[cell_code::kMeasured], 20);
}

TEST(SimulatedScanner, EvenBeamsComeATurnBeforeTheOddOnes) {
  const ScannerGeometry geometry;
  const LmsBeam beam;
  EXPECT_DOUBLE_EQ(beamDelay(geometry, beam, 0), 0.0);
  EXPECT_NEAR(beamDelay(geometry, beam, 360), 0.00666, 1e-9);
  EXPECT_NEAR(beamDelay(geometry, beam, 1), 0.01332 * (1.0 + 0.5 / 360.0), 1e-12);
  EXPECT_NEAR(lineDuration(geometry, beam), 0.02664, 1e-12);
  ScannerGeometry coarse;
  coarse.columns = 181;
  coarse.azimuth_step_rad = kDegree;
  EXPECT_NEAR(beamDelay(coarse, beam, 1), 0.01332 / 360.0, 1e-12);
}

TEST(SimulatedScanner, EachBeamIsCastAtTheTiltOfItsOwnInstant) {
  // Straight ahead a wall is at 10 / cos(tilt): the range tells the tilt it was taken at.
  const Site site = wallAt(10.0, 0.6);
  LmsBeam beam;
  beam.noise_m = 0.0;
  beam.resolution_m = 0.0;
  const ScannerGeometry geometry;
  const double start = 1000.0, speed = 1.0;  // rad/s, fast enough to see
  const auto tilt = [&](double t) { return 0.4 + speed * (t - start); };
  const auto echoes = castLine(site, Pose(), geometry, tilt, start, RandomStream(1), beam);
  for (const int j : {140, 179, 180, 181, 220}) {
    const double e = tilt(start + beamDelay(geometry, beam, j));
    const double expected = 10.0 / geometry.direction(e, geometry.azimuthOfColumn(j)).y();
    const double sluggish = 10.0 / geometry.direction(0.4, geometry.azimuthOfColumn(j)).y();
    EXPECT_NEAR(echoes[static_cast<std::size_t>(j)].range_m, expected, 0.002) << j;
    EXPECT_GT(std::abs(sluggish - expected), 0.01) << j;
  }
}

TEST(SimulatedScanner, CalibrationMovesTheBeams) {
  const Site site = wallAt(10.0, 0.6);
  LmsBeam beam;
  beam.noise_m = 0.0;
  beam.resolution_m = 0.0;
  ScannerGeometry geometry;
  geometry.lever_arm_m = {0.0, 0.2, 0.05};
  geometry.range_offset_m = 0.03;
  geometry.tilt_zero_rad = 0.02;
  const auto echoes = castLine(site, Pose(), geometry, still(0.3), 0.0, RandomStream(1), beam);
  for (const int j : {100, 180, 250})
    EXPECT_NEAR(
        geometry.point(0.3, geometry.azimuthOfColumn(j), echoes[static_cast<std::size_t>(j)].range_m).y(),
        10.0, 0.003);
}

}  // namespace
}  // namespace tiltmap
