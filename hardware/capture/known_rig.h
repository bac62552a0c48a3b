// What the scans of a project tell about the rig they were taken with, for the next stop that is taken with
// it.
#pragma once

#include <optional>
#include <string>

#include "core/project/project_snapshot.h"
#include "core/scan/cell_mask.h"

namespace tiltmap {

struct KnownRig {
  // Its calibrated members and its range bounds count; the sweep's own numbers do not.
  std::optional<ScannerGeometry> calibration;
  std::optional<CellMask> body;        // cells that show the machine itself
  std::string calibrated_at, body_at;  // the scans that have them, by name

  bool empty() const { return !calibration && !body; }
};

// Of the newest scans that the same instruments took in the same sweep (lines, columns, angles): what was
// found for them and applied. Nothing of scans of other instruments or sweeps. `instruments` are as
// ScanEntry::source has them; at which ports they are does not matter. Error: a matrix that can no longer be
// read.
Result<KnownRig> knownRig(const ProjectSnapshot& snapshot, const ScannerGeometry& sweep,
                          const std::string& instruments);

// Calibrated members and range bounds, into the geometry of a new stop.
void takeOver(const KnownRig& rig, ScannerGeometry& geometry);
// "the calibration of stop 3 and the mask of the machine's body of stop 3 (374 cells)"; empty for none.
std::string knownRigText(const KnownRig& rig);

}  // namespace tiltmap
