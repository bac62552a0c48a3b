// Spreading what the pairs' errors added up to over all scans (thesis chapter 6).
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// Starts from the stage `pairwise`, or from the odometry where there is none (a warning). Its edit holds the
// stage `relaxed`, a pose a scan, and a link for each overlapping pair of scans that had none yet. Links set
// by hand pull as they stand; links found by registration do where the surfaces give none now; pairs whose
// link is disabled are left out.
std::unique_ptr<Operation> makeRelaxOperation();

}  // namespace tiltmap
