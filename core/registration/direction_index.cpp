#include "core/registration/direction_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace tiltmap {

namespace {

constexpr double kPi = std::numbers::pi;

// What does not depend on the buckets, of which there are many sets.
template <int kTable>
struct Angles {
  std::array<double, kTable + 1> elevation;  // over z / r, as a share of half a turn
  std::array<float, kTable + 2> turn;        // over y / (|x| + |y|) of the first quadrant

  Angles() {
    for (std::size_t i = 0; i < elevation.size(); ++i) {
      const double height = -1.0 + 2.0 * (static_cast<double>(i) + 0.5) / kTable;
      elevation[i] = (std::asin(std::clamp(height, -1.0, 1.0)) + 0.5 * kPi) / kPi;
    }
    for (std::size_t i = 0; i < turn.size(); ++i) {
      const double t = std::min(1.0, (static_cast<double>(i) + 0.5) / kTable);  // y / (x + y)
      turn[i] = static_cast<float>(std::atan2(t, 1.0 - t) / (2.0 * kPi));
    }
  }
};

}  // namespace

DirectionIndex::DirectionIndex(std::span<const Eigen::Vector3d> positions, double bucket_rad,
                               std::span<const Eigen::Vector3d> normals) {
  static const Angles<kTable> angles;
  constexpr double pi = kPi;
  rows_ = std::max(3, static_cast<int>(std::ceil(pi / bucket_rad)));
  for (std::size_t i = 0; i < row_of_height_.size(); ++i)
    row_of_height_[i] =
        static_cast<std::uint16_t>(std::clamp(static_cast<int>(angles.elevation[i] * rows_), 0, rows_ - 1));
  turn_of_diamond_ = angles.turn;
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
  if (normals.empty()) return;
  for (std::vector<float>* lane : {&lanes_.x, &lanes_.y, &lanes_.z, &lanes_.nx, &lanes_.ny, &lanes_.nz})
    lane->resize(items_.size());
  for (std::size_t k = 0; k < items_.size(); ++k) {
    const Eigen::Vector3f p = positions[items_[k]].cast<float>(), n = normals[items_[k]].cast<float>();
    lanes_.x[k] = p.x(), lanes_.y[k] = p.y(), lanes_.z[k] = p.z();
    lanes_.nx[k] = n.x(), lanes_.ny[k] = n.y(), lanes_.nz[k] = n.z();
  }
}

std::uint32_t DirectionIndex::nearestFitting(const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
                                             double min_cos) const {
  if (lanes_.x.size() != items_.size())
    throw std::logic_error("DirectionIndex::nearestFitting: it was made without normals");
  constexpr std::size_t kMost = 256;
  std::array<float, kMost> keys;
  const Eigen::Vector3f at = p.cast<float>(), n = normal.cast<float>();
  const LaneQuery query{at.x(), at.y(), at.z(), n.x(), n.y(), n.z(), static_cast<float>(min_cos)};
  float least = 2.0F * kMisfit;
  std::uint32_t best = kNobody;
  around(p, [&](const std::uint32_t* first, const std::uint32_t* last) {
    const auto end = static_cast<std::size_t>(last - items_.data());
    for (auto begin = static_cast<std::size_t>(first - items_.data()); begin < end; begin += kMost) {
      const std::size_t count = std::min(kMost, end - begin);
      const float here = keysOf(lanes_, begin, count, query, keys.data());
      if (!(here < least)) continue;
      least = here;
      best =
          items_[begin + static_cast<std::size_t>(std::find(keys.begin(), keys.end(), here) - keys.begin())];
    }
  });
  return best;
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
