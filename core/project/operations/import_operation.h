// Bringing other people's scans into a project.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// Files are named one a line. Odometry comes from a TUM file, else from the file itself, else it is that of
// the scan before (a warning). The first scan of an empty project becomes the world: all poses are re-based
// on it, and its own pose is kept as the project's site frame, which later imports go through as well.
std::unique_ptr<Operation> makeImportOperation();

}  // namespace tiltmap
