// Elements by the direction they are seen in from the scanner: buckets of about equal solid angle, looked up
// without trigonometry.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/registration/element_lanes.h"

namespace tiltmap {

// Rows of equal elevation, each cut into buckets of about the same width. Immutable.
class DirectionIndex {
 public:
  // Positions in the frame of the scanner, metres; one at the origin is in no bucket. With normals, one a
  // position, for nearestFitting.
  DirectionIndex(std::span<const Eigen::Vector3d> positions, double bucket_rad,
                 std::span<const Eigen::Vector3d> normals = {});

  static constexpr std::uint32_t kNobody = 0xffffffffU;
  // Of the elements around the direction of `p`, the nearest whose normal makes an angle of at least the
  // cosine with `normal`; where none does, the nearest; kNobody where there are none. Throws std::logic_error
  // where it was made without normals.
  std::uint32_t nearestFitting(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double min_cos) const;

  // Calls visit(first, last), pointers to element indices, for the up to nine buckets around the direction of
  // `p`.
  template <class Visit>
  void around(const Eigen::Vector3d& p, Visit&& visit) const {
    float turn = 0.0F;
    int row = 0;
    if (!place(p, row, turn)) return;
    const int low = row > 0 ? row - 1 : 0;
    const int high = row + 1 < rows_ ? row + 1 : rows_ - 1;
    for (int r = low; r <= high; ++r) {
      const int begin = row_start_[static_cast<std::size_t>(r)];
      const int count = row_start_[static_cast<std::size_t>(r) + 1] - begin;
      const int middle = bucketInRow(turn, count);
      if (count <= kPolarRow) {
        visitRange(begin, begin + count, visit);
      } else if (middle == 0) {
        visitRange(begin, begin + 2, visit);
        visitRange(begin + count - 1, begin + count, visit);
      } else if (middle == count - 1) {
        visitRange(begin + count - 2, begin + count, visit);
        visitRange(begin, begin + 1, visit);
      } else {
        visitRange(begin + middle - 1, begin + middle + 2, visit);
      }
    }
  }

 private:
  static constexpr int kTable = 2048;
  static constexpr int kPolarRow =
      16;  // rows this short lie so near a pole that one bucket to each side is too little
  bool place(const Eigen::Vector3d& p, int& row, float& turn) const;
  static int bucketInRow(float turn, int count) {
    const int bucket = static_cast<int>(turn * static_cast<float>(count));
    return bucket < count ? bucket : count - 1;
  }
  template <class Visit>
  void visitRange(int first_bucket, int last_bucket, Visit& visit) const {
    const std::uint32_t* data = items_.data();
    const std::uint32_t first = bucket_start_[static_cast<std::size_t>(first_bucket)];
    const std::uint32_t last = bucket_start_[static_cast<std::size_t>(last_bucket)];
    if (first != last) visit(data + first, data + last);
  }

  int rows_ = 0;
  std::array<std::uint16_t, kTable + 1> row_of_height_{};  // over z / r
  std::array<float, kTable + 2> turn_of_diamond_{};  // over y / (|x| + |y|) of the first quadrant, in turns
  std::vector<int> row_start_;                       // buckets before each row
  std::vector<std::uint32_t> bucket_start_;          // items before each bucket
  std::vector<std::uint32_t> items_;
  ElementLanes lanes_;  // of the items, where there are normals
};

}  // namespace tiltmap
