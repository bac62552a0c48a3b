// The value at a rank among unordered ones.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace tiltmap {

// The value that `rank` others precede when they are in order. Reorders the values; rank below their number.
template <typename Value>
Value valueAtRank(std::vector<Value>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// The value that a share (0 to 1) of the others lie below, of a sample that is not empty; reorders.
template <typename Value>
Value quantileOf(std::vector<Value>& values, double share) {
  return valueAtRank(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

// Of an even number the upper one of the two in the middle. Throws std::invalid_argument where there are
// none.
template <typename Value>
Value medianOf(std::vector<Value> values) {
  if (values.empty()) throw std::invalid_argument("medianOf: no values");
  return valueAtRank(values, values.size() / 2);
}

}  // namespace tiltmap
