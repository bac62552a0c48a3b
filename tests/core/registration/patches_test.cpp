// Plane patches of cubes and of blocks, and what blocks are made of and found by.
#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/registration/block_patches.h"
#include "core/registration/cube_patches.h"
#include "core/registration/grid_moments.h"
#include "core/registration/patch_raster.h"
#include "core/registration/plane_patch.h"
#include "core/registration/prepared_scan.h"
#include "tests/support/range_images.h"
#include "tests/support/room_scene.h"

namespace tiltmap {
namespace {

using V = Eigen::Vector3d;

Scan room(double noise_m) {
  return test_support::sceneScan(test_support::roomScene(), Pose(), noise_m, 4);
}

// The same beams as directions of their own, as a file by others would have them.
Scan withDirections(const Scan& scan) {
  RangeImageData data = scan.image->data();
  data.direction.assign(data.cells(), Eigen::Vector3f::Zero());
  for (int row = 0; row < data.rows; ++row)
    for (int column = 0; column < data.columns; ++column) {
      if (!scan.image->hasPoint(row, column)) continue;
      const V p = cellPoint(*scan.image, scan.geometry, row, column);
      const std::size_t cell = scan.image->index(row, column);
      data.direction[cell] = p.normalized().cast<float>();
      data.range_m[cell] = static_cast<float>(p.norm());
    }
  Scan other = scan;
  other.image = RangeImage::make(std::move(data)).value();
  return other;
}

void expectOnTheRoom(const SurfaceElements& patches, std::size_t valid_cells) {
  ASSERT_GT(patches.size(), 50U);
  ASSERT_TRUE(patches.arePatches());
  std::size_t on_surface = 0, cells = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    EXPECT_NEAR(patches.normal[i].norm(), 1.0, 1e-9);
    EXPECT_LE(patches.normal[i].dot(patches.position[i]), 0.0);  // towards the scanner
    EXPECT_NEAR(patches.normal[i].dot(patches.shape[i].u), 0.0, 1e-6);
    EXPECT_GT(patches.shape[i].offset_variance_m2, 0.0);
    cells += patches.shape[i].count;
    for (const auto& plane : test_support::roomScene())
      if (std::abs(plane.normal.dot(patches.position[i]) - plane.offset_m) < 0.01 &&
          std::abs(plane.normal.dot(patches.normal[i])) > std::cos(5 * kDegree)) {
        ++on_surface;
        break;
      }
  }
  EXPECT_GT(static_cast<double>(on_surface), 0.85 * static_cast<double>(patches.size()));
  EXPECT_LE(cells, valid_cells);
  EXPECT_GT(static_cast<double>(cells), 0.8 * static_cast<double>(valid_cells));
}

// Against Eigen's solver, from walls to needles, far from and near to double eigenvalues.
TEST(PlaneAxes, AreThoseOfTheCovariance) {
  RandomStream random(3);
  for (int i = 0; i < 2000; ++i) {
    const V roots(std::pow(10.0, random.uniform(-7.0, -3.0)), std::pow(10.0, random.uniform(-4.0, -1.0)),
                  std::pow(10.0, random.uniform(-3.0, 0.0)));
    const Eigen::Matrix3d turn =
        rotationExp(3.0 * V(random.normal(), random.normal(), random.normal())).toRotationMatrix();
    Eigen::Matrix3d covariance = turn * roots.asDiagonal() * turn.transpose();
    covariance = (0.5 * (covariance + covariance.transpose())).eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    const V expected = solver.eigenvalues();
    const PlaneAxes found = planeAxes(covariance);
    const double tolerance = expected[1] < 1.2 * expected[0] ? 0.01 : 1e-6;
    EXPECT_NEAR(found.values[0], expected[0], tolerance * expected[0] + 1e-12);
    EXPECT_NEAR(found.values[1], expected[1], tolerance * expected[1] + 1e-12);
    EXPECT_NEAR(found.values[2], expected[2], 1e-9 * expected[2]);
    EXPECT_LT((found.axes.transpose() * found.axes - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    if (expected[1] > 2.0 * expected[0]) {
      EXPECT_GT(std::abs(found.axes.col(0).dot(solver.eigenvectors().col(0))), 1.0 - 1e-6);
    }
    if (expected[2] > 2.0 * expected[1]) {
      EXPECT_GT(std::abs(found.axes.col(2).dot(solver.eigenvectors().col(2))), 1.0 - 1e-6);
    }
    EXPECT_LE(leastResidual(covariance), expected[0] * (1.0 + 1e-6) + 1e-15);
    EXPECT_GE(3.001 * leastResidual(covariance) + 1e-12, expected[0]);
  }
}

// A point, a line, a plane without noise, a ball: numbers, and axes that are axes.
TEST(PlaneAxes, OfWhatIsNoPlane) {
  for (const V& roots : {V(0, 0, 0), V(0, 0, 1), V(0, 1, 1), V(1, 1, 1), V(0, 1e-9, 1), V(1e-9, 1e-9, 1)}) {
    const Eigen::Matrix3d turn = rotationExp(V(0.3, -0.5, 0.7)).toRotationMatrix();
    const PlaneAxes found = planeAxes(turn * roots.asDiagonal() * turn.transpose());
    EXPECT_TRUE(found.values.allFinite());
    EXPECT_LT((found.values - roots).norm(), 1e-3 * (roots.norm() + 1e-6));
    EXPECT_LT((found.axes.transpose() * found.axes - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  }
}

TEST(Patches, FarGroundIsSetBackByTheSpotOrLeftOut) {
  const double spot_rad = 0.16 * kDegree;
  // What a wide spot makes of the ground one metre below: ranges short by (s tan incidence)^2 of themselves.
  const ScannerGeometry geometry;
  const RangeImagePtr image = testing_support::imageOfScene(geometry, [&](const V& direction) {
    const double cos_incidence = -direction.z();
    if (cos_incidence < 0.03) return 100.0;
    return (1.0 - spot_rad * spot_rad * (1.0 / (cos_incidence * cos_incidence) - 1.0)) / cos_incidence;
  });
  RegistrationSettings s;
  s.patch_spot_rad = 0.0;
  const auto highest = [&](double& furthest_m) {
    double height_m = -1.0;
    furthest_m = 0.0;
    const SurfaceElements patches = blockPatches(*image, geometry, s).elements;
    EXPECT_GT(patches.size(), 20U);
    for (const V& p : patches.position) {
      height_m = std::max(height_m, p.z());
      furthest_m = std::max(furthest_m, p.norm());
    }
    return height_m + 1.0;
  };
  double furthest_m = 0.0;
  EXPECT_GT(highest(furthest_m), 2e-3);
  EXPECT_GT(furthest_m, 16.0);
  s.patch_spot_rad = spot_rad;
  EXPECT_LT(highest(furthest_m), 5e-4);
  // Drawn out to two metres at 13.4 m.
  EXPECT_GT(furthest_m, 10.0);
  EXPECT_LT(furthest_m, 14.0);
}

TEST(CubePatches, LieOnTheSurfacesOfTheRoom) {
  const Scan scan = room(0.005);
  expectOnTheRoom(cubePatches(*scan.image, cellPoints(*scan.image, scan.geometry), {}),
                  scan.image->validCells());
}

TEST(BlockPatches, LieOnTheSurfacesOfTheRoom) {
  const Scan scan = room(0.005);
  expectOnTheRoom(blockPatches(*scan.image, scan.geometry, {}).elements, scan.image->validCells());
  const Scan other = withDirections(scan);
  expectOnTheRoom(blockPatches(*other.image, other.geometry, {}).elements, other.image->validCells());
}

TEST(BlockPatches, AreAsLargeAsThePlaneAllowsButNoLarger) {
  const Scan scan = room(0.005);
  RegistrationSettings s;
  const SurfaceElements usual = blockPatches(*scan.image, scan.geometry, s).elements;
  s.patch_block_m = 0.4;
  const SurfaceElements small = blockPatches(*scan.image, scan.geometry, s).elements;
  EXPECT_GT(small.size(), 2 * usual.size());
  std::uint32_t largest = 0;
  for (const PatchShape& shape : usual.shape) {
    largest = std::max(largest, shape.count);
    // A uniform side of 1 m has a deviation of 1 m / 12^(1/2); the smallest block may be larger far away.
    if (shape.count <= 8) continue;
    EXPECT_LE(shape.extent_u_m, 1.0 / std::sqrt(12.0) + 1e-9);
  }
  EXPECT_GT(largest, 100U);
}

TEST(BlockPatches, OfAnEmptyMatrixAreNone) {
  ScannerGeometry geometry;
  RangeImageData data = testing_support::evenData(geometry);
  std::ranges::fill(data.range_m, 0.0F);
  std::ranges::fill(data.code, cell_code::kLmsOverflow);
  EXPECT_TRUE(blockPatches(*testing_support::imageOf(data), geometry, {}).elements.empty());
}

TEST(BlockPatches, AreSeenWhereTheyLie) {
  const Scan scan = room(0.0);
  const BlockPatches blocks = blockPatches(*scan.image, scan.geometry, {});
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < blocks.elements.size(); ++i) {
    bool seen = false;
    blocks.raster.around(blocks.elements.position[i], 1, [&](std::uint32_t patch) {
      seen |= patch == i;
      return !seen;
    });
    if (seen) ++found;
  }
  EXPECT_GT(static_cast<double>(found), 0.9 * static_cast<double>(blocks.elements.size()));
}

// The moments of tiles against sums over the points, with all that calibration can do to a beam.
TEST(GridMoments, AreThoseOfThePoints) {
  Scan scan = room(0.01);
  scan.geometry.tilt_zero_rad = 0.02;
  scan.geometry.lever_arm_m = {0.03, 0.05, -0.08};
  scan.geometry.mounting = Eigen::Quaterniond(Eigen::AngleAxisd(0.03, V(1, 2, 3).normalized()));
  scan.geometry.range_offset_m = 0.07;
  for (const Scan& each : {scan, withDirections(scan)}) {
    const std::vector<V> points = cellPoints(*each.image, each.geometry);
    const MomentGrid grid = tileMoments(*each.image, each.geometry, 7, 11, false);
    ASSERT_EQ(grid.rows, 15);
    ASSERT_EQ(grid.columns, 33);
    for (const auto& [row, column] :
         {std::pair(0, 0), std::pair(7, 16), std::pair(14, 32), std::pair(3, 20)}) {
      double n = 0.0;
      V first = V::Zero();
      Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
      for (int r = 7 * row; r < std::min(7 * row + 7, 101); ++r)
        for (int c = 11 * column; c < std::min(11 * column + 11, 361); ++c) {
          if (!each.image->hasPoint(r, c)) continue;
          const V p = points[each.image->index(r, c)];
          n += 1.0, first += p, second += p * p.transpose();
        }
      const Moments& m = grid.at(row, column);
      ASSERT_EQ(m.n, n);
      ASSERT_GT(n, 0.0);
      EXPECT_LT((m.mean() - first / n).norm(), 1e-9);
      const V mean = first / n;
      EXPECT_LT((m.covariance() - (second / n - mean * mean.transpose())).norm(), 1e-9);
    }
  }
}

TEST(GridMoments, HalvedKeepTheSum) {
  const Scan scan = room(0.01);
  MomentGrid grid = tileMoments(*scan.image, scan.geometry, 3, 6, false);
  const auto sum = [](const MomentGrid& g) {
    Moments all;
    for (const Moments& m : g.tile) all += m;
    return all;
  };
  const Moments before = sum(grid);
  while (grid.rows > 1 || grid.columns > 1) {
    MomentGrid coarse;
    halve(grid, coarse);
    grid = std::move(coarse);
  }
  EXPECT_EQ(grid.tile.size(), 1U);
  EXPECT_EQ(grid.tile[0].n, before.n);
  EXPECT_NEAR(grid.tile[0].xy, before.xy, 1e-6 * std::abs(before.xy));
  EXPECT_NEAR(grid.tile[0].zz, before.zz, 1e-6 * std::abs(before.zz));
}

// A pole 1 m before a wall: the wall's own cells stay, those along the pole go.
TEST(GridMoments, LeaveOutCellsAtDepthEdges) {
  ScannerGeometry geometry;
  const Scan wall = test_support::sceneScan({{{0, 1, 0}, 5.0}}, Pose());
  const auto used = [&](const RangeImagePtr& image, int row, int column) {
    return tileMoments(*image, geometry, 1, 1, true).at(row, column).n;
  };
  EXPECT_EQ(used(wall.image, 50, 180), 1.0);
  EXPECT_EQ(used(wall.image, 0, 180), 0.0);  // no neighbour above: nothing is known
  RangeImageData data = wall.image->data();
  for (int row = 0; row < 101; ++row) data.range_m[wall.image->index(row, 180)] -= 1.0F;
  const RangeImagePtr pole = testing_support::imageOf(data);
  for (const int column : {179, 180, 181}) EXPECT_EQ(used(pole, 50, column), 0.0) << column;
  for (const int column : {177, 178, 182, 183}) EXPECT_EQ(used(pole, 50, column), 1.0) << column;
}

TEST(GridMoments, RefuseTilesWithoutCells) {
  const Scan scan = room(0.0);
  EXPECT_THROW(tileMoments(*scan.image, scan.geometry, 0, 6, false), std::invalid_argument);
}

TEST(PatchRaster, FindsWhatWasPaintedInTheSameDirectionAtAnyRange) {
  RandomStream random(3);
  for (int i = 0; i < 2000; ++i) {
    const V p(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5));
    PatchRaster raster;
    raster.paint(p, 7);
    std::vector<std::uint32_t> seen;
    raster.around(3.0 * p, 1, [&](std::uint32_t patch) {
      seen.push_back(patch);
      return true;
    });
    EXPECT_EQ(seen, std::vector<std::uint32_t>{7}) << p.transpose();
    seen.clear();
    raster.around(-p, 3, [&](std::uint32_t patch) {
      seen.push_back(patch);
      return true;
    });
    EXPECT_TRUE(seen.empty()) << p.transpose();
  }
}

TEST(PatchRaster, LooksFurtherWithALongerReachAndStopsWhenTold) {
  PatchRaster raster;
  const auto at = [](double azimuth_deg, double tilt_deg) {
    return ScannerGeometry().direction(tilt_deg * kDegree, azimuth_deg * kDegree);
  };
  raster.paint(at(90.0, 0.5), 1);
  raster.paint(at(90.0, 5.2), 2);
  const auto seen = [&](int reach, std::size_t most) {
    std::vector<std::uint32_t> all;
    raster.around(at(90.0, 0.5), reach, [&](std::uint32_t patch) {
      all.push_back(patch);
      return all.size() < most;
    });
    return all;
  };
  EXPECT_EQ(seen(1, 9), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(seen(3, 9), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(seen(3, 1), (std::vector<std::uint32_t>{1}));
  EXPECT_TRUE([&] {
    bool any = false;
    raster.around(V::Zero(), 3, [&](std::uint32_t) { return any = true; });
    return !any;
  }());
}

TEST(PatchRaster, ClosesGapsBetweenTilesOnly) {
  PatchRaster raster;
  const ScannerGeometry g;
  raster.paint(g.direction(0.0, 80.0 * kDegree), 1);
  raster.closeGaps();
  const auto sees = [&](double azimuth_deg) {
    bool any = false;
    raster.around(g.direction(0.0, azimuth_deg * kDegree), 0, [&](std::uint32_t) { return any = true; });
    return any;
  };
  EXPECT_TRUE(sees(80.0));
  EXPECT_TRUE(sees(81.5));
  EXPECT_FALSE(sees(84.0));
}

// Which of the two a scan is cut into.
TEST(Prepare, CutsIntoBlocksWhereAMatrixMostlyLooksFar) {
  const Scan near = room(0.0);
  const Scan far = test_support::sceneScan({{{0, 1, 0}, 12.0}, {{1, 0, 0}, 10.0}}, Pose());
  RegistrationSettings s;
  EXPECT_TRUE(prepare(far, s)->raster.has_value());
  EXPECT_FALSE(prepare(far, s)->directions.has_value());
  s.patch_near_m = 30.0;
  EXPECT_FALSE(prepare(far, s)->raster.has_value());
  EXPECT_TRUE(prepare(far, s)->directions.has_value());
  s = {};
  s.patch_near_m = 8.0;
  EXPECT_FALSE(prepare(near, s)->raster.has_value());
  s.patch_grouping = PatchGrouping::Blocks;
  EXPECT_TRUE(prepare(near, s)->raster.has_value());
  s.patch_grouping = PatchGrouping::Cubes;
  EXPECT_FALSE(prepare(far, s)->raster.has_value());
}

}  // namespace
}  // namespace tiltmap
