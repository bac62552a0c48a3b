#include "core/registration/patch_raster.h"

#include <algorithm>

namespace tiltmap {

PatchRaster::PatchRaster() : cell_(static_cast<std::size_t>(kRows) * kColumns, kNone) {}

bool PatchRaster::place(const Eigen::Vector3d& p, std::int32_t& index) {
  const double square = p.squaredNorm();
  if (!(square > 1e-18) || !(square < 1e18)) return false;
  index = indexOf(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  return true;
}

void PatchRaster::paint(const Eigen::Vector3d& p, std::uint32_t patch) {
  std::int32_t index = 0;
  if (place(p, index)) cell_[static_cast<std::size_t>(index)] = patch;
}

void PatchRaster::closeGaps() {
  // A copy with a border of empty cells at both ends of a row; rows go all round.
  constexpr std::size_t kColumnsWithBorder = static_cast<std::size_t>(kColumns) + 2;
  static thread_local std::vector<std::uint32_t> copy;  // fresh memory costs more than what is done there
  copy.assign(kColumnsWithBorder * (static_cast<std::size_t>(kRows) + 2), kNone);
  const auto rowOf = [&](int row) {
    return copy.data() + static_cast<std::size_t>(row + 1) * kColumnsWithBorder;
  };
  for (int row = -1; row <= kRows; ++row)
    std::copy_n(cell_.begin() + static_cast<std::ptrdiff_t>((row + kRows) % kRows * kColumns), kColumns,
                rowOf(row) + 1);
  for (int row = 0; row < kRows; ++row) {
    const std::uint32_t *above = rowOf(row - 1) + 1, *here = rowOf(row) + 1, *under = rowOf(row + 1) + 1;
    std::uint32_t* out = cell_.data() + static_cast<std::size_t>(row) * kColumns;
    for (std::ptrdiff_t k = 0; k < kColumns; ++k) {
      // The first that is painted of these; without branches.
      std::uint32_t patch = here[k + 1];
      patch = here[k - 1] != kNone ? here[k - 1] : patch;
      patch = under[k] != kNone ? under[k] : patch;
      patch = above[k] != kNone ? above[k] : patch;
      out[k] = here[k] != kNone ? here[k] : patch;
    }
  }
}

}  // namespace tiltmap
