// The space a scan has looked through, by direction from its scanner: how far its beams went. A surface of
// another scan that lies in the middle of it cannot be where the other scan's pose puts it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/scan/range_image.h"

namespace tiltmap {

// Where a point lies as one scan sees it.
enum class SeenPlace {
  Unknown,  // no beam with a return went there
  Through,  // all beams about its direction went further: they passed where the point is said to be
  Near,     // between the nearest and the furthest return about its direction
  Behind,   // hidden by something nearer
};

// A raster of nearest and furthest returns over the directions, in the angles of a tilted scanner (from the x
// axis, and about it), cells of 1.5 deg. Works for any scanner's matrix and for unordered clouds. Beams
// without a return say nothing here: they may have been swallowed. Immutable.
class SeenSpace {
 public:
  explicit SeenSpace(const Scan& scan);

  // `p` in the scan frame, m. About its direction: the cell it falls into and the eight around it, so that
  // the edge of a thing is not taken for free space. `margin_m` is how much nearer or further is not yet
  // apart.
  SeenPlace placeOf(const Eigen::Vector3d& p, double margin_m) const;

 private:
  static constexpr int kRows = 240;     // about the x axis, all round
  static constexpr int kColumns = 120;  // from the x axis
  static void cellOf(const Eigen::Vector3d& p, int& row, int& column);

  struct Returns {
    float nearest_m = 0.0F, furthest_m = 0.0F;  // 0: none
  };
  std::vector<Returns> cell_;
};

}  // namespace tiltmap
