// Links that contradict the others, found before anything is computed from them.
#pragma once

#include <string>
#include <vector>

#include "core/project/project_snapshot.h"

namespace tiltmap {

// Automatic links between scans that are no neighbours in time (closures of loops, registered by name, or put
// in otherwise) may be false: two places look alike. Each is held against the way round by the others
// (pose_graph.h).
struct ConsistentLinks {
  std::vector<Link> links;            // without the ones that contradict the rest
  std::vector<Pose> world_from_scan;  // as the links that are left put the scans
  std::vector<std::string> warnings;  // names each that was left out, and by how much it misses
};

// As they are, bit for bit, where no link can be doubted. `pins`: indices of scans that do not move, beside
// scan 0. Links by hand are a person's word and beyond doubt; so are neighbours in time, and links of an
// earlier relaxation are not looked at. Error: the equations could not be solved.
Result<ConsistentLinks> consistentLinks(const ProjectSnapshot& snapshot, std::vector<Link> links,
                                        std::vector<Pose> world_from_scan, const std::vector<int>& pins);

}  // namespace tiltmap
