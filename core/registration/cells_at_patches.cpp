// In a file of its own for its compiler options, as moved_cells.cpp.
#include "core/registration/cells_at_patches.h"

#include <cmath>

#include "core/base/clones.h"
#include "core/registration/patch_raster.h"

namespace tiltmap {

namespace {

constexpr float truth(bool is) {
  return is ? 1.0F : 0.0F;
}

}  // namespace

TILTMAP_CLONES
void testCells(const PatchDisc* __restrict discs, std::size_t begin, std::size_t end, const CellRule& rule,
               CellsAtPatches& __restrict cells) {
  const CellRule r = rule;
  const float ox = r.origin[0], oy = r.origin[1], oz = r.origin[2];
  for (std::size_t i = begin; i < end; ++i) {
    const PatchDisc& disc = discs[cells.patch[i]];
    const float count_here = cells.count[i];
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
    const float gate = r.gate_square * (variance / (count_here > 0.0F ? count_here : 1.0F) + r.excess_square +
                                        disc.offset_variance);
    // Truth values are numbers here: the compiler does not put mixed widths side by side.
    cells.lies[i] = truth(u <= disc.reach_u + r.outside_m) * truth(v <= disc.reach_v + r.outside_m) *
                    truth(towards < -1e-6F) * truth(share * square <= r.most_spread_square) *
                    truth(off * off <= gate) * truth(count_here > 0.0F);
    cells.share[i] = share;
    cells.variance[i] = variance;
  }
}

TILTMAP_CLONES
void firstPainted(const std::uint32_t* __restrict raster, const std::int32_t* __restrict place,
                  std::size_t count, std::uint32_t* __restrict patch) {
  constexpr std::uint32_t kNone = PatchRaster::kNone;
  constexpr std::array<std::int32_t, 4> kAround = PatchRaster::kAround;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t at = place[i];
    const std::uint32_t here = raster[at], before = raster[at + kAround[0]], after = raster[at + kAround[1]];
    const std::uint32_t left = raster[at + kAround[2]], right = raster[at + kAround[3]];
    std::uint32_t first = left != kNone ? left : right;
    first = after != kNone ? after : first;
    first = before != kNone ? before : first;
    patch[i] = here != kNone ? here : first;
  }
}

TILTMAP_CLONES
void holdAgainst(const std::uint32_t* __restrict patch, std::size_t count, CellsAtPatches& __restrict cells) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_one = patch[i] != PatchRaster::kNone;
    cells.patch[i] = is_one ? static_cast<std::int32_t>(patch[i]) : 0;
    cells.count[i] *= truth(is_one);
  }
}

}  // namespace tiltmap
