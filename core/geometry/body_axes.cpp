#include "core/geometry/body_axes.h"

namespace tiltmap {

Pose scanFromBody(BodyAxes axes) {
  if (axes == BodyAxes::RightForwardUp) return {};
  // Its forward (1,0,0) is our (0,1,0), its left (0,1,0) our (-1,0,0): a quarter turn to the left.
  return Pose::planar(0.0, 0.0, 90.0 * kDegree);
}

Pose stepBetween(const Pose& world_from_last, const Pose& world_from_next, const Pose& scan_from_body) {
  return scan_from_body * world_from_last.inverse() * world_from_next * scan_from_body.inverse();
}

}  // namespace tiltmap
