#include "core/registration/direction_index.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tiltmap {

DirectionIndex::DirectionIndex(std::span<const Eigen::Vector3d> positions, double bucket_rad) {
  constexpr double pi = std::numbers::pi;
  rows_ = std::max(3, static_cast<int>(std::ceil(pi / bucket_rad)));
  for (int i = 0; i <= kTable; ++i) {
    const double height = -1.0 + 2.0 * (i + 0.5) / kTable;
    const double elevation = std::asin(std::clamp(height, -1.0, 1.0)) + 0.5 * pi;
    row_of_height_[static_cast<std::size_t>(i)] =
        static_cast<std::uint16_t>(std::clamp(static_cast<int>(elevation / pi * rows_), 0, rows_ - 1));
  }
  for (int i = 0; i < kTable + 2; ++i) {
    const double t = std::min(1.0, (i + 0.5) / kTable);  // y / (x + y) of the first quadrant
    turn_of_diamond_[static_cast<std::size_t>(i)] = static_cast<float>(std::atan2(t, 1.0 - t) / (2.0 * pi));
  }
  row_start_.assign(static_cast<std::size_t>(rows_) + 1, 0);
  for (int row = 0; row < rows_; ++row) {
    const double elevation = (row + 0.5) * pi / rows_ - 0.5 * pi;
    const int count = std::max(1, static_cast<int>(std::ceil(2.0 * pi * std::cos(elevation) / bucket_rad)));
    row_start_[static_cast<std::size_t>(row) + 1] = row_start_[static_cast<std::size_t>(row)] + count;
  }
  // Counting sort of the elements into buckets; within one in the order of their indices.
  constexpr std::uint32_t kNowhere = 0xffffffffU;
  std::vector<std::uint32_t> bucket(positions.size(), kNowhere);
  bucket_start_.assign(static_cast<std::size_t>(row_start_.back()) + 1, 0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    int row = 0;
    float turn = 0.0F;
    if (!place(positions[i], row, turn)) continue;
    const int begin = row_start_[static_cast<std::size_t>(row)];
    const int count = row_start_[static_cast<std::size_t>(row) + 1] - begin;
    bucket[i] = static_cast<std::uint32_t>(begin + bucketInRow(turn, count));
    ++bucket_start_[bucket[i] + 1];
  }
  for (std::size_t b = 1; b < bucket_start_.size(); ++b) bucket_start_[b] += bucket_start_[b - 1];
  items_.resize(bucket_start_.back());
  std::vector<std::uint32_t> next(bucket_start_.begin(), bucket_start_.end() - 1);
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (bucket[i] != kNowhere) items_[next[bucket[i]]++] = static_cast<std::uint32_t>(i);
}

bool DirectionIndex::place(const Eigen::Vector3d& p, int& row, float& turn) const {
  const double range = p.norm();
  if (!(range > 1e-9) || !(range < 1e9)) return false;
  const double height = p.z() / range;
  row = row_of_height_[static_cast<std::size_t>((height + 1.0) * (0.5 * kTable))];
  const double ax = std::abs(p.x()), ay = std::abs(p.y());
  const double sum = ax + ay;
  if (!(sum > 0.0)) {
    turn = 0.0F;
    return true;
  }
  const float quarter = turn_of_diamond_[static_cast<std::size_t>(ay / sum * kTable)];
  if (p.x() >= 0.0)
    turn = p.y() >= 0.0 ? quarter : 1.0F - quarter;
  else
    turn = p.y() >= 0.0 ? 0.5F - quarter : 0.5F + quarter;
  return true;
}

}  // namespace tiltmap
