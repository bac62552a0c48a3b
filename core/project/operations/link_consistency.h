// Links that contradict the others, found before anything is computed from them.
#pragma once

#include <string>
#include <vector>

#include "core/project/project_snapshot.h"

namespace tiltmap {

// Links between scans that are no neighbours in time (closures of loops, registered by name, set by hand, or
// put in otherwise) may be false: two places look alike, to people too. Each is held against the way round by
// the others (pose_graph.h).
struct ConsistentLinks {
  std::vector<Link> links;            // without the ones that contradict the rest
  std::vector<Pose> world_from_scan;  // as the links that are left put the scans
  std::vector<std::string> warnings;  // names each that was left out, and by how much it misses
};

// As they are, bit for bit, where no link can be doubted. `pins`: indices of scans that do not move, beside
// scan 0. Neighbours in time are beyond doubt, and links of an earlier relaxation are not looked at. A link
// by hand without an information is as certain as informationByHand() says. Error: the equations could not be
// solved.
Result<ConsistentLinks> consistentLinks(const ProjectSnapshot& snapshot, std::vector<Link> links,
                                        std::vector<Pose> world_from_scan, const std::vector<int>& pins);

}  // namespace tiltmap
