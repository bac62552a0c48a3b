// Which scanner and which tilt unit are plugged in, found by asking.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace tiltmap {

struct DetectedInstruments {
  std::string scanner, tilt;  // as URLs: "lms2xx:/dev/ttyUSB0", "mip50:/dev/ttyUSB1"
};

// Asks every port at the same time: an LMS 2xx at all its rates, a Hokuyo, a MIP 50 at its usual rate, an
// EPOS at all of its. Nothing moves and no setting is changed, except that a MIP 50 leaves its text menu.
// Empty: the ports that are plugged in. Instruments in a network are not looked for. Fails when either is
// missing, naming what was found. Looks at the stop token every 50 ms.
Result<DetectedInstruments> detectInstruments(std::vector<std::string> ports, const JobControl& job);

}  // namespace tiltmap
