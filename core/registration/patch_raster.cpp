#include "core/registration/patch_raster.h"

#include <algorithm>

namespace tiltmap {

PatchRaster::PatchRaster() : cell_(static_cast<std::size_t>(kRows + 2 * kBorder) * kStride, kNone) {}

bool PatchRaster::place(const Eigen::Vector3d& p, std::int32_t& index) {
  const double square = p.squaredNorm();
  if (!(square > 1e-18) || !(square < 1e18)) return false;
  index = indexOf(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  return true;
}

void PatchRaster::paint(const Eigen::Vector3d& p, std::uint32_t patch) {
  std::int32_t index = 0;
  if (place(p, index)) paintAt(index, patch);
}

void PatchRaster::closeGaps() {
  static thread_local std::vector<std::uint32_t> copy;  // fresh memory costs more than what is done there
  copy = cell_;
  for (int row = kBorder; row < kRows + kBorder; ++row) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * kStride + kBorder;
    const std::uint32_t *here = copy.data() + first, *above = here - kStride, *under = here + kStride;
    std::uint32_t* out = cell_.data() + first;
    for (std::ptrdiff_t k = 0; k < kColumns; ++k) {
      // The first that is painted of these; without branches.
      std::uint32_t patch = here[k + 1];
      patch = here[k - 1] != kNone ? here[k - 1] : patch;
      patch = under[k] != kNone ? under[k] : patch;
      patch = above[k] != kNone ? above[k] : patch;
      out[k] = here[k] != kNone ? here[k] : patch;
    }
  }
  const auto begin = cell_.begin();
  constexpr std::ptrdiff_t kBorders = static_cast<std::ptrdiff_t>(kBorder) * kStride;
  std::copy_n(begin + kAllRound, kBorders, begin);
  std::copy_n(begin + kBorders, kBorders, begin + kAllRound + kBorders);
}

}  // namespace tiltmap
