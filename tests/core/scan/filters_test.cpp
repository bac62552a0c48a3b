#include "core/scan/filters.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using namespace testing_support;

constexpr double kNoReturnRange = 81.89;

// A wall 5 m away with one beam of 30 m in it.
RangeImageData spiked(float spike = 30.0F) {
  RangeImageData data = evenData(smallGeometry(5, 9));
  setCell(data, 2, 4, spike);
  return data;
}

MedianFilterSettings thesisVotes() {
  MedianFilterSettings settings;
  settings.no_return_votes = true;
  return settings;
}

TEST(MedianFilter, ReplacesASpikeAndTellsSo) {
  const auto image = imageOf(spiked());
  for (const MedianWindow window : {MedianWindow::Square, MedianWindow::Line}) {
    MedianFilterSettings settings;
    settings.window = window;
    const FilteredImage result = medianFiltered(image, settings);
    ASSERT_EQ(result.changes.size(), 1U);
    EXPECT_EQ(result.changes[0].row, 2);
    EXPECT_EQ(result.changes[0].column, 4);
    EXPECT_EQ(result.changes[0].before_m, 30.0);
    EXPECT_EQ(result.changes[0].after_m, 5.0);
    EXPECT_EQ(result.meanChange(), 25.0);
    EXPECT_EQ(result.image->range(2, 4), 5.0F);
    EXPECT_EQ(result.image->code(2, 4), cell_code::kReplaced);
    EXPECT_EQ(result.image->code(2, 3), cell_code::kMeasured);
  }
  EXPECT_EQ(image->range(2, 4), 30.0F);  // what was given stays
}

TEST(MedianFilter, LeavesASmoothMatrixAndTheNoneWindowAlone) {
  const auto smooth = imageOf(evenData(smallGeometry(5, 9)));
  const FilteredImage result = medianFiltered(smooth, {});
  EXPECT_TRUE(result.changes.empty());
  EXPECT_EQ(result.meanChange(), 0.0);
  EXPECT_EQ(result.image, smooth);
  MedianFilterSettings none;
  none.window = MedianWindow::None;
  const auto image = imageOf(spiked());
  EXPECT_EQ(medianFiltered(image, none).image, image);
}

TEST(MedianFilter, ReplacesOnlyBeyondTheThreshold) {
  MedianFilterSettings settings;
  settings.threshold_m = 2.0;
  EXPECT_EQ(medianFiltered(imageOf(spiked(7.0F)), settings).changes.size(), 0U);  // exactly 2 m
  EXPECT_EQ(medianFiltered(imageOf(spiked(7.01F)), settings).changes.size(), 1U);
}

TEST(MedianFilter, OneSidedKeepsWhatIsNearer) {
  MedianFilterSettings settings;
  const auto near = imageOf(spiked(1.0F)), far = imageOf(spiked(30.0F));
  EXPECT_EQ(medianFiltered(near, settings).changes.size(), 1U);
  settings.one_sided = true;
  EXPECT_EQ(medianFiltered(near, settings).changes.size(), 0U);
  EXPECT_EQ(medianFiltered(far, settings).changes.size(), 1U);
}

TEST(MedianFilter, TheCentreVotesUnlessToldNot) {
  // Four values at 5 m and four at 30 m around a centre at 30 m: with it the median is 30 m, without it the
  // lower middle one, 5 m.
  RangeImageData data = evenData(smallGeometry(3, 3));
  for (const auto& [row, column] : {std::pair{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}})
    setCell(data, row, column, 30.0F);
  MedianFilterSettings settings;
  const auto changed = [&] {
    const auto changes = medianFiltered(imageOf(data), settings).changes;
    return std::ranges::any_of(changes, [](const CellChange& c) { return c.row == 1 && c.column == 1; });
  };
  EXPECT_FALSE(changed());
  settings.include_centre = false;
  EXPECT_TRUE(changed());
}

TEST(MedianFilter, TheWindowShrinksAtTheBorder) {
  for (const auto& [row, column] : {std::pair{0, 0}, {0, 4}, {4, 8}, {2, 0}}) {
    RangeImageData data = evenData(smallGeometry(5, 9));
    setCell(data, row, column, 40.0F);
    for (const MedianWindow window : {MedianWindow::Square, MedianWindow::Line}) {
      MedianFilterSettings settings;
      settings.window = window;
      const auto result = medianFiltered(imageOf(data), settings);
      ASSERT_EQ(result.changes.size(), 1U);
      EXPECT_EQ(result.image->range(row, column), 5.0F);
    }
  }
}

