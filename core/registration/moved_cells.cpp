// Two loops, in a file of their own for its compiler options: cells side by side, the same bits from every
// instruction set.
#include "core/registration/moved_cells.h"

#include "core/base/clones.h"
#include "core/registration/patch_raster.h"

namespace tiltmap {

FloatPose::FloatPose(const Pose& pose) {
  const Eigen::Matrix3d r = pose.rotation();
  const Eigen::Vector3d t = pose.translation();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      m[static_cast<std::size_t>(3 * row + column)] = static_cast<float>(r(row, column));
    m[static_cast<std::size_t>(9 + row)] = static_cast<float>(t[row]);
  }
}

TILTMAP_CLONES
void moveCells(const CellSamples& cells, std::size_t begin, std::size_t count, const FloatPose& pose,
               MovedCells& out) {
  const std::array<float, 12> m = pose.m;
  const float* x = cells.x.data() + begin;
  const float* y = cells.y.data() + begin;
  const float* z = cells.z.data() + begin;
  for (std::size_t i = 0; i < count; ++i) {
    const float px = m[0] * x[i] + m[1] * y[i] + m[2] * z[i] + m[9];
    const float py = m[3] * x[i] + m[4] * y[i] + m[5] * z[i] + m[10];
    const float pz = m[6] * x[i] + m[7] * y[i] + m[8] * z[i] + m[11];
    out.x[i] = px, out.y[i] = py, out.z[i] = pz;
    out.place[i] = PatchRaster::indexOf(px, py, pz);
  }
}

TILTMAP_CLONES
void movePatches(std::size_t count, const FloatPose& pose, MovedPatches& patches) {
  const std::array<float, 12> m = pose.m;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = patches.x[i], y = patches.y[i], z = patches.z[i];
    const float px = m[0] * x + m[1] * y + m[2] * z + m[9];
    const float py = m[3] * x + m[4] * y + m[5] * z + m[10];
    const float pz = m[6] * x + m[7] * y + m[8] * z + m[11];
    patches.x[i] = px, patches.y[i] = py, patches.z[i] = pz;
    patches.place[i] = PatchRaster::indexOf(px, py, pz);
    const float nx = patches.nx[i], ny = patches.ny[i], nz = patches.nz[i];
    patches.nx[i] = m[0] * nx + m[1] * ny + m[2] * nz;
    patches.ny[i] = m[3] * nx + m[4] * ny + m[5] * nz;
    patches.nz[i] = m[6] * nx + m[7] * ny + m[8] * nz;
  }
}

}  // namespace tiltmap
