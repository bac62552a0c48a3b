#include "core/scan/range_image.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using namespace testing_support;
using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(RangeImage, KeepsWhatItWasGiven) {
  RangeImageData data = evenData(smallGeometry(2, 3));
  setCell(data, 0, 1, 0.0F, cell_code::kLmsOverflow);
  setCell(data, 1, 2, 7.5F, cell_code::kReplaced);
  data.intensity = {1, 2, 3, 4, 5, 6};
  data.line_time_s = {10.0, 10.5};
  const auto image = imageOf(data);
  EXPECT_EQ(image->rows(), 2);
  EXPECT_EQ(image->columns(), 3);
  EXPECT_EQ(image->validCells(), 5U);
  EXPECT_FALSE(image->hasPoint(0, 1));
  EXPECT_EQ(image->code(0, 1), cell_code::kLmsOverflow);
  EXPECT_EQ(image->range(1, 2), 7.5F);
  EXPECT_EQ(image->intensity(5), 6.0F);
  EXPECT_EQ(image->lineTime(1), 10.5);
  EXPECT_EQ(image->lineTilt(1), data.line_tilt_rad[1]);
  EXPECT_TRUE(image->isRegular());
  EXPECT_TRUE(image->isMatrix());
}

TEST(RangeImage, EmptiesCellsWithoutAPoint) {
  RangeImageData data = evenData(smallGeometry(2, 2));
  data.direction.assign(4, Eigen::Vector3f::UnitY());
  setCell(data, 0, 0, 81.89F, cell_code::kLmsOverflow);
  setCell(data, 0, 1, kNan, cell_code::kMissing);
  const auto image = imageOf(data);
  EXPECT_EQ(image->range(0, 0), 0.0F);
  EXPECT_EQ(image->range(0, 1), 0.0F);
  EXPECT_TRUE(image->directions()[0].isZero());
  EXPECT_EQ(image->validCells(), 2U);
}

TEST(RangeImage, RefusesDataThatDoesNotFit) {
  const auto refused = [](auto change) {
    RangeImageData data = evenData(smallGeometry(2, 3));
    change(data);
    const auto made = RangeImage::make(std::move(data));
    return made ? std::string() : made.error().what;
  };
  EXPECT_EQ(refused([](auto&) {}), "");
  EXPECT_NE(refused([](auto& d) { d.rows = 0; }), "");
  EXPECT_NE(refused([](auto& d) { d.columns = -1; }), "");
  EXPECT_NE(refused([](auto& d) { d.range_m.pop_back(); }), "");
  EXPECT_NE(refused([](auto& d) { d.code.push_back(0); }), "");
  EXPECT_NE(refused([](auto& d) { d.intensity = {1.0F}; }), "");
  EXPECT_NE(refused([](auto& d) { d.direction.resize(5); }), "");
  EXPECT_NE(refused([](auto& d) { d.line_tilt_rad.pop_back(); }), "");
  EXPECT_NE(refused([](auto& d) { d.line_tilt_rad[1] = static_cast<double>(kNan); }), "");
  EXPECT_NE(refused([](auto& d) { d.line_time_s = {1.0}; }), "");
  EXPECT_NE(refused([](auto& d) { d.line_time_s = {1.0, static_cast<double>(kInf)}; }), "");
  for (const float range : {0.0F, -1.0F, kNan, kInf})
    EXPECT_THAT(refused([&](auto& d) { d.range_m[4] = range; }), HasSubstr("cell 4"));
  EXPECT_THAT(refused([](auto& d) { d.direction.assign(6, Eigen::Vector3f(0, 1.1F, 0)); }),
              HasSubstr("cell 0"));
  EXPECT_THAT(refused([](auto& d) { d.direction.assign(6, Eigen::Vector3f(0, kNan, 0)); }),
              HasSubstr("cell 0"));
}

TEST(RangeImage, CountsScannedLines) {
  RangeImageData data = evenData(smallGeometry(3, 2));
  for (int column = 0; column < 2; ++column) setCell(data, 1, column, 0.0F, cell_code::kNotScanned);
  setCell(data, 2, 0, 0.0F, cell_code::kNotScanned);
  setCell(data, 2, 1, 0.0F, cell_code::kNoReturn);  // a line with nothing in sight was scanned all the same
  EXPECT_EQ(imageOf(data)->scannedLines(), 2);
}

