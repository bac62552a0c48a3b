// What is written comes back: by our readers, and by PCL's.
#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include "core/io/cloud_writer.h"
#include "core/io/scan_reader.h"
#include "export_samples.h"
#include "support/ptx_by_the_book.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

void expectSameMatrix(const Scan& read, const ExportScan& written, double tolerance_m) {
  const RangeImage &a = *read.image, &b = *written.image;
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.columns(), b.columns());
  EXPECT_EQ(a.isRegular(), b.isRegular());
  ASSERT_TRUE(a.hasIntensity());
  const auto p = cellPoints(a, read.geometry), q = cellPoints(b, written.geometry);
  for (std::size_t cell = 0; cell < a.cells(); ++cell) {
    ASSERT_EQ(a.hasPoint(cell), b.hasPoint(cell)) << cell;
    if (!a.hasPoint(cell)) continue;
    ASSERT_LT((p[cell] - q[cell]).norm(), tolerance_m) << cell;
    ASSERT_EQ(a.intensity(cell), b.intensity(cell)) << cell;
  }
  EXPECT_LT(difference(read.odometry, written.world_from_scan).translation_m, 1e-9);
  EXPECT_LT(difference(read.odometry, written.world_from_scan).rotation_rad, 1e-7);
}

class RoundTrip : public testing::TestWithParam<std::tuple<const char*, bool>> {};

TEST_P(RoundTrip, MatrixPoseAndIntensitySurvive) {
  const TemporaryFolder folder;
  const auto& [extension, regular] = GetParam();
  const ExportScan scan = sweep(3, regular);
  const auto path = folder / (std::string("scan.") + extension);
  const auto written = writeCloud(path, cloudForExport({scan}));
  ASSERT_TRUE(written) << written.error().what;
  EXPECT_EQ(folder.entries(), 1U);
  const auto result = readScans(path, {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  EXPECT_TRUE(result->warnings.empty());
  ASSERT_TRUE(result->scans[0].pose);
  expectSameMatrix(result->scans[0].scan, scan, 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Combine(testing::Values("ptx", "pcd", "ply"), testing::Bool()),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) ? "Regular" : "Directions");
                         });

TEST(RoundTripUos, RegularMatrixPoseAndIntensitySurvive) {
  const TemporaryFolder folder;
  const ExportScan scan = sweep(3);
  ASSERT_TRUE(writeCloud(folder / "scan003.3d", cloudForExport({scan})));
  EXPECT_EQ(folder.entries(), 2U);
  const auto result = readScans(folder / "scan003.3d", {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  expectSameMatrix(result->scans[0].scan, scan, 2e-5);
}

TEST(RoundTripPtx, SeveralScansSurvive) {
  const TemporaryFolder folder;
  const std::vector<ExportScan> scans{sweep(0), sweep(1, false), sweep(2)};
  ASSERT_TRUE(writeCloud(folder / "all.ptx", cloudForExport(scans)));
  const auto result = readScans(folder / "all.ptx", {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  ASSERT_EQ(result->scans.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) expectSameMatrix(result->scans[i].scan, scans[i], 2e-5);
}

// Read by nothing of ours.
TEST(PtxByTheBook, SeveralScansHaveTheirMatrixPoseIntensityAndColour) {
  const TemporaryFolder folder;
  const std::vector<ExportScan> scans{sweep(0), sweep(1, false)};
  WriteOptions options;
  options.colour = CloudColour::Scan;
  ASSERT_TRUE(writeCloud(folder / "all.ptx", cloudForExport(scans), options));
  const auto blocks = ptxByTheBook(folder / "all.ptx");
  ASSERT_EQ(blocks.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const PtxBlock& block = blocks[i];
    const ExportScan& scan = scans[i];
    ASSERT_EQ(block.columns, 91);
    ASSERT_EQ(block.rows, 41);
    const Eigen::Matrix3d r = scan.world_from_scan.rotation();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      EXPECT_NEAR(block.place[k], scan.world_from_scan.translation()[axis], 1e-12);
      EXPECT_NEAR(block.matrix[3][k], block.place[k], 1e-12);
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_NEAR(block.axes[k][j], r(static_cast<Eigen::Index>(j), axis), 1e-12);
        EXPECT_EQ(block.axes[k][j], block.matrix[k][j]);
      }
      EXPECT_EQ(block.matrix[k][3], 0.0);
    }
    EXPECT_EQ(block.matrix[3][3], 1.0);
    for (int row = 0; row < 41; ++row)
      for (int column = 0; column < 91; ++column) {
        const PtxCell& cell = block.cell(row, column);
        ASSERT_EQ(cell.colour.size(), 3U);
        if (!scan.image->hasPoint(row, column)) {
          ASSERT_EQ(cell.local, (std::array<double, 3>{}));
          continue;
        }
        const Eigen::Vector3d expected =
            scan.world_from_scan * cellPoint(*scan.image, scan.geometry, row, column);
        const auto world = block.world(cell);
        ASSERT_LT((Eigen::Vector3d(world[0], world[1], world[2]) - expected).norm(), 2e-6);
        ASSERT_NEAR(cell.intensity, scan.image->intensity(static_cast<std::size_t>(row * 91 + column)), 1e-6);
      }
  }
  EXPECT_NE(blocks[0].cell(5, 5).colour, blocks[1].cell(5, 5).colour);
}

// Written once more, a file that was read is the same byte for byte: nothing drifts.
TEST(RoundTripPtx, AndAgain) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeCloud(folder / "a.ptx", cloudForExport({sweep(0, false)})));
  const auto once = readScans(folder / "a.ptx", {});
  ASSERT_TRUE(once);
  const Scan& scan = once->scans[0].scan;
  ASSERT_TRUE(
      writeCloud(folder / "b.ptx", cloudForExport({{0, scan.odometry, {}, scan.image, scan.geometry, {}}})));
  const auto twice = readScans(folder / "b.ptx", {});
  ASSERT_TRUE(twice);
  ExportScan first = sweep(0, false);
  expectSameMatrix(twice->scans[0].scan, first, 1e-5);
}

