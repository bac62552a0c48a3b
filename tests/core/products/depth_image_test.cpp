#include "core/products/depth_image.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/products/depth_figure.h"
#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using testing_support::evenData;
using testing_support::imageOf;
using testing_support::imageOfScene;
using testing_support::setCell;
using testing_support::smallGeometry;

const Rgb kNone{1, 2, 3};

DepthImage must(Result<DepthImage> image) {
  if (!image) throw std::runtime_error(image.error().what);
  return std::move(*image);
}

TEST(DepthImage, ShowsRangesAndNothingWhereThereIsNoPoint) {
  const ScannerGeometry geometry = smallGeometry(3, 4);
  RangeImageData data = evenData(geometry, 4.0F);
  setCell(data, 0, 1, 9.0F);
  setCell(data, 2, 3, 0.0F, cell_code::kNoReturn);
  const DepthImage depth = must(depthImageOf(imageOf(data), geometry, DepthQuantity::Range));
  EXPECT_FLOAT_EQ(depth.value[depth.index(0, 1)], 9.0F);
  EXPECT_FLOAT_EQ(depth.value[depth.index(1, 1)], 4.0F);
  EXPECT_TRUE(std::isnan(depth.value[depth.index(2, 3)]));
  EXPECT_EQ(depth.unit, "m");
}

TEST(DepthImage, PictureIsSeenFromTheScanner) {
  // Row 0 looks lowest and column 0 to the right: both must come out so.
  const ScannerGeometry geometry = smallGeometry(3, 4);
  RangeImageData data = evenData(geometry, 2.0F);
  setCell(data, 0, 0, 8.0F);
  setCell(data, 2, 3, 0.0F, cell_code::kNoReturn);
  const DepthImage depth = must(depthImageOf(imageOf(data), geometry, DepthQuantity::Range));
  const RgbImage picture = depthPicture(depth, 2.0, 8.0, kNone);
  EXPECT_EQ(picture.width, 4);
  EXPECT_EQ(picture.height, 3);
  EXPECT_EQ(picture.at(3, 2), depthColour(8.0, 2.0, 8.0));
  EXPECT_EQ(picture.at(2, 2), depthColour(2.0, 2.0, 8.0));
  EXPECT_EQ(picture.at(0, 0), kNone);
  for (int column = 0; column < 4; ++column)
    EXPECT_EQ(depth.columnAtPixel(depth.pixelOfColumn(column)), column);
}

TEST(DepthImage, ColoursFollowTheRangeThatIsSet) {
  const ScannerGeometry geometry = smallGeometry(1, 3);
  RangeImageData data = evenData(geometry, 5.0F);
  const DepthImage depth = must(depthImageOf(imageOf(data), geometry, DepthQuantity::Range));
  EXPECT_EQ(depthPicture(depth, 0.0, 10.0, kNone).at(0, 0), depthColour(0.5, 0.0, 1.0));
  EXPECT_EQ(depthPicture(depth, 6.0, 10.0, kNone).at(0, 0), depthColour(0.0, 0.0, 1.0));
  EXPECT_NE(depthPicture(depth, 0.0, 10.0, kNone).at(0, 0), depthPicture(depth, 0.0, 5.0, kNone).at(0, 0));
  EXPECT_LT(depth.low, depth.high);  // though all values are alike
}

TEST(DepthImage, MarksAndCountsWhatTheMedianChanged) {
  const ScannerGeometry geometry = smallGeometry(5, 5);
  RangeImageData data = evenData(geometry, 5.0F);
  setCell(data, 2, 2, 15.0F);
  const RangeImagePtr image = imageOf(data);
  const DepthImage changed = must(depthImageOf(image, geometry, DepthQuantity::Changed));
  EXPECT_EQ(changed.changed, 1U);
  EXPECT_DOUBLE_EQ(changed.mean_change_m, 10.0);
  EXPECT_FLOAT_EQ(changed.value[changed.index(2, 2)], 10.0F);
  const RgbImage picture = depthPicture(changed, 0.0, 1.0, kNone);
  const Rgb mark = picture.at(changed.pixelOfColumn(2), changed.pixelOfRow(2));
  const Rgb other = picture.at(0, 0);
  EXPECT_EQ(other.r, other.b);  // grey
  EXPECT_GT(mark.r, mark.b + 100);
  const DepthImage median = must(depthImageOf(image, geometry, DepthQuantity::Median));
  EXPECT_FLOAT_EQ(median.value[median.index(2, 2)], 5.0F);
  const DepthImage raw = must(depthImageOf(image, geometry, DepthQuantity::Range));
  EXPECT_FLOAT_EQ(raw.value[raw.index(2, 2)], 15.0F);
}

