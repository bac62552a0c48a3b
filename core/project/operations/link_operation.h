// One link more: between two scans that a person names.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// Starts from where the named stage puts the two scans (a loop's two ends are far off by odometry). `method`
// register: the surfaces decide, origin automatic, and a registration that fails is a failed operation;
// as-placed: the poses themselves become the link, origin by hand, with overlap and residual as they are
// there. Its edit holds the link alone, which takes the place of one of the same origin between the two; no
// pose moves. Report: `fixed`, `moving`, `overlap`, `rms_m`, `correspondences`, `moved_m`, `moved_deg` (from
// the start), `stop_reason`, `milliseconds`.
std::unique_ptr<Operation> makeLinkOperation();

}  // namespace tiltmap
