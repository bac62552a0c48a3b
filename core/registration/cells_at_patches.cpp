// In a file of its own for its compiler options, as moved_cells.cpp.
#include "core/registration/cells_at_patches.h"

#include <cmath>

#include "core/base/clones.h"

namespace tiltmap {

TILTMAP_CLONES
void testCells(const PatchDisc* __restrict discs, std::size_t count, const CellRule& rule,
               CellsAtPatches& cells) {
  const CellRule r = rule;
  const float ox = r.origin[0], oy = r.origin[1], oz = r.origin[2];
  for (std::size_t i = 0; i < count; ++i) {
    const PatchDisc& disc = discs[cells.patch[i]];
    const float x = cells.x[i], y = cells.y[i], z = cells.z[i];
    const float dx = x - disc.x, dy = y - disc.y, dz = z - disc.z;
    const float across = dx * disc.nx + dy * disc.ny + dz * disc.nz;
    const float u = std::abs(dx * disc.ux + dy * disc.uy + dz * disc.uz);
    const float v = std::abs(dx * disc.vx + dy * disc.vy + dz * disc.vz);
    const float rx = x - ox, ry = y - oy, rz = z - oz;
    const float square = rx * rx + ry * ry + rz * rz;
    const float towards = rx * disc.nx + ry * disc.ny + rz * disc.nz;
    // Bounded where no ray is, or none that meets the surface.
    const float front = towards < -1e-6F ? towards : -1e-6F;
    const float cos_square = front * front / (square > 1e-9F ? square : 1e-9F);
    const float variance = r.noise_square * cos_square + r.floor_square;
    const float share = r.spot_square * (1.0F - cos_square) / cos_square;
    const float off = across + share * front;
    const float gate = r.gate_square * (variance / cells.count[i] + r.excess_square + disc.offset_variance);
    const bool inside = (u <= disc.reach_u + r.outside_m) & (v <= disc.reach_v + r.outside_m);
    const bool lies = inside & (towards < -1e-6F) & (off * off <= gate);
    cells.lies[i] = lies ? 1.0F : 0.0F;
    cells.share[i] = share;
    cells.variance[i] = variance;
  }
}

}  // namespace tiltmap
