// A recorded session as the source of a capture.
#pragma once

#include <filesystem>

#include "hardware/capture/capture_plan.h"

namespace tiltmap {

// Instruments and options as they were recorded, behind "replay:FILE". Fails for what is no recording, and
// for recordings of other instruments than a scanner and a tilt unit.
Result<CaptureSettings> replayedSource(const std::filesystem::path& scanner,
                                       const std::filesystem::path& tilt);

}  // namespace tiltmap