class Merged : public testing::TestWithParam<std::tuple<const char*, bool>> {};

TEST_P(Merged, AllScansComeBackInTheWorldFrame) {
  const TemporaryFolder folder;
  const auto& [extension, doubles] = GetParam();
  const std::vector<ExportScan> scans{sweep(0), sweep(7)};
  const auto path = folder / (std::string("map.") + extension);
  WriteOptions options;
  options.double_precision = doubles;
  options.colour = CloudColour::Scan;
  const auto written = writeCloud(path, cloudForExport(scans), options);
  ASSERT_TRUE(written) << written.error().what;
  EXPECT_EQ(folder.entries(), 1U);
  const auto result = readScans(path, {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& read = result->scans[0].scan;
  const auto expected = worldPoints(scans);
  const auto points = cellPoints(*read.image, read.geometry);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_LT((points[i] - expected[i]).norm(), 2e-5);
  ASSERT_TRUE(read.image->hasIntensity());
  const auto first = cloudOf(*scans[0].image, scans[0].geometry);
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(read.image->intensity(i), first.intensity[i]);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, Merged, testing::Combine(testing::Values("ply", "pcd", "xyz", "csv", "vtk"), testing::Bool()),
    [](const auto& test) {
      return std::string(std::get<0>(test.param)) + (std::get<1>(test.param) ? "Doubles" : "Floats");
    });

TEST(PclReadsBack, MergedPcdWithIntensityNormalsAndColour) {
  const TemporaryFolder folder;
  std::vector<ExportScan> scans{sweep(0), sweep(1)};
  for (ExportScan& scan : scans) {
    scan.cloud = cloudOf(*scan.image, scan.geometry);
    scan.cloud.normals.assign(scan.cloud.size(), Eigen::Vector3d(0, 0.6, 0.8));
  }
  WriteOptions options;
  options.colour = CloudColour::Height;
  ASSERT_TRUE(writeCloud(folder / "map.pcd", cloudForExport(scans), options));
  pcl::PointCloud<pcl::PointXYZINormal> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile((folder / "map.pcd").string(), cloud), 0);
  const auto expected = worldPoints(scans);
  ASSERT_EQ(cloud.size(), expected.size());
  const Eigen::Vector3d normal = scans[0].world_from_scan.rotation() * Eigen::Vector3d(0, 0.6, 0.8);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_LT((cloud[i].getVector3fMap().cast<double>() - expected[i]).norm(), 2e-5);
    ASSERT_LT((cloud[i].getNormalVector3fMap().cast<double>() - normal).norm(), 1e-6);
  }
  EXPECT_EQ(cloud[5].intensity, scans[0].cloud.intensity[5]);
  pcl::PointCloud<pcl::PointXYZRGB> coloured;
  ASSERT_EQ(pcl::io::loadPCDFile((folder / "map.pcd").string(), coloured), 0);
  const auto by_height = [](const auto& a, const auto& b) { return a.z < b.z; };
  const auto low = std::min_element(coloured.begin(), coloured.end(), by_height);
  const auto high = std::max_element(coloured.begin(), coloured.end(), by_height);
  EXPECT_GT(low->b, 200);
  EXPECT_LT(low->r, 50);
  EXPECT_GT(high->r, 200);
  EXPECT_LT(high->b, 50);
}