TEST(MedianFilter, TheLineWindowLooksAlongItsLineOnly) {
  // A lamp post: four columns wide in one line is a majority of seven there, but not of a square.
  RangeImageData data = evenData(smallGeometry(5, 11));
  for (int column = 4; column <= 6; ++column) setCell(data, 2, column, 1.0F);
  MedianFilterSettings line;
  line.window = MedianWindow::Line;
  EXPECT_EQ(medianFiltered(imageOf(data), line).changes.size(), 3U);  // three of seven are outvoted
  setCell(data, 2, 7, 1.0F);
  const auto changes = medianFiltered(imageOf(data), line).changes;
  for (const CellChange& change : changes) EXPECT_EQ(change.row, 2);
  EXPECT_TRUE(
      std::ranges::none_of(changes, [](const CellChange& c) { return c.column == 5 || c.column == 6; }));
  EXPECT_EQ(medianFiltered(imageOf(data), {}).changes.size(),
            4U);  // the square sees the rows above and below
}

TEST(MedianFilter, WithoutVotesCellsWithoutAReturnStayAndAreSilent) {
  RangeImageData data = evenData(smallGeometry(3, 3));
  data.code.assign(9, cell_code::kLmsOverflow);
  setCell(data, 1, 1, 5.0F);
  setCell(data, 0, 0, 6.0F);
  const auto image = imageOf(data);
  EXPECT_EQ(medianFiltered(image, {}).image, image);
  RangeImageData hole = evenData(smallGeometry(3, 3));
  setCell(hole, 1, 1, 0.0F, cell_code::kLmsOverflow);
  const auto with_hole = imageOf(hole);
  EXPECT_EQ(medianFiltered(with_hole, {}).image, with_hole);
}

TEST(MedianFilter, WithVotesAHoleInAWallBecomesAPoint) {
  RangeImageData data = evenData(smallGeometry(3, 3));
  setCell(data, 1, 1, 0.0F, cell_code::kLmsNoSignal);
  const auto result = medianFiltered(imageOf(data), thesisVotes());
  ASSERT_EQ(result.changes.size(), 1U);
  EXPECT_NEAR(result.changes[0].before_m, kNoReturnRange, 1e-5);
  EXPECT_EQ(result.changes[0].after_m, 5.0);
  EXPECT_EQ(result.image->code(1, 1), cell_code::kReplaced);
  EXPECT_EQ(result.image->range(1, 1), 5.0F);
  EXPECT_EQ(result.image->validCells(), 9U);
}

TEST(MedianFilter, WithVotesAPointInTheSkyBecomesNoReturn) {
  for (const CellCode code : {cell_code::kLmsOverflow, cell_code::kNoReturn}) {
    RangeImageData data = evenData(smallGeometry(3, 3));
    data.code.assign(9, code);
    setCell(data, 1, 1, 5.0F);
    const auto result = medianFiltered(imageOf(data), thesisVotes());
    ASSERT_EQ(result.changes.size(), 1U);
    EXPECT_EQ(result.changes[0].before_m, 5.0);
    EXPECT_NEAR(result.changes[0].after_m, kNoReturnRange, 1e-5);
    EXPECT_EQ(result.image->code(1, 1), code);
    EXPECT_EQ(result.image->validCells(), 0U);
  }
}

TEST(MedianFilter, CellsThatSayNothingNeitherVoteNorChange) {
  for (const CellCode code : {cell_code::kLmsDazzled, cell_code::kMasked, cell_code::kMissing,
                              cell_code::kNotScanned, cell_code::kOutOfBounds}) {
    RangeImageData data = evenData(smallGeometry(3, 3));
    data.code.assign(9, code);
    setCell(data, 1, 1, 30.0F);  // outvoted by two, if the six others stay silent
    setCell(data, 0, 0, 5.0F);
    setCell(data, 2, 2, 5.0F);
    const auto result = medianFiltered(imageOf(data), thesisVotes());
    ASSERT_EQ(result.changes.size(), 1U);
    EXPECT_EQ(result.image->range(1, 1), 5.0F);
    EXPECT_EQ(result.image->code(0, 1), code);
    EXPECT_EQ(result.image->validCells(), 3U);
  }
}

TEST(MedianFilter, AFarPointOfAnUnknownScannerStaysAPoint) {
  RangeImageData data = evenData(smallGeometry(3, 3), 120.0F);
  setCell(data, 1, 1, 5.0F);
  const auto result = medianFiltered(imageOf(data), thesisVotes());
  EXPECT_EQ(result.image->range(1, 1), 120.0F);
  EXPECT_TRUE(result.image->hasPoint(1, 1));
}

