#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include "core/geometry/pose.h"
#include "core/io/scan_reader.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::TemporaryFolder;

std::string header(const std::string& fields, const std::string& sizes, const std::string& types,
                   const std::string& counts, int width, int height, const std::string& data,
                   const std::string& viewpoint = "0 0 0 1 0 0 0") {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes +
         "\nTYPE " + types + "\nCOUNT " + counts + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " +
         std::to_string(height) + "\nVIEWPOINT " + viewpoint + "\nPOINTS " + std::to_string(width * height) +
         "\nDATA " + data + "\n";
}

template <class... T>
std::string packed(T... values) {
  std::string bytes;
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  (add(values), ...);
  return bytes;
}

Eigen::Vector3d point(const Scan& scan, std::size_t cell) {
  return cellPoints(*scan.image, scan.geometry)[cell];
}

// What PCL writes in each of its three ways comes in as it went out.
class PcdReaderWays : public testing::TestWithParam<std::string> {};

TEST_P(PcdReaderWays, OrganisedCloudsOfPclKeepMatrixPoseAndIntensity) {
  const TemporaryFolder folder;
  pcl::PointCloud<pcl::PointXYZI> cloud(31, 20);
  const ScannerGeometry geometry;
  for (std::uint32_t row = 0; row < 20; ++row) {
    for (std::uint32_t column = 0; column < 31; ++column) {
      auto& p = cloud.at(column, row);
      p.getVector3fMap() =
          geometry
              .point((-20.0 + row) * kDegree, (10.0 + 5.0 * column) * kDegree, 3.0 + 0.1 * row + 0.2 * column)
              .cast<float>();
      p.intensity = static_cast<float>(row * 100 + column);
    }
  }
  cloud.at(3, 5).x = std::numeric_limits<float>::quiet_NaN();
  cloud.at(4, 5).getVector3fMap().setZero();
  cloud.is_dense = false;
  cloud.sensor_origin_ = {1.5F, -2.0F, 0.25F, 0.0F};
  cloud.sensor_orientation_ = Eigen::Quaternionf(std::sqrt(0.5F), 0, 0, std::sqrt(0.5F));
  const std::string file = (folder / "c.pcd").string();
  if (GetParam() == "ascii") pcl::io::savePCDFileASCII(file, cloud);
  if (GetParam() == "binary") pcl::io::savePCDFileBinary(file, cloud);
  if (GetParam() == "compressed") pcl::io::savePCDFileBinaryCompressed(file, cloud);

  const auto result = readScans(file, {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  const RangeImage& image = *scan.image;
  ASSERT_EQ(image.rows(), 20);
  ASSERT_EQ(image.columns(), 31);
  EXPECT_EQ(image.validCells(), 618U);
  EXPECT_EQ(image.code(5, 3), cell_code::kMissing);
  EXPECT_EQ(image.code(5, 4), cell_code::kMissing);
  EXPECT_TRUE(image.isRegular());
  EXPECT_NEAR(image.lineTilt(0), -20 * kDegree, 1e-5);
  EXPECT_FLOAT_EQ(image.intensity(image.index(7, 9)), 709.0F);
  for (const int row : {0, 7, 19})
    for (const int column : {0, 9, 30}) {
      const auto& p = cloud.at(static_cast<int>(column), static_cast<int>(row));
      EXPECT_LT((cellPoint(image, scan.geometry, row, column) - p.getVector3fMap().cast<double>()).norm(),
                1e-4);
    }
  ASSERT_TRUE(result->scans[0].pose);
  EXPECT_LT((scan.odometry.translation() - Eigen::Vector3d(1.5, -2.0, 0.25)).norm(), 1e-6);
  EXPECT_LT((scan.odometry.heading() - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-5);
  EXPECT_EQ(folder.entries(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Data, PcdReaderWays, testing::Values("ascii", "binary", "compressed"),
                         [](const auto& test) { return test.param; });

TEST(PcdReader, AMatrixThatNoGeometryDescribesKeepsItsDirections) {
  const TemporaryFolder folder;
  std::string body;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column)
      body += std::to_string(1 + column * 0.37) + " " + std::to_string(2 + row * row * 0.2) + " " +
              std::to_string(0.3 * row * column) + "\n";
  const auto result =
      readScans(folder.write("m.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 5, 4, "ascii") + body), {});
  ASSERT_TRUE(result) << result.error().what;
  const Scan& scan = result->scans[0].scan;
  EXPECT_EQ(scan.image->rows(), 4);
  EXPECT_EQ(scan.image->columns(), 5);
  EXPECT_FALSE(scan.image->isRegular());
  EXPECT_LT((cellPoint(*scan.image, scan.geometry, 3, 2) - Eigen::Vector3d(1.74, 3.8, 1.8)).norm(), 1e-6);
}

TEST(PcdReader, FieldsComeInAnyOrderAndType) {
  const TemporaryFolder folder;
  const std::string file =
      header("label z _ intensity y hist x", "4 8 1 2 8 4 8", "U F U U F F F", "1 1 3 1 1 2 1", 2, 1,
             "binary") +
      packed(std::uint32_t{9}, 3.0, 'a', 'b', 'c', std::uint16_t{40000}, 2.0, 7.0F, 8.0F, 1.0) +
      packed(std::uint32_t{9}, 30.0, 'a', 'b', 'c', std::uint16_t{5}, 20.0, 7.0F, 8.0F, 10.0);
  const auto result = readScans(folder.write("f.pcd", file), {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  EXPECT_LT((point(scan, 0) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  EXPECT_LT((point(scan, 1) - Eigen::Vector3d(10, 20, 30)).norm(), 1e-5);
  EXPECT_FLOAT_EQ(scan.image->intensity(0), 40000.0F);
  ASSERT_EQ(result->warnings.size(), 1U);
  EXPECT_NE(result->warnings[0].find("label, hist"), std::string::npos) << result->warnings[0];
}

TEST(PcdReader, MixedLineEndsAndBlankLinesAtTheEndAreFine) {
  const TemporaryFolder folder;
  const auto result =
      readScans(folder.write("c.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 2, 1, "ascii\r") +
                                          "1 2 3\r\n 4\t5  6 \n\r\n\n"),
                {});
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_EQ(result->scans[0].scan.image->validCells(), 2U);
  EXPECT_LT((point(result->scans[0].scan, 1) - Eigen::Vector3d(4, 5, 6)).norm(), 1e-5);
}

TEST(PcdReader, AViewpointKeepsItsDoublePrecision) {
  const TemporaryFolder folder;
  const auto result =
      readScans(folder.write("v.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 1, 1, "ascii",
                                             "691234.123456789 5334567.987654321 512.5 1 0 0 0") +
                                          "1 2 3\n"),
                {});
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_NEAR(result->scans[0].scan.odometry.translation().y(), 5334567.987654321, 1e-8);
}

TEST(PcdReader, PointsInMapCoordinatesAreMovedToTheirOriginWithoutLoss) {
  const TemporaryFolder folder;
  const auto result = readScans(
      folder.write("m.pcd", header("x y z", "8 8 8", "F F F", "1 1 1", 2, 1, "binary") +
                                packed(691234.1234, 5334567.9876, 512.5, 691235.0, 5334567.0, 512.0)),
      {});
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_TRUE(result->scans[0].pose);
  EXPECT_EQ(result->warnings.size(), 1U);
  const Scan& scan = result->scans[0].scan;
  EXPECT_LT((scan.odometry * point(scan, 0) - Eigen::Vector3d(691234.1234, 5334567.9876, 512.5)).norm(),
            1e-6);
}

TEST(PcdReader, StopsWhenAsked) {
  const TemporaryFolder folder;
  std::stop_source stop;
  stop.request_stop();
  const auto result =
      readScans(folder.write("c.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 1, 1, "ascii") + "1 2 3\n"),
                {}, JobControl{{}, stop.get_token()});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().what, kCancelled);
}

}  // namespace
}  // namespace tiltmap
