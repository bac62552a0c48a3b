#include "core/base/random.h"

#include <vector>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

TEST(RandomStream, GivesThePublishedNumbersOfSplitMix64) {
  RandomStream stream(1234567);
  for (const std::uint64_t expected : {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                       4593380528125082431ULL, 16408922859458223821ULL})
    EXPECT_EQ(stream.next(), expected);
}

TEST(RandomStream, KeyedStreamsDependOnEveryKeyAndItsPlace) {
  const auto first = [](std::initializer_list<std::uint64_t> keys) {
    return RandomStream::keyed(keys).next();
  };
  EXPECT_EQ(first({1, 2, 3}), first({1, 2, 3}));
  EXPECT_NE(first({1, 2, 3}), first({1, 3, 2}));
  EXPECT_NE(first({1, 2, 3}), first({1, 2, 4}));
  EXPECT_NE(first({1, 2, 3}), first({2, 2, 3}));
  EXPECT_NE(first({1, 2}), first({1, 2, 0}));
}

TEST(RandomStream, UniformFillsItsRangeEvenly) {
  RandomStream stream(7);
  constexpr int kDraws = 100000;
  std::vector<int> bins(10, 0);
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = stream.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    ++bins[static_cast<std::size_t>(10.0 * u)];
    sum += u;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 0.004);  // four deviations of the mean
  for (const int count : bins) EXPECT_NEAR(count, kDraws / 10, 400);
}

TEST(RandomStream, UniformBetweenBoundsAndBelow) {
  RandomStream stream(8);
  std::vector<int> seen(6, 0);
  for (int i = 0; i < 1000; ++i) {
    const double u = stream.uniform(-3.0, 2.0);
    ASSERT_GE(u, -3.0);
    ASSERT_LT(u, 2.0);
    const std::uint64_t n = stream.below(6);
    ASSERT_LT(n, 6U);
    ++seen[n];
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

TEST(RandomStream, NormalHasItsMoments) {
  RandomStream stream(9);
  constexpr int kDraws = 200000;
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double n = stream.normal();
    ASSERT_TRUE(std::isfinite(n));
    sum += n;
    squares += n * n;
    fourth += n * n * n * n;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.009);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.013);
  EXPECT_NEAR(fourth / kDraws, 3.0, 0.1);
}

}  // namespace
}  // namespace tiltmap
