#include "core/registration/patch_raster.h"

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
  const std::vector<std::uint32_t> painted = cell_;
  const auto fill = [&](int row, int column) {
    const auto at = [&](int r, int k) {
      if (k < 0 || k >= kColumns) return kNone;
      return painted[static_cast<std::size_t>((r + kRows) % kRows * kColumns + k)];
    };
    for (const std::uint32_t near :
         {at(row - 1, column), at(row + 1, column), at(row, column - 1), at(row, column + 1)})
      if (near != kNone) return near;
    return kNone;
  };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const auto here = static_cast<std::size_t>(row * kColumns + column);
      if (painted[here] == kNone) cell_[here] = fill(row, column);
    }
}

}  // namespace tiltmap
