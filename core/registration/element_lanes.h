// Surface elements side by side, and the nearest of some with a fitting normal.
#pragma once

#include <cstddef>
#include <vector>

namespace tiltmap {

// Positions, m, and unit normals, one frame.
struct ElementLanes {
  std::vector<float> x, y, z, nx, ny, nz;
};

struct LaneQuery {
  float x = 0.0F, y = 0.0F, z = 0.0F, nx = 0.0F, ny = 0.0F, nz = 0.0F;
  float min_cos = 0.0F;  // of the angle between the normals
};

// Added to the squared distance, m^2, of elements whose normals do not fit; no two elements are so far apart.
inline constexpr float kMisfit = 1e9F;

// The squared distances of `count` elements from `begin` on, misfits told by kMisfit and more, into `keys`;
// returns the least of them, or something above 2 kMisfit where there are none.
float keysOf(const ElementLanes& lanes, std::size_t begin, std::size_t count, const LaneQuery& query,
             float* keys);

}  // namespace tiltmap
