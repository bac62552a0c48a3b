// A stop captured with the instruments that a station keeps open, as an operation of the open project.
#pragma once

#include <memory>
#include <optional>

#include "core/project/operation.h"
#include "hardware/capture/capture_station.h"

namespace tiltmap {

// The same operation as makeCaptureOperation() gives, with the same parameters and the same storing; it does
// not open instruments. Those that name the source are the station's. `last_from_next`: in place of the
// parameter `odometry`, with all six degrees of freedom.
std::unique_ptr<Operation> makeStationCapture(std::shared_ptr<CaptureStation> station,
                                              std::optional<Pose> last_from_next = {});

}  // namespace tiltmap