TEST(DepthImage, PlanarMedianLooksAlongTheLineOnly) {
  // A far row: right for the line through it, an outlier for the window across rows.
  const ScannerGeometry geometry = smallGeometry(5, 15);
  RangeImageData data = evenData(geometry, 5.0F);
  for (int column = 0; column < 15; ++column) setCell(data, 2, column, 12.0F);
  const RangeImagePtr image = imageOf(data);
  const DepthImage planar = must(depthImageOf(image, geometry, DepthQuantity::PlanarMedian));
  const DepthImage square = must(depthImageOf(image, geometry, DepthQuantity::Median));
  EXPECT_FLOAT_EQ(planar.value[planar.index(2, 7)], 12.0F);
  EXPECT_FLOAT_EQ(square.value[square.index(2, 7)], 5.0F);
}

TEST(DepthImage, NormalsAndIncidenceOfAWallAhead) {
  // A wall across the view, 4 m ahead.
  ScannerGeometry geometry = smallGeometry(41, 121);
  geometry.azimuth_start_rad = 60.0 * kDegree;
  geometry.tilt_start_rad = -16.0 * kDegree;
  const RangeImagePtr image = imageOfScene(geometry, [](const Eigen::Vector3d& d) { return 4.0 / d.y(); });
  const DepthImage incidence = must(depthImageOf(image, geometry, DepthQuantity::Incidence));
  EXPECT_NEAR(incidence.value[incidence.index(20, 60)], 0.0, 0.3);
  EXPECT_NEAR(incidence.value[incidence.index(20, 100)], 20.0, 0.3);
  EXPECT_EQ(incidence.low, 0.0);
  EXPECT_EQ(incidence.high, 90.0);
  const DepthImage normal = must(depthImageOf(image, geometry, DepthQuantity::Normal));
  const Rgb colour = normal.colour[normal.index(20, 60)];  // (0, -1, 0)
  EXPECT_NEAR(colour.r, 128, 3);
  EXPECT_NEAR(colour.g, 0, 3);
  EXPECT_NEAR(colour.b, 128, 3);
  EXPECT_TRUE(std::isnan(normal.value[normal.index(0, 0)]));  // no neighbours on all sides
  EXPECT_FALSE(normal.hasColourBar());
}

TEST(DepthImage, CodesTellWhyThereIsNoPoint) {
  const ScannerGeometry geometry = smallGeometry(1, 3);
  RangeImageData data = evenData(geometry, 5.0F);
  setCell(data, 0, 1, 0.0F, cell_code::kLmsDazzled);
  setCell(data, 0, 2, 0.0F, cell_code::kMasked);
  const DepthImage codes = must(depthImageOf(imageOf(data), geometry, DepthQuantity::Code));
  ASSERT_EQ(codes.legend.size(), 3U);
  std::set<std::string> colours;
  for (const auto& [text, colour] : codes.legend) colours.insert(hexOf(colour));
  EXPECT_EQ(colours.size(), 3U);
  EXPECT_NE(cellCodeText(cell_code::kLmsDazzled).find("dazzled"), std::string::npos);
  EXPECT_NE(cellCodeText(8185).find("8185"), std::string::npos);
}