TEST(RangeImage, AnUnorderedCloudIsNoMatrixAndASingleLineIs) {
  RangeImageData line = evenData(smallGeometry(1, 4));
  EXPECT_TRUE(imageOf(line)->isMatrix());
  line.direction.assign(4, Eigen::Vector3f::UnitY());
  EXPECT_FALSE(imageOf(line)->isMatrix());
  EXPECT_FALSE(imageOf(line)->isRegular());
}

TEST(CellCode, TellsFarFromUnknown) {
  using namespace cell_code;
  for (const CellCode code : {kMeasured, kReplaced}) EXPECT_TRUE(hasPoint(code));
  for (const CellCode code : {kMissing, kOutOfBounds, kMasked, kNotScanned, kNoReturn, kLmsFirst, kLmsLast})
    EXPECT_FALSE(hasPoint(code));
  for (const CellCode code : {kNoReturn, kLmsFirst, kLmsOverflow, kLmsNoSignal}) EXPECT_TRUE(isFar(code));
  for (const CellCode code :
       {kMeasured, kReplaced, kMissing, kOutOfBounds, kMasked, kNotScanned, kLmsDazzled})
    EXPECT_FALSE(isFar(code));
}

TEST(CellPoints, AgreeWithTheGeometryCellByCell) {
  ScannerGeometry g = smallGeometry(5, 37);
  g.azimuth_step_rad = 5 * kDegree;
  g.tilt_zero_rad = 0.01;
  g.lever_arm_m = {0.01, 0.02, 0.1};
  g.mounting = rotationExp({0.02, 0.01, -0.03});
  g.range_offset_m = 0.02;
  RangeImageData data = evenData(g);
  for (int row = 0; row < 5; ++row) {
    data.line_tilt_rad[static_cast<std::size_t>(row)] +=
        0.001 * row;  // the tilt read back, not the nominal one
    for (int column = 0; column < 37; ++column)
      setCell(data, row, column, 2.0F + 0.1F * static_cast<float>(column));
  }
  setCell(data, 3, 5, 0.0F, cell_code::kNoReturn);
  const auto image = imageOf(data);
  const auto points = cellPoints(*image, g);
  ASSERT_EQ(points.size(), image->cells());
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 37; ++column) {
      const std::size_t cell = image->index(row, column);
      if (!image->hasPoint(cell)) {
        EXPECT_TRUE(points[cell].isZero());
        continue;
      }
      const auto expected =
          g.point(image->lineTilt(row), g.azimuthOfColumn(column), static_cast<double>(image->range(cell)));
      EXPECT_LT((points[cell] - expected).norm(), 1e-13);
      EXPECT_LT((cellPoint(*image, g, row, column) - expected).norm(), 1e-13);
    }
  }
}

TEST(CellPoints, RowsMeetAtThePoles) {
  const ScannerGeometry g;
  const auto image = imageOf(evenData(g, 4.0F));
  const auto points = cellPoints(*image, g);
  for (int row = 0; row < image->rows(); ++row) {
    EXPECT_LT((points[image->index(row, 0)] - Eigen::Vector3d(4, 0, 0)).norm(), 1e-12);
    EXPECT_LT((points[image->index(row, 360)] - Eigen::Vector3d(-4, 0, 0)).norm(), 1e-12);
  }
}

TEST(CellPoints, FollowDirectionsKeptPerCell) {
  RangeImageData data = evenData(smallGeometry(1, 2), 3.0F);
  data.direction = {Eigen::Vector3f::UnitZ(), Eigen::Vector3f(0.6F, -0.8F, 0.0F)};
  ScannerGeometry g;
  g.tilt_zero_rad = 0.5;  // has no say here
  const auto image = imageOf(data);
  const auto points = cellPoints(*image, g);
  EXPECT_LT((points[0] - Eigen::Vector3d(0, 0, 3)).norm(), 1e-6);
  EXPECT_LT((points[1] - Eigen::Vector3d(1.8, -2.4, 0)).norm(), 1e-6);
  EXPECT_EQ(cellPoint(*image, g, 0, 1), points[1]);
}

}  // namespace
}  // namespace tiltmap
