// What a capture is asked for, and what is to be done about it in a project that may hold an interrupted one.
#pragma once

#include <string>

#include "core/base/parameter.h"
#include "core/geometry/body_axes.h"
#include "core/project/project_snapshot.h"
#include "core/world/experiment.h"
#include "hardware/tilt/manual_unit.h"

namespace tiltmap {

inline constexpr const char* kCaptureId = "capture";

enum class CaptureDrive { None, Exp1, Exp2, Exp2Fixed, Loop, Survey };

enum class CaptureMode { Stop, Continuous };

struct CaptureSettings {
  std::string scanner, tilt;
  CaptureDrive emulate = CaptureDrive::None;
  int seed = 1;
  double speed = 1.0;
  CaptureMode mode = CaptureMode::Stop;
  int baud = 38400;
  int lines = 101;
  double step_rad = 0.8 * kDegree;
  double start_rad = -30.0 * kDegree;
  int stops = 0;
  std::string odometry;
  std::string odometry_from;  // TUM file or feed, in place of steps (hardware/capture/stop_odometry.h)
  BodyAxes odometry_axes = BodyAxes::ForwardLeftUp;
  bool resume = false;
  double patience_s = 60.0;
  bool known_rig = true;  // hardware/capture/known_rig.h
};

ExperimentId experimentOf(CaptureDrive drive);
const ParameterTable<CaptureSettings>& captureTable();

// What is to be done, once settings of an earlier capture have been looked up.
struct CapturePlan {
  CaptureSettings settings;
  const ScanEntry* unfinished = nullptr;  // of the snapshot
  int stops = 1;                          // with the unfinished one
  int first_stop = 0;                     // of an emulated drive
  int drive_stops = 0;                    // of a whole emulated drive taken stop by stop; else 0
};

// Fails where nothing can be gone on with, and where an emulated drive would meet scans of another world.
Result<CapturePlan> planCapture(const ProjectSnapshot& snapshot, const CaptureSettings& settings);
// One stop, for who keeps instruments open: the next one of an emulated drive whose stops before it the
// project has; with `resume` the one that was interrupted, with its own angles and mode and the instruments
// given here.
Result<CapturePlan> planNextStop(const ProjectSnapshot& snapshot, const CaptureSettings& settings);
// What scans of an emulated drive say they come from.
std::string emulatedSource(CaptureDrive drive, int seed);
// Whether the words of it make sense together; `ask` as for makeCaptureOperation(). Opens nothing.
Status checkCapture(const ProjectSnapshot& snapshot, const CaptureSettings& settings, const AskOperator& ask);

}  // namespace tiltmap
