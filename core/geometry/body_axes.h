// Poses of a vehicle as others write them, and the step between two stops as we do.
#pragma once

#include "core/geometry/pose.h"

namespace tiltmap {

// Which way the axes of the moving body point.
enum class BodyAxes {
  ForwardLeftUp,   // x forward, y left, z up: ROS (REP 103) and most robots
  RightForwardUp,  // x right, y forward, z up: ours, as Tiltmap's own TUM files have it
};

// scan_from_body, for a scanner that stands at the body's origin and looks forward.
Pose scanFromBody(BodyAxes axes);

// The step between two stops, last_from_next in the scan frame: X (world_from_last^-1 world_from_next) X^-1
// with X = scan_from_body. The frame of the world cancels: it may have any origin and any axes. A scanner
// that does not stand at the body's origin is told by the translation of scan_from_body; without it a turn on
// the spot would be taken to leave the scanner where it was.
Pose stepBetween(const Pose& world_from_last, const Pose& world_from_next, const Pose& scan_from_body);

}  // namespace tiltmap
