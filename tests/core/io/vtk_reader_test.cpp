#include <gtest/gtest.h>

#include "core/io/scan_reader.h"
#include "small_files.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

TEST(VtkReader, WalksThroughEverySectionOfOldAndNewFiles) {
  const TemporaryFolder folder;
  const auto result = readScans(
      folder.write(
          "a.vtk",
          "# vtk DataFile Version 5.1\nvtk output\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n1 2 3 4 5 6\n"
          "METADATA\nINFORMATION 0\n\nVERTICES 3 2\nOFFSETS vtktypeint64\n0 1 2\nCONNECTIVITY "
          "vtktypeint64\n0 1\n"
          "CELL_DATA 2\nSCALARS label int\nLOOKUP_TABLE mine\n1 2\nLOOKUP_TABLE mine 2\n0 0 0 1 1 1 1 1\n"
          "POINT_DATA 2\nNORMALS n float\n0 0 1 0 0 1\nTEXTURE_COORDINATES t 2 float\n0 0 1 1\n"
          "COLOR_SCALARS c 3\n0 0 0 1 1 1\nFIELD FieldData 2\nIntensity 1 2 double\n5 7\ntime 1 2 "
          "unsigned_int\n1 2\n"),
      {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  ASSERT_TRUE(scan.image->hasIntensity());
  EXPECT_FLOAT_EQ(scan.image->intensity(1), 7.0F);
  ASSERT_EQ(result->warnings.size(), 1U);
  for (const char* name : {"label", "n", "t", "c", "time"})
    EXPECT_NE(result->warnings[0].find(name), std::string::npos) << name;
}

TEST(VtkReader, UnstructuredGridsInBinary) {
  const TemporaryFolder folder;
  const auto result = readScans(
      folder.write(
          "a.vtk",
          "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 double\n" +
              packedBigEndian(1.0, 2.0, 3.0, 4.0, 5.0, 6.0) + "\nCELLS 2 4\n" + packedBigEndian(1, 0, 1, 1) +
              "\nCELL_TYPES 2\n" + packedBigEndian(1, 1) +
              "\nPOINT_DATA 2\nSCALARS reflectance unsigned_char 1\nLOOKUP_TABLE default\n\x05\xff\n"),
      {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  EXPECT_FLOAT_EQ(result->scans[0].scan.image->intensity(1), 255.0F);
  const auto points = cellPoints(*result->scans[0].scan.image, result->scans[0].scan.geometry);
  EXPECT_LT((points[1] - Eigen::Vector3d(4, 5, 6)).norm(), 1e-6);
}

TEST(VtkReader, TheOutdoorCloudsAreReadWhole) {
  TILTMAP_NEEDS_SHARED_DATA("libpointmatcher");
  const std::size_t expected[] = {24989, 25193, 24154};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto result = readScans(sharedData("libpointmatcher/cloud.0000" + std::to_string(i) + ".vtk"), {});
    ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
    const Scan& scan = result->scans[0].scan;
    EXPECT_EQ(scan.image->cells(), expected[i]);
    EXPECT_EQ(scan.image->validCells(), expected[i]);
    if (i == 0) {
      EXPECT_LT((cellPoint(*scan.image, scan.geometry, 0, 0) - Eigen::Vector3d(-3.79521, 0.0131325, -0.95763))
                    .norm(),
                1e-5);
    }
  }
}

}  // namespace
}  // namespace tiltmap
