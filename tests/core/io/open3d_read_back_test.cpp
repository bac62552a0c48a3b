// What is written comes back in Open3D. A program of its own: these headers are heavy, and the only ones of
// theirs here.
#include <gtest/gtest.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/io/PointCloudIO.h>

#include "export_samples.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

open3d::geometry::PointCloud readByOpen3d(const std::filesystem::path& path, bool keep_nan = false) {
  open3d::io::ReadPointCloudOption options;
  options.remove_nan_points = !keep_nan;
  options.remove_infinite_points = !keep_nan;
  open3d::geometry::PointCloud cloud;
  EXPECT_TRUE(open3d::io::ReadPointCloud(path.string(), cloud, options)) << path;
  return cloud;
}

class Open3dReadsBack : public testing::TestWithParam<std::tuple<const char*, bool>> {};

TEST_P(Open3dReadsBack, MergedScansWithColours) {
  const TemporaryFolder folder;
  const auto& [extension, doubles] = GetParam();
  const std::vector<ExportScan> scans{sweep(0), sweep(1)};
  WriteOptions options;
  options.colour = CloudColour::Scan;
  options.double_precision = doubles;
  const auto path = folder / (std::string("map.") + extension);
  ASSERT_TRUE(writeCloud(path, cloudForExport(scans), options));
  const auto cloud = readByOpen3d(path);
  const auto expected = worldPoints(scans);
  ASSERT_EQ(cloud.points_.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_LT((cloud.points_[i] - expected[i]).norm(), doubles ? 1e-12 : 2e-5) << i;
  ASSERT_EQ(cloud.colors_.size(), expected.size());
  EXPECT_EQ(cloud.colors_[0], cloud.colors_[1]);
  EXPECT_GT((cloud.colors_.front() - cloud.colors_.back()).norm(), 0.3) << "a hue for each scan";
}

// A matrix in the world frame (PLY) or in the scan's (PCD), its empty cells being no points.
TEST_P(Open3dReadsBack, OneScanThatKeepsItsMatrix) {
  const TemporaryFolder folder;
  const auto& [extension, doubles] = GetParam();
  const ExportScan scan = sweep(2);
  WriteOptions options;
  options.double_precision = doubles;
  const auto path = folder / (std::string("scan.") + extension);
  ASSERT_TRUE(writeCloud(path, cloudForExport({scan}), options));
  const auto cloud = readByOpen3d(path);
  auto expected = cloudOf(*scan.image, scan.geometry).points;
  if (std::string(extension) == "ply") expected = worldPoints({scan});
  ASSERT_EQ(cloud.points_.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_LT((cloud.points_[i] - expected[i]).norm(), doubles ? 1e-12 : 2e-5) << i;
  if (std::string(extension) == "pcd") {
    EXPECT_EQ(readByOpen3d(path, true).points_.size(), scan.image->cells());
  }
}

// Not PCD with 8-byte coordinates: Open3D 0.16 takes every F for 4 bytes.
INSTANTIATE_TEST_SUITE_P(Formats, Open3dReadsBack,
                         testing::Values(std::tuple("ply", false), std::tuple("ply", true),
                                         std::tuple("pcd", false)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) ? "Doubles" : "Floats");
                         });

TEST(Open3dReadsBack, PointsAsText) {
  const TemporaryFolder folder;
  ExportScan scan = sweep(3);
  const auto expected = worldPoints({scan});
  scan.cloud.points = cloudOf(*scan.image, scan.geometry).points;  // no intensity: it takes three columns
  scan.image = nullptr;
  ASSERT_TRUE(writeCloud(folder / "a.xyz", cloudForExport({scan})));
  const auto cloud = readByOpen3d(folder / "a.xyz");
  ASSERT_EQ(cloud.points_.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_LT((cloud.points_[i] - expected[i]).norm(), 2e-5);
}

}  // namespace
}  // namespace tiltmap
