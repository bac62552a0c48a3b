// Which pairs of many scans are worth trying: those that fill the same parts of the world.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/multiview/relaxation.h"

namespace tiltmap {

// Pairs (lower index first, ascending) that share at least min_shared_cells of the smaller one's cubes of
// edge cell_m, each scan's best max_links_per_scan of them (ties to the lowest index); a pair stays when
// either scan wants it. Neighbours in the order of the scans are always among them where they share a cube.
// Time grows with the number of such pairs, not with the square of the scans. The result does not depend on
// `threads`.
std::vector<std::pair<int, int>> overlapCandidates(std::span<const PreparedScanPtr> scans,
                                                   std::span<const Pose> world_from_scan,
                                                   const RelaxationSettings& settings, int threads);

}  // namespace tiltmap
