// Scans that came after a relaxation, put onto those that it holds, without computing these anew.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/multiview/relaxation.h"
#include "core/project/project_snapshot.h"

namespace tiltmap {

// The added scans and the relaxed ones that may overlap with them: those within the longest reach of the
// links so far (a fifth more), the nearest of them. Ascending indices; `world_from_scan` one a scan.
std::vector<int> scansAround(const ProjectSnapshot& snapshot, const std::vector<Pose>& world_from_scan,
                             const std::vector<int>& added, const RelaxationSettings& settings);

// Runs a relaxation; called more than once.
using RelaxationRun = std::function<Result<RelaxationResult>(RelaxationInput)>;

// `input`: as for all scans, with the relaxed poses as starts, but with scans without elements in place of
// those that are not `around`. Surfaces are measured for pairs with an added scan only. Two scans that were
// relaxed are at the minimum of what they told then, so each link of theirs is taken as a pose measured where
// it is now, with its information: the quadratic form of the old problem about its minimum. Scans move as far
// from the added ones as these pull, further out step by step, until the outermost that may move stay where
// they were within a tenth of a millimetre. Nothing where added scans move the others so far (they close a
// loop that had not been closed) that what was measured about them does not stand.
Result<std::optional<RelaxationResult>> relaxAdded(const ProjectSnapshot& snapshot,
                                                   const RelaxationInput& input,
                                                   const std::vector<Link>& links,
                                                   const std::vector<int>& added,
                                                   const std::vector<int>& around, const RelaxationRun& run);

}  // namespace tiltmap
