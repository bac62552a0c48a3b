#include "core/scan/cell_mask.h"

#include <gtest/gtest.h>

#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

using namespace testing_support;

CellMask sample() {
  return {4, 6, {{0, 0, 5}, {2, 1, 1}, {2, 3, 5}}};
}

TEST(CellMask, RunsAndFlagsAreTheSame) {
  const std::vector<char> flags = maskedCells(sample());
  EXPECT_EQ(std::ranges::count(flags, 1), 10);
  EXPECT_EQ(sample().cells(), 10U);
  EXPECT_EQ(flags[2 * 6 + 1], 1);
  EXPECT_EQ(flags[2 * 6 + 2], 0);
  EXPECT_EQ(cellMask(4, 6, flags), sample());
  EXPECT_TRUE(cellMask(4, 6, std::vector<char>(24, 0)).empty());
  EXPECT_THROW((void)cellMask(4, 6, std::vector<char>(23, 0)), std::invalid_argument);
}

TEST(CellMask, TextReadsBack) {
  EXPECT_EQ(cellMaskText(sample()), "4x6 0:0-5 2:1-1 2:3-5");
  const auto read = parseCellMask(cellMaskText(sample()), "here");
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, sample());
  EXPECT_TRUE(parseCellMask("4x6", "here")->empty());
}

TEST(CellMask, RefusesTextsAndRunsThatAreNone) {
  for (const char* text :
       {"", "x", "4", "4x", "4x6x2", "0x6", "-4x6", "4x6 0", "4x6 0:1", "4x6 0:1-", "4x6 4:0-1", "4x6 0:0-6",
        "4x6 0:3-2", "4x6 1:0-1 0:0-1", "4x6 0:0-2 0:2-3", "4x6 0:a-3", "99999999999x6", "4x6 0:0-5,"}) {
    const auto read = parseCellMask(text, "file.json");
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().where, "file.json");
    EXPECT_FALSE(read.error().remedy.empty());
  }
}

TEST(CellMask, MasksItsCellsAndNoOthers) {
  RangeImageData data = evenData(smallGeometry(4, 6));
  setCell(data, 0, 1, 0.0F, cell_code::kNotScanned);
  setCell(data, 0, 2, 0.0F, cell_code::kLmsDazzled);
  const RangeImageData before = data;
  ASSERT_TRUE(maskCells(sample(), data));
  const std::vector<char> flags = maskedCells(sample());
  for (std::size_t cell = 0; cell < data.cells(); ++cell) {
    EXPECT_EQ(data.range_m[cell], before.range_m[cell]);
    if (cell == 1)
      EXPECT_EQ(data.code[cell], cell_code::kNotScanned) << "what was never taken shows nothing";
    else
      EXPECT_EQ(data.code[cell], flags[cell] ? cell_code::kMasked : before.code[cell]) << cell;
  }
  EXPECT_EQ(imageOf(data)->validCells(), 14U);

  RangeImageData other = evenData(smallGeometry(6, 4));
  EXPECT_FALSE(maskCells(sample(), other));
  EXPECT_EQ(other.code, evenData(smallGeometry(6, 4)).code);
}

}  // namespace
}  // namespace tiltmap
