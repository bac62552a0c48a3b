#include "core/io/cloud_writer.h"

#include <csignal>
#include <sstream>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "core/io/pose_file.h"
#include "export_samples.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

ExportScan threePoints(int index, const Pose& pose) {
  ExportScan scan;
  scan.index = index;
  scan.world_from_scan = pose;
  scan.cloud.points = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  return scan;
}

// Its size as text is well above the limits below.
CloudForExport manyPoints() {
  ExportScan scan;
  for (int i = 0; i < 50000; ++i) scan.cloud.points.emplace_back(0.001 * i, 1.0, 2.0);
  return cloudForExport({scan, scan});
}

TEST(CloudWriter, XyzIsPlainTextInTheWorldFrame) {
  const TemporaryFolder folder;
  const Pose turned = Pose::planar(10, 20, 90 * kDegree);
  ASSERT_TRUE(writeCloud(folder / "a.xyz", cloudForExport({threePoints(0, Pose()), threePoints(1, turned)})));
  EXPECT_EQ(bytesOf(folder / "a.xyz"),
            "1.00000 0.00000 0.00000\n0.00000 2.00000 0.00000\n0.00000 0.00000 3.00000\n"
            "10.00000 21.00000 0.00000\n8.00000 20.00000 0.00000\n10.00000 20.00000 3.00000\n");
}

TEST(CloudWriter, CsvNamesItsColumns) {
  const TemporaryFolder folder;
  ExportScan scan = threePoints(4, Pose());
  scan.cloud.intensity = {0.5F, 7.0F, 255.0F};
  scan.cloud.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  WriteOptions options;
  options.colour = CloudColour::Intensity;
  ASSERT_TRUE(writeCloud(folder / "a.csv", cloudForExport({scan}), options));
  std::istringstream lines(bytesOf(folder / "a.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,nx,ny,nz,intensity,red,green,blue,scan");
  std::getline(lines, line);
  EXPECT_EQ(line, "1.00000,0.00000,0.00000,1.00000,0.00000,0.00000,0.5,0,0,0,4");
  std::getline(lines, line);
  std::getline(lines, line);
  EXPECT_EQ(line, "0.00000,0.00000,3.00000,0.00000,0.00000,0.00000,255,255,255,255,4");
}

TEST(CloudWriter, NeighbouringScansGetColoursThatDiffer) {
  const TemporaryFolder folder;
  WriteOptions options;
  options.colour = CloudColour::Scan;
  ASSERT_TRUE(writeCloud(folder / "a.xyz", cloudForExport({threePoints(0, Pose()), threePoints(1, Pose())}),
                         options));
  std::istringstream words(bytesOf(folder / "a.xyz"));
  double v[36];
  for (double& x : v) ASSERT_TRUE(words >> x);
  for (int k = 3; k < 6; ++k) EXPECT_EQ(v[k], v[6 + k]) << "the same within a scan";
  EXPECT_GT(std::abs(v[3] - v[21]) + std::abs(v[4] - v[22]) + std::abs(v[5] - v[23]), 100.0);
}

TEST(CloudWriter, The3dtkFileHasItsPoseBeside) {
  const TemporaryFolder folder;
  const Pose pose = Pose::planar(1, 2, 0.3);
  ASSERT_TRUE(writeCloud(folder / "scan000.3d", cloudForExport({threePoints(0, pose)})));
  EXPECT_EQ(bytesOf(folder / "scan000.3d"),
            "100.0000 0.0000 0.0000\n0.0000 0.0000 200.0000\n0.0000 300.0000 0.0000\n");
  const auto back = readPose3dtk(folder / "scan000.pose");
  ASSERT_TRUE(back);
  EXPECT_LT(difference(*back, pose).translation_m, 1e-9);
  const auto two =
      writeCloud(folder / "two.3d", cloudForExport({threePoints(0, pose), threePoints(1, pose)}));
  ASSERT_FALSE(two);
  EXPECT_EQ(folder.entries(), 2U);
}

TEST(CloudWriter, TheFormatComesFromTheNameUnlessTold) {
  EXPECT_EQ(*cloudFormatOf("x/A.PLY"), CloudFormat::Ply);
  EXPECT_EQ(*cloudFormatOf("a.3d"), CloudFormat::Uos);
  const TemporaryFolder folder;
  const auto unknown = writeCloud(folder / "a.jpg", cloudForExport({threePoints(0, Pose())}));
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().where.find("a.jpg"), std::string::npos);
  EXPECT_EQ(folder.entries(), 0U);
  WriteOptions options;
  options.format = CloudFormat::Xyz;
  EXPECT_TRUE(writeCloud(folder / "a.jpg", cloudForExport({threePoints(0, Pose())}), options));
}

class EveryFormat : public testing::TestWithParam<const char*> {};

