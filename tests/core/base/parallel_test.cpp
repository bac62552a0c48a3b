#include "core/base/parallel.h"

#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

class ParallelFor : public ::testing::TestWithParam<int> {};

TEST_P(ParallelFor, VisitsEveryIndexOnce) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
    std::vector<std::atomic<int>> visits(count);
    parallelFor(count, GetParam(), [&](std::size_t i) { ++visits.at(i); });
    for (const auto& visit : visits) EXPECT_EQ(visit.load(), 1);
  }
}

TEST_P(ParallelFor, PassesAnExceptionOn) {
  EXPECT_THROW(parallelFor(100, GetParam(),
                           [](std::size_t i) {
                             if (i == 37) throw std::runtime_error("37");
                           }),
               std::runtime_error);
}

TEST_P(ParallelFor, GivesTheResultOfOneThread) {
  const auto slots = [](int threads) {
    std::vector<double> result(500);
    parallelFor(result.size(), threads, [&](std::size_t i) { result[i] = std::sin(static_cast<double>(i)); });
    return result;
  };
  EXPECT_EQ(slots(GetParam()), slots(1));
}

TEST_P(ParallelFor, MayBeNested) {
  std::vector<int> sums(8, 0);
  parallelFor(sums.size(), GetParam(), [&](std::size_t i) {
    std::vector<int> parts(50, 0);
    parallelFor(parts.size(), GetParam(), [&](std::size_t k) { parts[k] = static_cast<int>(k); });
    for (const int part : parts) sums[i] += part;
  });
  for (const int sum : sums) EXPECT_EQ(sum, 1225);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, ::testing::Values(1, 2, 4, 0));

TEST(ParallelForThreads, StaysOnTheCallersThreadWhenToldOne) {
  std::mutex mutex;
  std::set<std::thread::id> seen;
  parallelFor(100, 1, [&](std::size_t) {
    const std::lock_guard lock(mutex);
    seen.insert(std::this_thread::get_id());
  });
  EXPECT_EQ(seen, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace tiltmap
