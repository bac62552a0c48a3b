// Estimating the scanner's intrinsic errors from the project's scans, and giving them to the scans.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// "calibrate". With `apply` the scans of the same scanner get the geometry found, those that took part their
// poses as stage `relaxed`, and the project a job record "calibration" whose values are the estimates, their
// deviations and the scans: date and version are the record's own. All of it is one edit.
std::unique_ptr<Operation> makeCalibrateOperation();

}  // namespace tiltmap
