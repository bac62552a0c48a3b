#include "core/scan/normals.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using namespace testing_support;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct SceneNormals {
  RangeImagePtr image;
  std::vector<Vector3d> points, normals;
};

SceneNormals normalsOf(const ScannerGeometry& g, const std::function<double(const Vector3d&)>& distance) {
  SceneNormals scene;
  scene.image = imageOfScene(g, distance);
  scene.points = cellPoints(*scene.image, g);
  scene.normals = matrixNormals(*scene.image, scene.points);
  return scene;
}

std::size_t counted(const SceneNormals& scene) {
  std::size_t count = 0;
  for (const auto& normal : scene.normals) count += normal.isZero() ? 0 : 1;
  return count;
}

TEST(MatrixNormals, Equation421AsPrintedPointsAtTheScanner) {
  const ScannerGeometry g;
  const auto image = imageOfScene(g, [](const Vector3d& d) { return distanceToPlane(d, {0, 1, 0}, 5.0); });
  const auto x = [&](int row, int column) { return cellPoint(*image, g, row, column); };
  for (const auto& [i, j] : {std::pair{10, 60}, {50, 180}, {90, 300}}) {
    const Vector3d printed = (x(i - 1, j) - x(i + 1, j)).cross(x(i, j - 1) - x(i, j + 1)).normalized();
    EXPECT_LT((printed - Vector3d(0, -1, 0)).norm(), 1e-3);
    EXPECT_LT((matrixNormals(*image, cellPoints(*image, g))[image->index(i, j)] - printed).norm(), 1e-12);
  }
}

TEST(MatrixNormals, OfPlanesAreTheirs) {
  const ScannerGeometry g;
  for (const Vector3d& outward :
       {Vector3d(0, 1, 0), Vector3d(0.6, 0.8, 0), Vector3d(0, 0, -1), Vector3d(-0.6, 0.5, 0.3)}) {
    const Vector3d unit = outward.normalized();
    const auto scene = normalsOf(g, [&](const Vector3d& d) { return distanceToPlane(d, unit, 4.0); });
    ASSERT_GT(counted(scene), 2000U);
    for (const Vector3d& normal : scene.normals) {
      if (normal.isZero()) continue;
      EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
      EXPECT_LT((normal + unit).norm(), 1e-3);  // ranges are stored as float
    }
  }
}

TEST(MatrixNormals, OfASphereAroundTheScannerPointInwards) {
  const auto scene = normalsOf({}, [](const Vector3d&) { return 6.0; });
  EXPECT_GT(counted(scene), 30000U);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (scene.normals[i].isZero()) continue;
    EXPECT_GT(scene.normals[i].dot(-scene.points[i].normalized()), 0.9999);
  }
}

TEST(MatrixNormals, OfACornerAreOneWallsOrTheOthersAwayFromTheEdge) {
  const auto scene = normalsOf({}, [](const Vector3d& d) {
    return std::min(distanceToPlane(d, {0, 1, 0}, 5.0), distanceToPlane(d, {1, 0, 0}, 3.0));
  });
  std::size_t front = 0, side = 0, edge = 0;
  for (const Vector3d& normal : scene.normals) {
    if (normal.isZero()) continue;
    if ((normal - Vector3d(0, -1, 0)).norm() < 1e-2) {
      ++front;
    } else if ((normal - Vector3d(-1, 0, 0)).norm() < 1e-2) {
      ++side;
    } else {
      ++edge;
    }
  }
  EXPECT_GT(front, 5000U);
  EXPECT_GT(side, 5000U);
  EXPECT_GT(edge, 0U);        // the four neighbours of an edge lie on both walls
  EXPECT_LT(edge, 2 * 120U);  // and of no other cell
}

TEST(MatrixNormals, NoneAtTheBorderOrBesideACellWithoutAPoint) {
  const ScannerGeometry g = smallGeometry(7, 9);
  ScannerGeometry forward = g;
  forward.azimuth_start_rad = 88 * kDegree;
  RangeImageData data = evenData(forward);
  setCell(data, 3, 4, 0.0F, cell_code::kLmsOverflow);
  const auto image = imageOf(data);
  const auto normals = matrixNormals(*image, cellPoints(*image, forward));
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 9; ++column) {
      const bool border = row == 0 || row == 6 || column == 0 || column == 8;
      const bool beside = std::abs(row - 3) + std::abs(column - 4) <= 1;
      EXPECT_EQ(normals[image->index(row, column)].isZero(), border || beside) << row << " " << column;
    }
  }
}

TEST(MatrixNormals, NoneAtThePolesWhateverTheNoise) {
  const ScannerGeometry g;
  RandomStream random(3);
  const auto scene = normalsOf(g, [&](const Vector3d& d) {
    return distanceToPlane(d, {d.x() > 0 ? 1.0 : -1.0, 0, 0}, 8.0) + 0.012 * random.normal();
  });
  for (int row = 1; row < 100; ++row) {
    for (int column = 1; column < 360; ++column) {
      const std::size_t cell = scene.image->index(row, column);
      const double from_pole_deg = 0.5 * std::min(column, 360 - column);
      if (from_pole_deg < 6.0) {
        EXPECT_TRUE(scene.normals[cell].isZero()) << row << " " << column;
      } else if (from_pole_deg > 9.0 && from_pole_deg < 60.0) {
        EXPECT_FALSE(scene.normals[cell].isZero()) << row << " " << column;
      }
    }
  }
}

