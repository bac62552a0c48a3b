#include "core/project/operations/link_consistency.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/multiview/pose_graph.h"
#include "core/project/link_what_if.h"
#include "core/project/operations/relax_operation.h"
#include "core/registration/pose_strength.h"

namespace tiltmap {

namespace {

std::string warningOf(const GraphLink& link, bool by_hand, const std::vector<Pose>& world_from_scan) {
  const Pose rest = world_from_scan[static_cast<std::size_t>(link.fixed)].inverse() *
                    world_from_scan[static_cast<std::size_t>(link.moving)];
  const PoseDifference off = difference(link.fixed_from_moving, rest);
  return std::string(by_hand ? "the link by hand" : "the link") + " of scans " + std::to_string(link.fixed) +
         " and " + std::to_string(link.moving) + " contradicts the others by " +
         lengthWords(off.translation_m) + " and " + fixedReal(off.rotation_rad / kDegree, 2) +
         "°: nothing was computed from it; " +
         (by_hand ? "delete it, or, if it is right, disable the wrong link on the way round"
                  : "disable it, or, if it is right, the wrong link on the way round");
}

}  // namespace

Result<ConsistentLinks> consistentLinks(const ProjectSnapshot& snapshot, std::vector<Link> links,
                                        std::vector<Pose> world_from_scan, const std::vector<int>& pins) {
  std::vector<GraphLink> graph;
  std::vector<std::size_t> of;  // index into links
  bool doubts = false;
  for (std::size_t k = 0; k < links.size(); ++k) {
    const Link& link = links[k];
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving || !link.usable() || link.origin == LinkOrigin::Odometry ||
        link.stop_reason == kFoundByRelaxation || (!link.information && link.origin != LinkOrigin::ByHand))
      continue;
    const int a = static_cast<int>(*fixed), b = static_cast<int>(*moving);
    const bool doubted = std::abs(a - b) > 1;
    doubts = doubts || doubted;
    graph.push_back({a, b, link.fixed_from_moving, link.information.value_or(informationByHand()), doubted});
    of.push_back(k);
  }
  ConsistentLinks outcome;
  if (doubts) {
    std::vector<char> held(world_from_scan.size(), 0);
    held.front() = 1;
    for (const int pin : pins) held[static_cast<std::size_t>(pin)] = 1;
    auto solved = solvePoseGraph(world_from_scan, held, graph);
    if (!solved) return fail(solved.error());
    world_from_scan = std::move(solved->poses);
    for (auto k = solved->rejected.rbegin(); k != solved->rejected.rend(); ++k) {
      const auto index = static_cast<std::size_t>(*k);
      outcome.warnings.insert(
          outcome.warnings.begin(),
          warningOf(graph[index], links[of[index]].origin == LinkOrigin::ByHand, world_from_scan));
      links.erase(links.begin() + static_cast<std::ptrdiff_t>(of[index]));
    }
  }
  outcome.links = std::move(links);
  outcome.world_from_scan = std::move(world_from_scan);
  return outcome;
}

}  // namespace tiltmap
