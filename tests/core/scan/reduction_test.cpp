#include "core/scan/reduction.h"

#include <limits>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/scan/normals.h"
#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using namespace testing_support;
using Eigen::Vector3d;
using ::testing::ElementsAre;

// One line of points, made without a scanner: a regular image of one row whose ranges do not matter.
struct Line {
  RangeImagePtr image;
  std::vector<Vector3d> points;
};
Line lineOf(std::vector<Vector3d> points, const std::vector<int>& holes = {}) {
  RangeImageData data = evenData(smallGeometry(1, static_cast<int>(points.size())));
  for (const int hole : holes) setCell(data, 0, hole, 0.0F, cell_code::kLmsOverflow);
  return {imageOf(data), std::move(points)};
}

TEST(ReducedAlongLines, AWallKeepsItsShape) {
  // 241 beams from 30 to 150 degrees on a wall 5 m away: 17.3 m.
  ScannerGeometry g = smallGeometry(1, 241);
  g.tilt_start_rad = 0.0;
  g.azimuth_start_rad = 30 * kDegree;
  const auto image = imageOfScene(g, [](const Vector3d& d) { return distanceToPlane(d, {0, 1, 0}, 5.0); });
  const PointCloud reduced = reducedAlongLines(*image, cellPoints(*image, g), {}, 0.5);
  EXPECT_NEAR(static_cast<double>(reduced.size()), 25.0, 2.0);
  for (std::size_t i = 0; i < reduced.size(); ++i) {
    EXPECT_NEAR(reduced.points[i].y(), 5.0, 1e-5);
    if (i == 0) continue;
    const double gap = (reduced.points[i] - reduced.points[i - 1]).norm();
    EXPECT_GE(gap, 0.5);
    EXPECT_LT(gap, 1.5);
  }
  EXPECT_GT(reduced.points.front().x(), 8.0);  // both ends are still there
  EXPECT_LT(reduced.points.back().x(), -8.0);
}

TEST(ReducedAlongLines, MergesDisjointPairsInPasses) {
  // Five points 0.2 m apart: 0.1, 0.5 and the odd one at 0.8; then 0.3 and 0.8, half a metre apart.
  const Line line = lineOf({{0.0, 5, 0}, {0.2, 5, 0}, {0.4, 5, 0}, {0.6, 5, 0}, {0.8, 5, 0}});
  const PointCloud reduced = reducedAlongLines(*line.image, line.points, {}, 0.45);
  ASSERT_EQ(reduced.size(), 2U);
  EXPECT_LT((reduced.points[0] - Vector3d(0.3, 5, 0)).norm(), 1e-12);
  EXPECT_LT((reduced.points[1] - Vector3d(0.8, 5, 0)).norm(), 1e-12);
  EXPECT_THAT(reduced.cell, ElementsAre(0, 4));
}

TEST(ReducedAlongLines, KeepsWhatIsFarEnoughApart) {
  const Line line = lineOf({{0, 5, 0}, {0.5, 5, 0}, {1.0, 5, 0}});
  EXPECT_EQ(reducedAlongLines(*line.image, line.points, {}, 0.5).points, line.points);
  EXPECT_EQ(reducedAlongLines(*line.image, line.points, {}, 0.0).points, line.points);
}

TEST(ReducedAlongLines, NeverMergesAcrossAGap) {
  const Line line = lineOf({{0, 5, 0}, {0, 0, 0}, {0.1, 5, 0}, {0, 0, 0}}, {1, 3});
  const PointCloud reduced = reducedAlongLines(*line.image, line.points, {}, 0.5);
  ASSERT_EQ(reduced.size(), 2U);
  EXPECT_EQ(reduced.points[0], line.points[0]);
  EXPECT_EQ(reduced.points[1], line.points[2]);
}

TEST(ReducedAlongLines, NeverMergesAcrossLines) {
  const auto image = imageOf(evenData(smallGeometry(3, 1)));
  const std::vector<Vector3d> points(3, Vector3d(1, 2, 3));
  EXPECT_EQ(reducedAlongLines(*image, points, {}, 0.5).size(), 3U);
}

