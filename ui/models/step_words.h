// A step between two stops in words.
#pragma once

#include <QString>

#include "core/geometry/pose.h"

namespace tiltmap::ui {

// How far a heading has turned about the vertical, radians, left positive.
double headingChange(const Pose& last_from_next);
// "2.00 m forward, 0.30 m to the right, turned 15° to the left", "did not move". Below half a centimetre and
// half a tenth of a degree nothing is said; tilting is told from half a degree.
QString stepInWords(const Pose& last_from_next);

}  // namespace tiltmap::ui
