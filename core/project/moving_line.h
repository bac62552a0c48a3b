// Lines that were measured while the tilt moved on (core/scan/beam_tilts.h), as a project takes them.
#pragma once

#include "core/project/project.h"

namespace tiltmap {

// How far the tilt moved in a turn of the mirror, radians; line.tilt_rad is that of the line's end. It stands
// behind the ranges, which are then one more than the line has cells: to seven digits, a ten-thousandth of an
// encoder's count. Call it once, after the ranges.
inline void setTurnTilt(ScanLine& line, double turn_tilt_rad) {
  if (turn_tilt_rad != 0.0) line.range_m.push_back(static_cast<float>(turn_tilt_rad));
}
// 0: the tilt stood.
inline double turnTiltOf(const ScanLine& line) {
  return line.range_m.size() == line.code.size() + 1 ? static_cast<double>(line.range_m.back()) : 0.0;
}

}  // namespace tiltmap
