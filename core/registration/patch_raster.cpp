#include "core/registration/patch_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tiltmap {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kTableSize = 2048;

// Angles without trigonometry: over the cosine from the x axis, and over z / (|y| + |z|) in a quadrant.
struct AngleTables {
  std::array<float, kTableSize + 2> from_axis{};  // 0 to 1 for 0 to pi, over (x / r + 1) / 2
  std::array<float, kTableSize + 2> quadrant{};   // 0 to 1/4 turn

  AngleTables() {
    for (int i = 0; i < kTableSize + 2; ++i) {
      const double t = std::min(1.0, (i + 0.5) / kTableSize);
      from_axis[static_cast<std::size_t>(i)] =
          static_cast<float>(std::acos(std::clamp(2.0 * t - 1.0, -1.0, 1.0)) / kPi);
      quadrant[static_cast<std::size_t>(i)] = static_cast<float>(std::atan2(t, 1.0 - t) / (2.0 * kPi));
    }
  }
};

const AngleTables& tables() {
  static const AngleTables made;
  return made;
}

}  // namespace

PatchRaster::PatchRaster() : cell_(static_cast<std::size_t>(kRows) * kColumns, kNone) {}

bool PatchRaster::place(const Eigen::Vector3d& p, int& row, int& column) const {
  const double range = p.norm();
  if (!(range > 1e-9) || !(range < 1e9)) return false;
  static const AngleTables& t = tables();
  column =
      static_cast<int>(t.from_axis[static_cast<std::size_t>((p.x() / range + 1.0) * (0.5 * kTableSize))] *
                       static_cast<float>(kColumns));
  column = std::min(column, kColumns - 1);
  const double ay = std::abs(p.y()), az = std::abs(p.z()), sum = ay + az;
  float turn = 0.0F;
  if (sum > 0.0) {
    const float quarter = t.quadrant[static_cast<std::size_t>(az / sum * kTableSize)];
    if (p.y() >= 0.0)
      turn = p.z() >= 0.0 ? quarter : 1.0F - quarter;
    else
      turn = p.z() >= 0.0 ? 0.5F - quarter : 0.5F + quarter;
  }
  row = std::min(static_cast<int>(turn * static_cast<float>(kRows)), kRows - 1);
  return true;
}

void PatchRaster::paint(const Eigen::Vector3d& p, std::uint32_t patch) {
  int row = 0, column = 0;
  if (place(p, row, column)) cell_[static_cast<std::size_t>(row * kColumns + column)] = patch;
}

void PatchRaster::closeGaps() {
  const std::vector<std::uint32_t> painted = cell_;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      std::uint32_t& here = cell_[static_cast<std::size_t>(row * kColumns + column)];
      if (here != kNone) continue;
      const auto at = [&](int r, int c) {
        if (c < 0 || c >= kColumns) return kNone;
        return painted[static_cast<std::size_t>((r + kRows) % kRows * kColumns + c)];
      };
      for (const std::uint32_t near :
           {at(row - 1, column), at(row + 1, column), at(row, column - 1), at(row, column + 1)})
        if (near != kNone) {
          here = near;
          break;
        }
    }
}

}  // namespace tiltmap
