// Which plane patch is seen in which direction from the scanner: one look-up instead of a search.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace tiltmap {

// A raster over the sphere of directions, in the angles of a tilted scanner: from the x axis, and about it.
// Its poles lie on the x axis, where all lines of such a scanner meet. Works for any scanner's matrix.
class PatchRaster {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  PatchRaster();

  // `patch` is seen in the direction of `p` (scan frame). The last one painted stays.
  void paint(const Eigen::Vector3d& p, std::uint32_t patch);
  void paintAt(std::int32_t index, std::uint32_t patch) { cell_[static_cast<std::size_t>(index)] = patch; }
  // Gives each empty cell what a painted neighbour holds, so that beams between two tiles are no gaps.
  void closeGaps();

  // Where the direction of (x, y, z) lies in the raster; no place at the origin or beyond 1e9 m is asked for.
  // Without branches and tables, so that many are computed side by side.
  static std::int32_t indexOf(float x, float y, float z) {
    const float range = std::sqrt(x * x + y * y + z * z);
    const float from_axis = arcCosine(x / range);
    const auto column = static_cast<std::int32_t>(from_axis * (static_cast<float>(kColumns) / kPiF));
    const auto row = static_cast<std::int32_t>(fullTurn(y, z) * static_cast<float>(kRows));
    return (row < kRows ? row : kRows - 1) * kColumns + (column < kColumns ? column : kColumns - 1);
  }
  std::uint32_t at(std::int32_t index) const { return cell_[static_cast<std::size_t>(index)]; }

  // Calls visit(patch) for what lies in the direction of `p` and around it, at most nine times, never twice
  // the same in a row, until it returns false. `reach` in cells of 1.5 deg.
  template <class Visit>
  void around(const Eigen::Vector3d& p, int reach, Visit&& visit) const {
    std::int32_t index = 0;
    if (place(p, index)) aroundIndex(index, reach, visit);
  }
  template <class Visit>
  void aroundIndex(std::int32_t index, int reach, Visit&& visit) const {
    const int row = index / kColumns, column = index - row * kColumns;
    std::uint32_t last = kNone;
    const auto goOn = [&](int r, int c) {
      if (c < 0 || c >= kColumns) return true;
      r = r < 0 ? r + kRows : (r >= kRows ? r - kRows : r);
      const std::uint32_t patch = cell_[static_cast<std::size_t>(r * kColumns + c)];
      if (patch == kNone || patch == last) return true;
      last = patch;
      return static_cast<bool>(visit(patch));
    };
    if (!goOn(row, column)) return;
    for (int d = 1; d <= reach; d += 2)
      if (!goOn(row - d, column) || !goOn(row + d, column) || !goOn(row, column - d) ||
          !goOn(row, column + d))
        return;
  }

 private:
  static constexpr int kRows = 240;     // about the x axis, 1.5 deg each, all round
  static constexpr int kColumns = 120;  // from the x axis, 1.5 deg each
  static constexpr float kPiF = 3.14159265F;

  // Abramowitz and Stegun 4.4.45 (within 7e-5 rad).
  static float arcCosine(float u) {
    const float a = std::abs(u);
    const float in = 1.0F - a;
    const float root = std::sqrt(in > 0.0F ? in : 0.0F);
    const float angle = root * (1.5707288F + a * (-0.2121144F + a * (0.0742610F - 0.0187293F * a)));
    return u >= 0.0F ? angle : kPiF - angle;
  }
  // The angle of (y, z) from y towards z as a share of the full turn, 0 to 1. Abramowitz and Stegun 4.4.49
  // (within 1e-5 rad).
  static float fullTurn(float y, float z) {
    const float ay = std::abs(y), az = std::abs(z);
    const float large = ay > az ? ay : az, small = ay > az ? az : ay;
    const float t = small / (large > 0.0F ? large : 1.0F), t2 = t * t;
    float angle =
        t * (0.9998660F + t2 * (-0.3302995F + t2 * (0.1801410F + t2 * (-0.0851330F + t2 * 0.0208351F))));
    angle = ay >= az ? angle : 0.5F * kPiF - angle;
    angle = y >= 0.0F ? angle : kPiF - angle;
    angle = z >= 0.0F ? angle : 2.0F * kPiF - angle;
    const float turn = angle * (0.5F / kPiF);
    return turn < 1.0F ? turn : 0.0F;
  }
  static bool place(const Eigen::Vector3d& p, std::int32_t& index);

  std::vector<std::uint32_t> cell_;
};

}  // namespace tiltmap