TEST(DepthImage, RefusesWhatItCannotShow) {
  const ScannerGeometry geometry = smallGeometry(2, 2);
  const auto none = depthImageOf(imageOf(evenData(geometry)), geometry, DepthQuantity::Intensity);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().what.find("intensity"), std::string::npos);
  RangeImageData cloud;
  cloud.rows = 1;
  cloud.columns = 2;
  cloud.range_m = {1.0F, 2.0F};
  cloud.code = {cell_code::kMeasured, cell_code::kMeasured};
  cloud.line_tilt_rad = {0.0};
  cloud.direction = {Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitY()};
  EXPECT_FALSE(depthImageOf(imageOf(cloud), geometry, DepthQuantity::Range));
}

TEST(DepthImage, NamesReadBack) {
  for (const DepthQuantity quantity : kDepthQuantities)
    EXPECT_EQ(parseDepthQuantity(depthQuantityName(quantity)).value(), quantity);
  const auto wrong = parseDepthQuantity("medain");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().remedy.find("median"), std::string::npos);
}

TEST(DepthFigure, DrawsTheMatrixInItsPlaceWithAxesAround) {
  const ScannerGeometry geometry = smallGeometry(11, 37);
  RangeImageData data = evenData(geometry, 2.0F);
  setCell(data, 10, 36, 8.0F);  // upper left
  const DepthImage depth = must(depthImageOf(imageOf(data), geometry, DepthQuantity::Range));
  DepthFigureSettings settings;
  settings.width_px = 800;
  settings.title = "Scan 0";
  settings.range = std::pair(2.0, 8.0);
  const auto figure = drawDepthFigure(depth, settings);
  ASSERT_TRUE(figure) << figure.error().what;
  EXPECT_EQ(figure->image.width, 800);
  const double cell_width = figure->width / 37, cell_height = figure->height / 11;
  EXPECT_NEAR(cell_width / 0.5, cell_height / 0.8, 1e-6);  // a degree is as wide as high
  const int x = static_cast<int>(figure->left + 0.5 * cell_width);
  const int y = static_cast<int>(figure->top + 0.5 * cell_height);
  EXPECT_EQ(figure->image.at(x, y), depthColour(8.0, 2.0, 8.0));
  EXPECT_EQ(figure->image.at(x + static_cast<int>(5 * cell_width), y), depthColour(2.0, 2.0, 8.0));
  // Something is written below and to the left.
  const auto inked = [&](int x0, int y0, int x1, int y1) {
    int count = 0;
    for (int py = y0; py < y1; ++py)
      for (int px = x0; px < x1; ++px) count += figure->image.at(px, py) != figure->image.at(0, 0);
    return count;
  };
  const int bottom = static_cast<int>(figure->top + figure->height) + 8;
  EXPECT_GT(inked(100, bottom, 700, bottom + 40), 100);
  EXPECT_GT(inked(0, static_cast<int>(figure->top), static_cast<int>(figure->left) - 8, bottom), 30);
}

TEST(DepthFigure, RefusesSizesThatCannotBe) {
  const ScannerGeometry geometry = smallGeometry(2, 2);
  const DepthImage depth = must(depthImageOf(imageOf(evenData(geometry)), geometry, DepthQuantity::Range));
  for (const auto& [width, height] : {std::pair(10, 400), std::pair(400, 10), std::pair(40000, 400)}) {
    DepthFigureSettings settings;
    settings.width_px = width;
    settings.height_px = height;
    EXPECT_FALSE(drawDepthFigure(depth, settings)) << width << " x " << height;
  }
}

TEST(AxisTicks, AreRoundAndInside) {
  EXPECT_EQ(axisTicks(0.0, 180.0, 9), (std::vector<double>{0, 20, 40, 60, 80, 100, 120, 140, 160, 180}));
  EXPECT_EQ(axisTicks(-30.0, 50.0, 4), (std::vector<double>{-20, 0, 20, 40}));
  EXPECT_EQ(axisTicks(0.11, 0.39, 3), (std::vector<double>{0.2, 0.3}));
  EXPECT_TRUE(axisTicks(1.0, 1.0, 5).empty());
  EXPECT_TRUE(axisTicks(2.0, 1.0, 5).empty());
}

}  // namespace
}  // namespace tiltmap