TEST(ReducedAlongLines, AveragesNormalsAndIntensities) {
  RangeImageData data = evenData(smallGeometry(1, 5));
  data.intensity = {1, 2, 6, 100, 200};
  const auto image = imageOf(data);
  const std::vector<Vector3d> points{{0, 5, 0}, {0.1, 5, 0}, {0.2, 5, 0}, {9, 5, 0}, {9.1, 5, 0}};
  const std::vector<Vector3d> normals{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
  const PointCloud reduced = reducedAlongLines(*image, points, normals, 0.5);
  ASSERT_EQ(reduced.size(), 2U);
  EXPECT_LT((reduced.normals[0] - Vector3d(1, 1, 0).normalized()).norm(), 1e-12);
  EXPECT_FLOAT_EQ(reduced.intensity[0], 3.0F);
  EXPECT_FALSE(reduced.hasNormal(1));  // opposite ones leave none
  EXPECT_FLOAT_EQ(reduced.intensity[1], 150.0F);
}

TEST(ReducedAlongLines, AScanKeepsNoTwoNeighboursOfALineNearerThanTheDistance) {
  const ScannerGeometry g;
  RandomStream random(2);
  const auto image = imageOfScene(g, [&](const Vector3d& d) {
    const double range = std::min({distanceToPlane(d, {0, 0, -1}, 1.2), distanceToPlane(d, {0, 1, 0}, 12.0),
                                   distanceToPlane(d, {1, 0, 0}, 9.0)});
    return range + 0.012 * random.normal();
  });
  const auto points = cellPoints(*image, g);
  const PointCloud reduced = reducedAlongLines(*image, points, matrixNormals(*image, points), 0.5);
  EXPECT_LT(reduced.size(), image->validCells() / 2);
  EXPECT_GT(reduced.size(), 2000U);
  ASSERT_EQ(reduced.normals.size(), reduced.size());
  std::map<int, std::size_t> last_of_row;
  for (std::size_t i = 0; i < reduced.size(); ++i) {
    const int row = static_cast<int>(reduced.cell[i]) / 361;
    if (i > 0) {
      EXPECT_LT(reduced.cell[i - 1], reduced.cell[i]);
    }
    if (const auto last = last_of_row.find(row); last != last_of_row.end()) {
      bool gap = false;
      for (std::uint32_t cell = reduced.cell[last->second]; cell < reduced.cell[i]; ++cell)
        gap = gap || !image->hasPoint(cell);
      EXPECT_TRUE(gap || (reduced.points[i] - reduced.points[last->second]).norm() >= 0.5);
    }
    last_of_row[row] = i;
  }
}

TEST(ReducedAlongLines, AnUnorderedCloudGoesThroughAVoxelGrid) {
  RangeImageData data = evenData(smallGeometry(1, 3), 2.0F);
  data.direction = {Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY(), Eigen::Vector3f::UnitX()};
  const auto image = imageOf(data);
  const PointCloud reduced = reducedAlongLines(*image, cellPoints(*image, {}), {}, 0.5);
  ASSERT_EQ(reduced.size(), 2U);  // the first and the third are no neighbours in the line
  EXPECT_THAT(reduced.cell, ElementsAre(0, 1));
}

TEST(ReducedAlongLines, IsEmptyWhereNothingWasSeen) {
  const Line line = lineOf({{0, 0, 0}, {0, 0, 0}}, {0, 1});
  EXPECT_TRUE(reducedAlongLines(*line.image, line.points, {}, 0.5).empty());
}

TEST(ReducedAlongLines, RefusesABrokenContract) {
  const Line line = lineOf({{0, 5, 0}, {1, 5, 0}});
  EXPECT_THROW(reducedAlongLines(*line.image, {}, {}, 0.5), std::invalid_argument);
  EXPECT_THROW(reducedAlongLines(*line.image, line.points, {{0, 1, 0}}, 0.5), std::invalid_argument);
  EXPECT_THROW(reducedAlongLines(*line.image, line.points, {}, -0.5), std::invalid_argument);
  EXPECT_THROW(reducedAlongLines(*line.image, line.points, {}, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
}

TEST(VoxelReduced, GivesTheMeanOfEachCube) {
  PointCloud cloud;
  cloud.points = {{0.1, 0.1, 0.1}, {5.1, 0, 0}, {0.3, 0.2, 0.4}, {-0.1, 0.1, 0.1}};
  cloud.normals = {{0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
  cloud.intensity = {1, 2, 3, 4};
  cloud.cell = {7, 8, 9, 10};
  const PointCloud reduced = voxelReduced(cloud, 0.5);
  ASSERT_EQ(reduced.size(), 3U);
  EXPECT_LT((reduced.points[0] - Vector3d(0.2, 0.15, 0.25)).norm(), 1e-12);
  EXPECT_EQ(reduced.points[1], cloud.points[1]);
  EXPECT_EQ(reduced.points[2], cloud.points[3]);  // a cube of its own on the other side of zero
  EXPECT_EQ(reduced.normals[0], Vector3d(0, 0, 1));
  EXPECT_THAT(reduced.intensity, ElementsAre(2, 2, 4));
  EXPECT_THAT(reduced.cell, ElementsAre(7, 8, 10));
}

TEST(VoxelReduced, AgreesWithAMapOfCubes) {
  RandomStream random(9);
  PointCloud cloud;
  std::map<std::tuple<int, int, int>, int> cubes;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-1, 1));
    cloud.points.push_back(p);
    const auto cube = [](double x) { return static_cast<int>(std::floor(x / 0.25)); };
    ++cubes[{cube(p.x()), cube(p.y()), cube(p.z())}];
  }
  const PointCloud reduced = voxelReduced(cloud, 0.25);
  EXPECT_EQ(reduced.size(), cubes.size());
  EXPECT_TRUE(reduced.cell.empty());
  for (const Vector3d& p : reduced.points)
    EXPECT_EQ(
        cubes.count({static_cast<int>(std::floor(p.x() / 0.25)), static_cast<int>(std::floor(p.y() / 0.25)),
                     static_cast<int>(std::floor(p.z() / 0.25))}),
        1U);
}

TEST(VoxelReduced, TakesEmptyAndRefusesABrokenContract) {
  EXPECT_TRUE(voxelReduced({}, 1.0).empty());
  PointCloud cloud;
  cloud.points = {{1, 2, 3}};
  EXPECT_THROW(voxelReduced(cloud, 0.0), std::invalid_argument);
  EXPECT_THROW(voxelReduced(cloud, std::numeric_limits<double>::infinity()), std::invalid_argument);
  cloud.intensity = {1, 2};
  EXPECT_THROW(voxelReduced(cloud, 1.0), std::invalid_argument);
  cloud.intensity.clear();
  cloud.points[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(voxelReduced(cloud, 1.0), std::invalid_argument);
  cloud.points[0].x() = 1e300;
  EXPECT_THROW(voxelReduced(cloud, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
