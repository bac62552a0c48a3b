#include <gtest/gtest.h>

#include "core/io/scan_reader.h"
#include "small_files.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

TEST(PlyReader, PropertiesComeInAnyOrderAndTypeAndOthersAreNamed) {
  const TemporaryFolder folder;
  const auto result = readScans(
      folder.write(
          "a.ply",
          "ply\nformat binary_big_endian 1.0\nelement camera 1\nproperty list ushort float lens\nelement "
          "vertex 2\n"
          "property uchar red\nproperty double z\nproperty float64 x\nproperty list uint8 int16 tags\n"
          "property float32 y\nproperty ushort reflectance\nend_header\n" +
              packedBigEndian(std::uint16_t{2}, 1.F, 2.F) +
              packedBigEndian(std::uint8_t{255}, 3.0, 1.0, std::uint8_t{0}, 2.F, std::uint16_t{65000}) +
              packedBigEndian(std::uint8_t{255}, 30.0, 10.0, std::uint8_t{2}, std::int16_t{1},
                              std::int16_t{2}, 20.F, std::uint16_t{3})),
      {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  const auto points = cellPoints(*scan.image, scan.geometry);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0] - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  EXPECT_LT((points[1] - Eigen::Vector3d(10, 20, 30)).norm(), 1e-5);
  EXPECT_FLOAT_EQ(scan.image->intensity(0), 65000.0F);
  ASSERT_EQ(result->warnings.size(), 1U);
  for (const char* name : {"camera", "red", "tags"})
    EXPECT_NE(result->warnings[0].find(name), std::string::npos) << name;
}

std::string gridPly(const std::string& cells, const std::string& columns = "3") {
  return "ply\nformat ascii 1.0\nobj_info num_cols " + columns +
         "\nobj_info num_rows 2\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float z\nelement range_grid 6\nproperty list uchar int vertex_indices\nend_header\n1 2 "
         "3\n4 5 6\n" +
         cells;
}

TEST(PlyReader, ARangeGridIsTheMatrix) {
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("a.ply", gridPly("0\n1 1\n0\n0\n1 0\n0\n")), {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  ASSERT_EQ(scan.image->rows(), 2);
  ASSERT_EQ(scan.image->columns(), 3);
  EXPECT_EQ(scan.image->validCells(), 2U);
  EXPECT_LT((cellPoint(*scan.image, scan.geometry, 0, 1) - Eigen::Vector3d(4, 5, 6)).norm(), 1e-6);
  EXPECT_LT((cellPoint(*scan.image, scan.geometry, 1, 1) - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
}

TEST(PlyReader, ARangeGridThatDoesNotFitIsRefused) {
  const TemporaryFolder folder;
  EXPECT_FALSE(readScans(folder.write("a.ply", gridPly("0\n1 2\n0\n0\n1 0\n0\n")), {})) << "no such vertex";
  EXPECT_FALSE(readScans(folder.write("a.ply", gridPly("0\n1 -1\n0\n0\n1 0\n0\n")), {}));
  EXPECT_FALSE(readScans(folder.write("a.ply", gridPly("0\n2 0 1\n0\n0\n1 0\n0\n")), {}))
      << "two vertices in a cell";
  EXPECT_FALSE(readScans(folder.write("a.ply", gridPly("0\n1 1\n0\n0\n1 0\n0\n", "4")), {}))
      << "another size";
}

}  // namespace
}  // namespace tiltmap
