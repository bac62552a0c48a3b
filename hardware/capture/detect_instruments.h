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

struct DetectionPlaces {
  std::vector<std::string> ports;  // empty: the serial ports that are plugged in
  // "192.168.0.1" or "scanner.local:2111": a scanner may answer there. Empty: none is looked for in a
  // network, where nobody goes over addresses that were not given.
  std::string network;
};

// Asks every port at the same time: an LMS 2xx at all its rates, a Hokuyo, a MIP 50 at its usual rate, an
// EPOS at all of its; at the address in the network an LMS1xx or LMS5xx and a Hokuyo, each at its usual port
// or both at the one that is named. Nothing moves and no setting is changed, except that a MIP 50 leaves its
// text menu. Fails when either is missing, naming what was found. Looks at the stop token every 200 ms.
Result<DetectedInstruments> detectInstruments(DetectionPlaces places, const JobControl& job);

}  // namespace tiltmap
