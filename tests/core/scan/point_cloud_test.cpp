#include "core/scan/point_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using namespace testing_support;
using ::testing::ElementsAre;

TEST(CloudOf, KeepsCellsWithPointsInOrder) {
  const ScannerGeometry g = smallGeometry(2, 3);
  RangeImageData data = evenData(g);
  data.intensity = {1, 2, 3, 4, 5, 6};
  setCell(data, 0, 1, 0.0F, cell_code::kNoReturn);
  setCell(data, 1, 0, 0.0F, cell_code::kMasked);
  const auto image = imageOf(data);
  const PointCloud cloud = cloudOf(*image, g);
  EXPECT_THAT(cloud.cell, ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(cloud.intensity, ElementsAre(1, 3, 5, 6));
  ASSERT_EQ(cloud.size(), 4U);
  EXPECT_EQ(cloud.points[1], cellPoint(*image, g, 0, 2));
  EXPECT_TRUE(cloud.normals.empty());
  EXPECT_FALSE(cloud.hasNormal(0));
}

TEST(CloudOf, IsEmptyWhereNothingWasSeen) {
  const ScannerGeometry g = smallGeometry(2, 2);
  RangeImageData data = evenData(g);
  data.code.assign(4, cell_code::kNoReturn);
  EXPECT_TRUE(cloudOf(*imageOf(data), g).empty());
}

TEST(PointCloud, AZeroNormalIsNone) {
  PointCloud cloud;
  cloud.points = {{1, 0, 0}, {2, 0, 0}};
  cloud.normals = {{0, 0, 0}, {-1, 0, 0}};
  EXPECT_FALSE(cloud.hasNormal(0));
  EXPECT_TRUE(cloud.hasNormal(1));
}

}  // namespace
}  // namespace tiltmap
