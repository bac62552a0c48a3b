#include <gtest/gtest.h>

#include "core/io/pose_file.h"
#include "core/io/scan_reader.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::TemporaryFolder;

TEST(UosReader, TurnsCentimetresLeftHandedIntoOurFrame) {
  const TemporaryFolder folder;
  // 1 m right, 2 m up, 3 m forward.
  const auto result = readScans(folder.write("scan000.3d", "100 200 300\n-100 0 500\n"), {});
  ASSERT_TRUE(result) << result.error().what;
  const Scan& scan = result->scans[0].scan;
  const auto points = cellPoints(*scan.image, scan.geometry);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0] - Eigen::Vector3d(1, 3, 2)).norm(), 1e-6);
  EXPECT_LT((points[1] - Eigen::Vector3d(-1, 5, 0)).norm(), 1e-6);
  EXPECT_FALSE(result->scans[0].pose);
  EXPECT_EQ(scan.name, "scan000");
  EXPECT_FALSE(scan.image->hasIntensity());
}

TEST(UosReader, TakesThePoseBesideIt) {
  const TemporaryFolder folder;
  folder.write("scan007.pose", "100 0 300\n0 90 0\n");
  const auto result = readScans(folder.write("scan007.3d", "100 200 300\n100 0 500\n"), {});
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_TRUE(result->scans[0].pose);
  EXPECT_LT((result->scans[0].pose->translation() - Eigen::Vector3d(1, 3, 0)).norm(), 1e-12);
  EXPECT_LT(difference(result->scans[0].scan.odometry, *result->scans[0].pose).translation_m, 1e-12);
}

TEST(UosReader, ABrokenPoseBesideItIsAnError) {
  const TemporaryFolder folder;
  folder.write("scan007.pose", "100 0 300\n0 ninety 0\n");
  const auto result = readScans(folder.write("scan007.3d", "100 200 300\n"), {});
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().where.find("scan007.pose:2"), std::string::npos) << result.error().where;
}

TEST(UosReader, ALineOfCountsMayComeFirst) {
  const TemporaryFolder folder;
  const std::string points = "100 200 300\n100 210 300\n100 220 300\n100 230 300\n100 240 301\n100 250 300\n";
  const auto plain = readScans(folder.write("a.3d", "6\n" + points), {});
  ASSERT_TRUE(plain) << plain.error().what;
  EXPECT_EQ(plain->scans[0].scan.image->validCells(), 6U);
  const auto matrix = readScans(folder.write("b.3d", "2 3\n" + points), {});
  ASSERT_TRUE(matrix) << matrix.error().what;
  EXPECT_EQ(matrix->scans[0].scan.image->rows(), 2);
  EXPECT_EQ(matrix->scans[0].scan.image->columns(), 3);
  EXPECT_FALSE(readScans(folder.write("c.3d", "7\n" + points), {}));
  EXPECT_FALSE(readScans(folder.write("d.3d", "2 2\n" + points), {}));
}

TEST(UosReader, KeepsAReflectanceAndTellsThatColourIsLeftOut) {
  const TemporaryFolder folder;
  const auto four = readScans(folder.write("a.3d", "100 200 300 0.25\n100 200 310 17\n"), {});
  ASSERT_TRUE(four);
  EXPECT_FLOAT_EQ(four->scans[0].scan.image->intensity(0), 0.25F);
  EXPECT_FLOAT_EQ(four->scans[0].scan.image->intensity(1), 17.0F);
  EXPECT_TRUE(four->warnings.empty());
  const auto six = readScans(folder.write("b.3d", "100 200 300 255 0 0\n"), {});
  ASSERT_TRUE(six);
  EXPECT_FALSE(six->scans[0].scan.image->hasIntensity());
  ASSERT_EQ(six->warnings.size(), 1U);
  EXPECT_NE(six->warnings[0].find("b.3d"), std::string::npos);
}

TEST(UosReader, CellsOutsideTheBoundsOrAtTheOriginHoldNoPoint) {
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("a.3d", "0 0 0\n10 0 0\n0 0 500\n0 0 4000\nnan 0 0\n"),
                                {ScanFormat::Uos, 0.5, 32.0});
  ASSERT_TRUE(result) << result.error().what;
  const RangeImage& image = *result->scans[0].scan.image;
  EXPECT_EQ(image.cells(), 5U);
  EXPECT_EQ(image.code(0), cell_code::kMissing);
  EXPECT_EQ(image.code(1), cell_code::kOutOfBounds);
  EXPECT_EQ(image.code(2), cell_code::kMeasured);
  EXPECT_EQ(image.code(3), cell_code::kOutOfBounds);
  EXPECT_EQ(image.code(4), cell_code::kMissing);
  EXPECT_EQ(image.validCells(), 1U);
}

}  // namespace
}  // namespace tiltmap
