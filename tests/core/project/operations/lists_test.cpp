#include <gtest/gtest.h>

#include "core/project/operations/index_list.h"
#include "core/project/operations/pair_list.h"

namespace tiltmap {
namespace {

TEST(PairList, EmptyMeansEachScanWithTheOneBefore) {
  EXPECT_EQ(parsePairList("", 4).value(), (std::vector<IndexPair>{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_TRUE(parsePairList("", 1).value().empty());
}

TEST(PairList, KeepsOrderAndDirection) {
  EXPECT_EQ(parsePairList("3:1, 0:2", 4).value(), (std::vector<IndexPair>{{3, 1}, {0, 2}}));
}

TEST(PairList, RefusesAndNamesThePart) {
  for (const char* bad : {"0", "0:1:2", "0:4", "-1:0", "a:b", "1:1", "0:1,0:1", ":", "0:1,"}) {
    const auto list = parsePairList(bad, 4);
    ASSERT_FALSE(list) << bad;
    EXPECT_NE(list.error().where.find(bad), std::string::npos);
    EXPECT_FALSE(list.error().remedy.empty());
  }
  EXPECT_NE(parsePairList("0:1,2:9", 4).error().what.find("2:9"), std::string::npos);
}

TEST(IndexList, RangesSinglesAndNoRepeats) {
  EXPECT_EQ(parseIndexList("0-2,7,1-3", 10, "--scans").value(), (std::vector<int>{0, 1, 2, 7, 3}));
  EXPECT_EQ(parseIndexList("4", 5, "--scans").value(), (std::vector<int>{4}));
}

TEST(IndexList, RefusesAndNamesThePart) {
  for (const char* bad : {"", "5", "3-1", "0-5", "x", "1-2-3", "-1", "1,,2"}) {
    const auto list = parseIndexList(bad, 5, "--scans");
    ASSERT_FALSE(list) << bad;
    EXPECT_EQ(list.error().where, "--scans");
  }
}

}  // namespace
}  // namespace tiltmap
