// Which plane patch is seen in which direction from the scanner: one look-up instead of a search.
#pragma once

#include <array>
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
  void paintAt(std::int32_t index, std::uint32_t patch) {
    cell_[static_cast<std::size_t>(index)] = patch;
    if (index < (kBorder + kBorder) * kStride) cell_[static_cast<std::size_t>(index + kAllRound)] = patch;
    if (index >= kAllRound) cell_[static_cast<std::size_t>(index - kAllRound)] = patch;
  }
  // Gives each empty cell what a painted neighbour holds, so that beams between two tiles are no gaps.
  void closeGaps();

  // From an index to its four neighbours: the lines before and after, then along the line.
  static constexpr std::array<std::int32_t, 4> kAround = {-126, 126, -1, 1};

  // Where the direction of (x, y, z) lies in the raster; no place at the origin or beyond 1e9 m is asked for.
  // Without branches and tables, so that many are computed side by side.
  static std::int32_t indexOf(float x, float y, float z) {
    const float range = std::sqrt(x * x + y * y + z * z);
    const float from_axis = arcCosine(x / range);
    const auto column = static_cast<std::int32_t>(from_axis * (static_cast<float>(kColumns) / kPiF));
    const auto row = static_cast<std::int32_t>(fullTurn(y, z) * static_cast<float>(kRows));
    return ((row < kRows ? row : kRows - 1) + kBorder) * kStride +
           (column < kColumns ? column : kColumns - 1) + kBorder;
  }
  std::uint32_t at(std::int32_t index) const { return cell_[static_cast<std::size_t>(index)]; }
  // What `at` reads from. An index has the neighbours index + kAround[.], kNone where there are none.
  const std::uint32_t* data() const { return cell_.data(); }

  // Calls visit(patch) for what lies in the direction of `p` and around it, at most nine times, never twice
  // the same in a row, until it returns false. `reach` in cells of 1.5 deg, at most 3.
  template <class Visit>
  void around(const Eigen::Vector3d& p, int reach, Visit&& visit) const {
    std::int32_t index = 0;
    if (place(p, index)) aroundIndex(index, reach, visit);
  }
  template <class Visit>
  void aroundIndex(std::int32_t index, int reach, Visit&& visit) const {
    std::uint32_t last = kNone;
    const auto goOn = [&](std::int32_t at) {
      const std::uint32_t patch = cell_[static_cast<std::size_t>(at)];
      if (patch == kNone || patch == last) return true;
      last = patch;
      return static_cast<bool>(visit(patch));
    };
    if (!goOn(index)) return;
    for (int d = 1; d <= reach; d += 2)
      for (const std::int32_t neighbour : kAround)
        if (!goOn(index + d * neighbour)) return;
  }

 private:
  static constexpr int kRows = 240;     // about the x axis, 1.5 deg each, all round
  static constexpr int kColumns = 120;  // from the x axis, 1.5 deg each
  // Cells around it, so that neighbours need no special case: beyond the last rows the first ones again,
  // beside the columns nothing.
  static constexpr int kBorder = 3;
  static constexpr int kStride = kColumns + 2 * kBorder;
  static constexpr int kAllRound = kRows * kStride;
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

  static_assert(kAround[1] == kStride && kAround[0] == -kStride);

  std::vector<std::uint32_t> cell_;
};

}  // namespace tiltmap
