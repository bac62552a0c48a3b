// A plane patch as a disc.
#pragma once

namespace tiltmap {

// A patch in the form that is looked at most often, one a cache line. Scan frame, m; see PatchShape.
struct alignas(64) PatchDisc {
  float x = 0.0F, y = 0.0F, z = 0.0F, nx = 0.0F, ny = 0.0F, nz = 0.0F;
  float ux = 0.0F, uy = 0.0F, uz = 0.0F, vx = 0.0F, vy = 0.0F, vz = 0.0F;
  float reach_u = 0.0F, reach_v = 0.0F;  // from the centre to the edge
  float offset_variance = 0.0F;          // m^2
};

}  // namespace tiltmap
