// Which plane patch is seen in which direction from the scanner: one look-up instead of a search.
#pragma once

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
  // Gives each empty cell what a painted neighbour holds, so that beams between two tiles are no gaps.
  void closeGaps();

  // Calls visit(patch) for what lies in the direction of `p` and around it, at most nine times, never twice
  // the same in a row. `reach` in cells of 1.5 deg.
  template <class Visit>
  void around(const Eigen::Vector3d& p, int reach, Visit&& visit) const {
    int row = 0, column = 0;
    if (!place(p, row, column)) return;
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
  bool place(const Eigen::Vector3d& p, int& row, int& column) const;

  std::vector<std::uint32_t> cell_;
};

}  // namespace tiltmap
