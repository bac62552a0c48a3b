// Whether a result computed on an older snapshot still fits.
#pragma once

#include <vector>

#include "core/project/project_snapshot.h"

namespace tiltmap {

// Throws StoreFailure that names the scan and what has changed about it since `base`: deleted, another
// matrix, geometry or pose, or the links among the scans concerned (all of base's where the list is empty).
// Compares states, not revisions: what was changed and undone has not changed.
void requireUnchanged(const ProjectSnapshot& base, const ProjectSnapshot& now,
                      const std::vector<ScanId>& concerned);

}  // namespace tiltmap
