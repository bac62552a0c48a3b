#include "core/calibration/body_mask.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "tests/support/range_images.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace testing_support;

constexpr int kRows = 20, kColumns = 30;

// Surroundings at 5 m and more, another for each seed; a bumper in rows 0 to 3, columns 10 to 19.
RangeImagePtr scan(std::uint64_t seed, bool bumper = true, double nearest_m = 5.0) {
  RandomStream random(seed);
  RangeImageData data = evenData(smallGeometry(kRows, kColumns));
  for (float& range : data.range_m) range = static_cast<float>(random.uniform(nearest_m, 20.0));
  if (bumper)
    for (int row = 0; row < 4; ++row)
      for (int column = 10; column < 20; ++column)
        setCell(data, row, column, static_cast<float>(0.4 + 0.01 * row + random.uniform(-0.01, 0.01)));
  return imageOf(std::move(data));
}

bool isMasked(const BodyMask& mask, int row, int column) {
  return mask.masked[static_cast<std::size_t>(row * kColumns + column)] != 0;
}

TEST(BodyMask, FindsTheBumperInOneScanAndInMany) {
  for (const std::vector<RangeImagePtr>& images :
       {std::vector<RangeImagePtr>{scan(1)}, std::vector<RangeImagePtr>{scan(1), scan(2), scan(3)}}) {
    const auto mask = learnBodyMask(images, {});
    ASSERT_TRUE(mask);
    EXPECT_EQ(mask->cells, 40U);
    EXPECT_NEAR(mask->furthest_m, 0.43, 0.011);
    EXPECT_NEAR(mask->minimum_range_m, 0.48, 0.011);
    EXPECT_TRUE(isMasked(*mask, 0, 10) && isMasked(*mask, 3, 19));
    EXPECT_TRUE(isMasked(*mask, 4, 20)) << "the margin";
    EXPECT_FALSE(isMasked(*mask, 5, 15) || isMasked(*mask, 0, 8) || isMasked(*mask, 19, 29));
  }
}

TEST(BodyMask, SomethingNearInOneScanOnlyIsNotTheBody) {
  RangeImageData data = scan(2)->data();
  for (int column = 0; column < 5; ++column) setCell(data, 10, column, 0.5F);
  const auto passer_by = imageOf(std::move(data));
  const auto mask = learnBodyMask({scan(1), passer_by, scan(3)}, {});
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->cells, 40U);
  EXPECT_FALSE(isMasked(*mask, 10, 2));
  EXPECT_GT(learnBodyMask({passer_by}, {})->cells, 40U) << "one scan cannot tell them apart";
}

TEST(BodyMask, WhatIsNearAtChangingRangesIsNotTheBody) {
  const auto mask = learnBodyMask({scan(1, false, 0.1), scan(2, false, 0.1), scan(3, false, 0.1)}, {});
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->cells, 0U);
  EXPECT_EQ(mask->minimum_range_m, 0.0);
}

TEST(BodyMask, NoMinimumRangeWhereSurroundingsComeAsNear) {
  std::vector<RangeImagePtr> images;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    RangeImageData data = scan(seed)->data();
    for (int column = 0; column < kColumns; ++column)
      setCell(data, 15, column, 0.1F * static_cast<float>(seed));  // a hand that moves
    images.push_back(imageOf(std::move(data)));
  }
  const auto mask = learnBodyMask(images, {});
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->cells, 40U);
  EXPECT_EQ(mask->minimum_range_m, 0.0);
}

TEST(BodyMask, NothingNearMakesAnEmptyMask) {
  const auto mask = learnBodyMask({scan(1, false)}, {});
  ASSERT_TRUE(mask);
  EXPECT_EQ(mask->cells, 0U);
  EXPECT_TRUE(nlohmann::json::parse(bodyMaskText(*mask))["runs_row_first_last"].empty());
}

TEST(BodyMask, TextHoldsEveryRun) {
  const auto mask = learnBodyMask({scan(1)}, {});
  const auto json = nlohmann::json::parse(bodyMaskText(*mask));
  EXPECT_EQ(json["runs_row_first_last"].size(), 5U);
  EXPECT_EQ(json["runs_row_first_last"][4], nlohmann::json({4, 9, 20}));
  EXPECT_EQ(json["cells"], 40);
}

TEST(BodyMask, WhatIsMaskedAlreadyStaysSoAndIsNotFoundAgain) {
  std::vector<RangeImagePtr> masked;
  for (const std::uint64_t seed : {1U, 2U}) {
    RangeImageData data = scan(seed)->data();
    ASSERT_TRUE(maskCells(cellsOf(*learnBodyMask({scan(1)}, {})), data));
    masked.push_back(imageOf(std::move(data)));
  }
  const auto again = learnBodyMask(masked, {});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->cells, 0U);
  EXPECT_EQ(cellsOf(*again), cellsOf(*learnBodyMask({scan(1)}, {}))) << "and gets no second margin";
  masked.push_back(scan(3));
  const auto with_new = learnBodyMask(masked, {});
  ASSERT_TRUE(with_new);
  EXPECT_EQ(with_new->cells, 40U) << "a scan that came later shows it still";
  EXPECT_EQ(cellsOf(*with_new), cellsOf(*learnBodyMask({scan(1)}, {})));
}

TEST(BodyMask, FileReadsBack) {
  test::TemporaryFolder folder;
  const auto mask = learnBodyMask({scan(1)}, {});
  const auto write = [&](const std::string& text) { std::ofstream(folder / "m.json") << text; };
  write(bodyMaskText(*mask));
  const auto read = readBodyMask(folder / "m.json");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->cells, cellsOf(*mask));
  EXPECT_EQ(read->minimum_range_m, mask->minimum_range_m);
  EXPECT_FALSE(readBodyMask(folder / "none.json"));
  for (const char* text :
       {"", "x", "[]", "{}", R"({"format": "tiltmap calibration 1"})",
        R"({"format": "tiltmap body mask 1", "rows": 2, "columns": 2})",
        R"({"format": "tiltmap body mask 1", "rows": 2, "columns": 2, "minimum_range_m": 0,
                               "runs_row_first_last": [[0, 0, 2]]})",
        R"({"format": "tiltmap body mask 1", "rows": 2, "columns": 2, "minimum_range_m": -1,
                               "runs_row_first_last": []})"}) {
    write(text);
    EXPECT_FALSE(readBodyMask(folder / "m.json")) << text;
  }
}

TEST(BodyMask, RefusesWhatDoesNotFitTogether) {
  EXPECT_FALSE(learnBodyMask({}, {}));
  EXPECT_FALSE(learnBodyMask({scan(1), imageOf(evenData(smallGeometry(kRows, kColumns + 1)))}, {}));
}

}  // namespace
}  // namespace tiltmap