TEST(MatrixNormals, PointAtTheScannerAlsoInMatricesScannedTheOtherWay) {
  ScannerGeometry g;
  g.tilt_start_rad = 50 * kDegree;
  g.tilt_step_rad = -0.8 * kDegree;
  const auto scene = normalsOf(g, [](const Vector3d& d) { return distanceToPlane(d, {0, 1, 0}, 5.0); });
  ASSERT_GT(counted(scene), 20000U);
  for (const Vector3d& normal : scene.normals) EXPECT_TRUE(normal.isZero() || normal.y() < -0.99);
}

TEST(MatrixNormals, NoneWhereTheTwoDifferencesAreParallel) {
  const ScannerGeometry g = smallGeometry(3, 3);
  const auto image = imageOf(evenData(g));
  std::vector<Vector3d> line;
  for (int i = 0; i < 9; ++i) line.push_back({0.1 * i, 5.0, 0.0});
  for (const Vector3d& normal : matrixNormals(*image, line)) EXPECT_TRUE(normal.isZero());
}

TEST(MatrixNormals, NoneForUnorderedOrEmptyImagesAndRefusesOtherSizes) {
  RangeImageData data = evenData(smallGeometry(1, 5));
  data.direction.assign(5, Eigen::Vector3f::UnitY());
  const auto cloud = imageOf(data);
  for (const Vector3d& normal : matrixNormals(*cloud, cellPoints(*cloud, {}))) EXPECT_TRUE(normal.isZero());
  RangeImageData nothing = evenData(smallGeometry(4, 4));
  nothing.code.assign(16, cell_code::kNoReturn);
  const auto empty = imageOf(nothing);
  for (const Vector3d& normal : matrixNormals(*empty, cellPoints(*empty, {}))) EXPECT_TRUE(normal.isZero());
  EXPECT_THROW(matrixNormals(*empty, {}), std::invalid_argument);
}

TEST(CloudNormals, OfAPlaneAndASphere) {
  RandomStream random(4);
  std::vector<Vector3d> plane, sphere;
  for (int i = 0; i < 2000; ++i) {
    plane.push_back({random.uniform(-5, 5), 4.0, random.uniform(-5, 5)});
    sphere.push_back(6.0 * Vector3d(random.normal(), random.normal(), random.normal()).normalized());
  }
  for (const Vector3d& normal : cloudNormals(plane, 10, Vector3d::Zero()))
    EXPECT_LT((normal - Vector3d(0, -1, 0)).norm(), 1e-7);
  for (const Vector3d& normal : cloudNormals(plane, 10, {0, 9, 0}))
    EXPECT_LT((normal - Vector3d(0, 1, 0)).norm(), 1e-7);  // towards where it is seen from
  const auto normals = cloudNormals(sphere, 10, Vector3d::Zero());
  for (std::size_t i = 0; i < sphere.size(); ++i) EXPECT_GT(normals[i].dot(-sphere[i].normalized()), 0.98);
}

TEST(CloudNormals, NoneWhereNoPlaneIsSpanned) {
  const std::vector<Vector3d> one{{1, 2, 3}}, two{{1, 2, 3}, {2, 2, 3}}, same(20, Vector3d(1, 2, 3));
  std::vector<Vector3d> line;
  for (int i = 0; i < 30; ++i) line.push_back(Vector3d(1, 2, 3) + i * Vector3d(0.3, -0.1, 0.2));
  for (const auto& points : {one, two, same, line})
    for (const Vector3d& normal : cloudNormals(points, 6, Vector3d::Zero())) EXPECT_TRUE(normal.isZero());
  EXPECT_TRUE(cloudNormals({}, 6, Vector3d::Zero()).empty());
  EXPECT_FALSE(cloudNormals({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 6, Vector3d::Zero())[0].isZero());
}

TEST(CloudNormals, DoNotDependOnThreads) {
  RandomStream random(6);
  std::vector<Vector3d> points;
  for (int i = 0; i < 3000; ++i) points.push_back({random.normal(), random.normal(), 0.1 * random.normal()});
  const auto expected = cloudNormals(points, 8, {0, 0, 9}, 1);
  EXPECT_EQ(cloudNormals(points, 8, {0, 0, 9}, 2), expected);
  EXPECT_EQ(cloudNormals(points, 8, {0, 0, 9}, 4), expected);
}

TEST(CloudNormals, RefusesABrokenContract) {
  EXPECT_THROW(cloudNormals({{1, 2, 3}}, 2, Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(cloudNormals({{kInfinity, 2, 3}}, 5, Vector3d::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