TEST(PclReadsBack, MergedPly) {
  const TemporaryFolder folder;
  const std::vector<ExportScan> scans{sweep(0), sweep(1)};
  WriteOptions options;
  options.colour = CloudColour::Intensity;
  ASSERT_TRUE(writeCloud(folder / "map.ply", cloudForExport(scans), options));
  pcl::PointCloud<pcl::PointXYZRGB> cloud;
  ASSERT_EQ(pcl::io::loadPLYFile((folder / "map.ply").string(), cloud), 0);
  const auto expected = worldPoints(scans);
  ASSERT_EQ(cloud.size(), expected.size());
  std::size_t dark = 0, bright = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_LT((cloud[i].getVector3fMap().cast<double>() - expected[i]).norm(), 2e-5);
    ASSERT_EQ(cloud[i].r, cloud[i].g);
    dark += cloud[i].r < 64;
    bright += cloud[i].r > 192;
  }
  EXPECT_GT(dark, cloud.size() / 6);
  EXPECT_GT(bright, cloud.size() / 6);
}

TEST(PclReadsBack, OrganisedPcdWithItsPose) {
  const TemporaryFolder folder;
  const ExportScan scan = sweep(2);
  ASSERT_TRUE(writeCloud(folder / "scan.pcd", cloudForExport({scan})));
  pcl::PointCloud<pcl::PointXYZI> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile((folder / "scan.pcd").string(), cloud), 0);
  ASSERT_EQ(cloud.height, 41U);
  ASSERT_EQ(cloud.width, 91U);
  EXPECT_LT((cloud.sensor_origin_.head<3>().cast<double>() - scan.world_from_scan.translation()).norm(),
            1e-5);
  EXPECT_LT(cloud.sensor_orientation_.cast<double>().angularDistance(scan.world_from_scan.quaternion()),
            1e-3);
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 91; ++column) {
      const auto& p = cloud.at(column, row);
      ASSERT_EQ(std::isfinite(p.x), scan.image->hasPoint(row, column));
      if (!std::isfinite(p.x)) continue;
      ASSERT_LT(
          (p.getVector3fMap().cast<double>() - cellPoint(*scan.image, scan.geometry, row, column)).norm(),
          1e-5);
    }
}

TEST(PclReadsBack, MatricesKeptWithColours) {
  const TemporaryFolder folder;
  const ExportScan scan = sweep(2);
  WriteOptions options;
  options.colour = CloudColour::Height;
  for (const std::string name : {"scan.pcd", "scan.ply"}) {
    ASSERT_TRUE(writeCloud(folder / name, cloudForExport({scan}), options));
    pcl::PointCloud<pcl::PointXYZRGB> cloud;
    ASSERT_EQ(name == "scan.pcd" ? pcl::io::loadPCDFile((folder / name).string(), cloud)
                                 : pcl::io::loadPLYFile((folder / name).string(), cloud),
              0);
    ASSERT_EQ(cloud.height, 41U) << name;
    ASSERT_EQ(cloud.width, 91U) << name;
    // The lowest is blue, the highest red, by height in the world.
    double lowest = 1e9, highest = -1e9;
    pcl::PointXYZRGB low, high;
    for (int row = 0; row < 41; ++row)
      for (int column = 0; column < 91; ++column) {
        if (!scan.image->hasPoint(row, column)) continue;
        const double z = (scan.world_from_scan * cellPoint(*scan.image, scan.geometry, row, column)).z();
        if (z < lowest) lowest = z, low = cloud.at(column, row);
        if (z > highest) highest = z, high = cloud.at(column, row);
      }
    EXPECT_GT(low.b, 200) << name;
    EXPECT_LT(low.r, 50) << name;
    EXPECT_GT(high.r, 200) << name;
    EXPECT_LT(high.b, 50) << name;
    // And ours keeps matrix, pose and intensity beside them.
    const auto read = readScans(folder / name, {});
    ASSERT_TRUE(read) << read.error().what;
    expectSameMatrix(read->scans[0].scan, scan, 2e-5);
  }
}

TEST(PclReadsBack, PlyOfOneScanWithItsMatrix) {
  const TemporaryFolder folder;
  const ExportScan scan = sweep(2);
  ASSERT_TRUE(writeCloud(folder / "scan.ply", cloudForExport({scan})));
  pcl::PointCloud<pcl::PointXYZI> cloud;
  ASSERT_EQ(pcl::io::loadPLYFile((folder / "scan.ply").string(), cloud), 0);
  ASSERT_EQ(cloud.height, 41U);
  ASSERT_EQ(cloud.width, 91U);
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 91; ++column) {
      const auto& p = cloud.at(column, row);
      ASSERT_EQ(std::isfinite(p.x), scan.image->hasPoint(row, column));
      if (!std::isfinite(p.x)) continue;
      const Eigen::Vector3d world = scan.world_from_scan * cellPoint(*scan.image, scan.geometry, row, column);
      ASSERT_LT((p.getVector3fMap().cast<double>() - world).norm(), 1e-5);
    }
}

}  // namespace
}  // namespace tiltmap