TEST(MedianFilter, WorksOnMatricesWithDirectionsPerCell) {
  RangeImageData data = evenData(smallGeometry(3, 3));
  data.direction.assign(9, Eigen::Vector3f::UnitY());
  setCell(data, 1, 1, 30.0F);
  setCell(data, 0, 0, 0.0F, cell_code::kNoReturn);
  const auto result = medianFiltered(imageOf(data), thesisVotes());
  ASSERT_EQ(result.changes.size(), 1U);
  EXPECT_EQ(result.image->range(1, 1), 5.0F);
  EXPECT_FALSE(result.image->hasPoint(0, 0));  // it has no direction to put a point in
  EXPECT_EQ(result.image->directions()[4], Eigen::Vector3f::UnitY());
}

TEST(MedianFilter, LeavesAnUnorderedCloudAloneAndFiltersASingleLine) {
  RangeImageData data = evenData(smallGeometry(1, 9));
  setCell(data, 0, 4, 30.0F);
  EXPECT_EQ(medianFiltered(imageOf(data), {}).changes.size(), 1U);
  data.direction.assign(9, Eigen::Vector3f::UnitY());
  const auto cloud = imageOf(data);
  EXPECT_EQ(medianFiltered(cloud, {}).image, cloud);
}

TEST(MedianFilter, AgreesWithSortingEveryWindow) {
  // The straightforward filter, written again, over random matrices with holes.
  RandomStream random(5);
  for (int round = 0; round < 20; ++round) {
    MedianFilterSettings settings;
    settings.window = round % 2 == 0 ? MedianWindow::Square : MedianWindow::Line;
    settings.one_sided = round % 3 == 0;
    settings.include_centre = round % 5 != 0;
    settings.no_return_votes = round % 4 < 2;
    RangeImageData data = evenData(smallGeometry(12, 15));
    for (std::size_t i = 0; i < data.cells(); ++i) {
      data.range_m[i] = static_cast<float>(random.uniform(1.0, 12.0));
      if (random.uniform() < 0.3) data.code[i] = cell_code::kLmsOverflow;
      if (random.uniform() < 0.1) data.code[i] = cell_code::kMissing;
    }
    const auto image = imageOf(data);
    const FilteredImage result = medianFiltered(image, settings);
    const int high = settings.window == MedianWindow::Square ? 1 : 0,
              wide = settings.window == MedianWindow::Square ? 1 : 3;
    std::size_t changes = 0;
    for (int row = 0; row < 12; ++row) {
      for (int column = 0; column < 15; ++column) {
        const auto vote = [&](int r, int c) {
          if (image->hasPoint(r, c)) return image->range(r, c);
          return settings.no_return_votes && cell_code::isFar(image->code(r, c)) ? 81.89F : -1.0F;
        };
        std::vector<float> votes;
        for (int r = std::max(0, row - high); r <= std::min(11, row + high); ++r)
          for (int c = std::max(0, column - wide); c <= std::min(14, column + wide); ++c)
            if (vote(r, c) > 0.0F && (settings.include_centre || r != row || c != column))
              votes.push_back(vote(r, c));
        const float own = vote(row, column);
        float expected = own;
        if (own > 0.0F && !votes.empty()) {
          std::ranges::sort(votes);
          const float median = votes[(votes.size() - 1) / 2];
          if (own - median > 2.0F || (!settings.one_sided && median - own > 2.0F)) expected = median;
        }
        changes += expected != own ? 1 : 0;
        if (expected < 0.0F || expected == 81.89F) {
          EXPECT_FALSE(result.image->hasPoint(row, column));
        } else {
          EXPECT_EQ(result.image->range(row, column), expected) << row << " " << column;
        }
      }
    }
    EXPECT_GT(changes, 0U);
    EXPECT_EQ(result.changes.size(), changes);
  }
}

TEST(MedianFilter, RefusesABrokenContract) {
  const auto image = imageOf(spiked());
  EXPECT_THROW(medianFiltered(nullptr, {}), std::invalid_argument);
  const auto with = [](double threshold, double no_return) {
    MedianFilterSettings settings;
    settings.threshold_m = threshold;
    settings.no_return_range_m = no_return;
    return settings;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(medianFiltered(image, with(-1.0, 80.0)), std::invalid_argument);
  EXPECT_THROW(medianFiltered(image, with(nan, 80.0)), std::invalid_argument);
  EXPECT_THROW(medianFiltered(image, with(2.0, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
