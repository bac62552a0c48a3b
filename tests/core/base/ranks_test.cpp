#include "core/base/ranks.h"

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

TEST(ValueAtRank, IsTheOneThatSoManyPrecede) {
  for (std::size_t rank = 0; rank < 5; ++rank) {
    std::vector<int> values = {40, 0, 30, 10, 20};
    EXPECT_EQ(valueAtRank(values, rank), 10 * static_cast<int>(rank));
  }
}

TEST(QuantileOf, ReachesFromTheLeastToTheGreatest) {
  std::vector<double> values = {4.0, 1.0, 3.0, 0.0, 2.0};
  EXPECT_EQ(quantileOf(values, 0.0), 0.0);
  EXPECT_EQ(quantileOf(values, 0.5), 2.0);
  EXPECT_EQ(quantileOf(values, 0.74), 2.0);
  EXPECT_EQ(quantileOf(values, 1.0), 4.0);
}

TEST(MedianOf, IsTheUpperOfTwoMiddleOnes) {
  EXPECT_EQ(medianOf<double>({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(medianOf<double>({4.0, 1.0, 2.0, 3.0}), 3.0);
}

TEST(MedianOf, OfNothingIsRefused) {
  EXPECT_THROW(medianOf<double>({}), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
