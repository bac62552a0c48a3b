#include <gtest/gtest.h>

#include "core/io/scan_reader.h"
#include "small_files.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

TEST(PtxReader, GoesColumnByColumn) {
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("a.ptx", ptx()), {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  ASSERT_EQ(scan.image->rows(), 2);
  ASSERT_EQ(scan.image->columns(), 3);
  EXPECT_LT((cellPoint(*scan.image, scan.geometry, 1, 0) - Eigen::Vector3d(1, 2, 4)).norm(), 1e-6);
  EXPECT_LT((cellPoint(*scan.image, scan.geometry, 0, 1) - Eigen::Vector3d(2, 2, 3)).norm(), 1e-6);
  EXPECT_EQ(scan.image->code(1, 1), cell_code::kMissing);
  EXPECT_FLOAT_EQ(scan.image->intensity(scan.image->index(1, 2)), 0.6F);
  ASSERT_TRUE(result->scans[0].pose);
  EXPECT_LT((scan.odometry.translation() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
}

TEST(PtxReader, TheMatrixActsOnRowVectors) {
  const TemporaryFolder folder;
  // A quarter turn to the left: x of the scanner becomes y of the world, which is the first row of the
  // matrix.
  const auto result =
      readScans(folder.write("a.ptx",
                             "1\n2\n5 6 7\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n5 6 7 1\n"
                             "1 0 0 0.5\n0 2 0 0.5\n"),
                {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  const auto points = cellPoints(*scan.image, scan.geometry);
  EXPECT_LT((scan.odometry * points[0] - Eigen::Vector3d(5, 7, 7)).norm(), 1e-6);
  EXPECT_LT((scan.odometry * points[1] - Eigen::Vector3d(3, 6, 7)).norm(), 1e-6);
  EXPECT_FALSE(scan.image->hasIntensity()) << "0.5 throughout stands for none";
  EXPECT_EQ(scan.image->rows(), 1) << "one column is a list";
}

TEST(PtxReader, SeveralScansComeAsSeveral) {
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("site.ptx", ptx() + ptx() + "\n"), {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  ASSERT_EQ(result->scans.size(), 2U);
  EXPECT_EQ(result->scans[0].scan.name, "site/1");
  EXPECT_EQ(result->scans[1].scan.name, "site/2");
}

TEST(PtxReader, ColoursAreLeftOutWithAWord) {
  const TemporaryFolder folder;
  const auto result = readScans(
      folder.write("a.ptx", ptxHeader() + "1 2 3 0.1 1 2 3\n1 2 4 0.2 1 2 3\n2 2 3 0.3 1 2 3\n0 0 0 0 1 2 3\n"
                                          "3 2 3 0.5 1 2 3\n3 2 4 0.6 1 2 3\n"),
      {});
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_EQ(result->warnings.size(), 1U);
  EXPECT_NE(result->warnings[0].find("colour"), std::string::npos);
}

}  // namespace
}  // namespace tiltmap
