// In a file of its own for its compiler options, as moved_cells.cpp.
#include "core/registration/element_lanes.h"

#include "core/base/clones.h"

namespace tiltmap {

TILTMAP_CLONES
float keysOf(const ElementLanes& lanes, std::size_t begin, std::size_t count, const LaneQuery& query,
             float* __restrict keys) {
  const float *x = lanes.x.data() + begin, *y = lanes.y.data() + begin, *z = lanes.z.data() + begin;
  const float *nx = lanes.nx.data() + begin, *ny = lanes.ny.data() + begin, *nz = lanes.nz.data() + begin;
  const LaneQuery q = query;
  float least = 3.0F * kMisfit;
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - q.x, dy = y[i] - q.y, dz = z[i] - q.z;
    const float cosine = nx[i] * q.nx + ny[i] * q.ny + nz[i] * q.nz;
    const float square = dx * dx + dy * dy + dz * dz;
    const float key = square + (cosine < q.min_cos ? kMisfit : 0.0F);
    keys[i] = key;
    least = key < least ? key : least;
  }
  return least;
}

}  // namespace tiltmap
