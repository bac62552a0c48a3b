// Stops captured into the open project with instruments that are there: the one way that lines are stored,
// for who opens instruments for it and for who keeps them open.
#pragma once

#include "core/project/live_project.h"
#include "core/project/operation.h"
#include "hardware/capture/capture_bench.h"
#include "hardware/capture/sweep.h"

namespace tiltmap {

struct CaptureTask {
  SnapshotPtr snapshot;
  CapturePlan plan;                    // of that snapshot
  std::optional<Pose> last_from_next;  // of the first stop, in place of what the plan's settings say
  AskOperator ask;                     // as for makeCaptureOperation()
  SweepEvents events;
  // A stop is in the project and its sweep begins; rows that are taken already are an interrupted one's.
  std::function<void(ScanId scan, const ScannerGeometry& geometry, const std::vector<bool>& taken)> begun;
};

// Prepares the instruments where they are not ready, and leaves them ready.
Result<OperationResult> runCapture(const CaptureTask& task, CaptureBench& bench, Sweep& sweep,
                                   LiveProject& live, const JobControl& job);
// About what a scan takes on the disk, ranges and codes of every cell and what is kept with each line.
double storedBytes(int lines, int columns);
SweepOptions sweepSettings(const CaptureSettings& settings);

}  // namespace tiltmap