TEST_P(EveryFormat, RefusesToWriteNothing) {
  const TemporaryFolder folder;
  const auto path = folder / (std::string("a.") + GetParam());
  EXPECT_FALSE(writeCloud(path, cloudForExport({})));
  EXPECT_FALSE(writeCloud(path, cloudForExport({ExportScan{}})));
  EXPECT_EQ(folder.entries(), 0U);
}

TEST_P(EveryFormat, LeavesTheOldFileWhereAScanCannotBeHad) {
  const TemporaryFolder folder;
  const auto path = folder.write(std::string("a.") + GetParam(), "before");
  CloudForExport cloud = cloudForExport({threePoints(0, Pose())});
  cloud.scans = 2;
  cloud.scan = [](std::size_t i) -> Result<ExportScan> {
    if (i == 1) return fail("the project is gone", "scan 1", "look for it");
    return threePoints(0, Pose());
  };
  const auto status = writeCloud(path, cloud);
  ASSERT_FALSE(status);
  EXPECT_EQ(bytesOf(path), "before");
  EXPECT_EQ(folder.entries(), 1U);
}

class StreamedFormat : public testing::TestWithParam<const char*> {};

TEST_P(StreamedFormat, StopsWhenAskedAndLeavesTheOldFile) {
  const TemporaryFolder folder;
  const auto path = folder.write(std::string("a.") + GetParam(), "before");
  std::stop_source stop;
  // Asked for when the first scan is being written.
  const JobControl control{[&](const Progress&) { stop.request_stop(); }, stop.get_token()};
  const auto status = writeCloud(path, manyPoints(), {}, control);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  EXPECT_EQ(bytesOf(path), "before");
  EXPECT_EQ(folder.entries(), 1U);
}

// Formats of one scan, its matrix kept.
class OneScanFormat : public testing::TestWithParam<const char*> {};

TEST_P(OneScanFormat, StopsWhenAskedAndLeavesNothing) {
  const TemporaryFolder folder;
  std::stop_source stop;
  const JobControl control{[&](const Progress&) { stop.request_stop(); }, stop.get_token()};
  const auto status =
      writeCloud(folder / (std::string("a.") + GetParam()), cloudForExport({sweep(1)}), {}, control);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  EXPECT_EQ(folder.entries(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Formats, OneScanFormat, testing::Values("ply", "pcd", "ptx", "3d"),
                         [](const auto& test) {
                           return test.param == std::string("3d") ? "uos" : std::string(test.param);
                         });

TEST(CloudWriter, SeveralFilesMayShareAColourScale) {
  const TemporaryFolder folder;
  const std::vector<ExportScan> scans{threePoints(0, Pose()),
                                      threePoints(1, Pose(Eigen::Quaterniond::Identity(), {0, 0, 30}))};
  const auto scale = colourScale(cloudForExport(scans), CloudColour::Height);
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->low, 0.0);
  EXPECT_EQ(scale->high, 33.0);
  WriteOptions options;
  options.colour = CloudColour::Height;
  options.scale = *scale;
  ASSERT_TRUE(writeCloud(folder / "low.xyz", cloudForExport({scans[0]}), options));
  // All of the low scan is at the blue end, though its own top is 3 m above its floor.
  std::istringstream words(bytesOf(folder / "low.xyz"));
  for (int point = 0; point < 3; ++point) {
    double x, y, z, r, g, b;
    ASSERT_TRUE(words >> x >> y >> z >> r >> g >> b);
    EXPECT_GT(b, 200);
    EXPECT_EQ(r, 0);
  }
}

// A limit on the size of files stands in for a disk that is full.
TEST_P(EveryFormat, SaysSoWhenTheDiskIsFullAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto path = folder / (std::string("a.") + GetParam());
  ExportScan scan;
  for (int i = 0; i < 50000; ++i) scan.cloud.points.emplace_back(0.001 * i, 1.0, 2.0);
  const CloudForExport cloud = cloudForExport({scan});
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{100000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto status = writeCloud(path, cloud);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().where.find("a."), std::string::npos);
  EXPECT_FALSE(status.error().remedy.empty());
  EXPECT_EQ(folder.entries(), 0U);
  EXPECT_TRUE(writeCloud(path, cloud));
}

TEST_P(EveryFormat, AFolderThatIsNotThereIsAnError) {
  const TemporaryFolder folder;
  EXPECT_FALSE(
      writeCloud(folder / (std::string("none/a.") + GetParam()), cloudForExport({threePoints(0, Pose())})));
}

INSTANTIATE_TEST_SUITE_P(Formats, StreamedFormat, testing::Values("ply", "pcd", "xyz", "csv", "ptx", "vtk"),
                         [](const auto& test) { return std::string(test.param); });
INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat,
                         testing::Values("ply", "pcd", "xyz", "csv", "ptx", "vtk", "3d"),
                         [](const auto& test) {
                           return test.param == std::string("3d") ? "uos" : std::string(test.param);
                         });

}  // namespace
}  // namespace tiltmap
