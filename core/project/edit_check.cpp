#include "core/project/edit_check.h"

#include <set>
#include <utility>

#include "core/project/database.h"

namespace tiltmap {

namespace {

constexpr const char* kComputeAgain = "discard the result and compute it again";

bool samePoses(const std::map<Stage, Pose>& a, const std::map<Stage, Pose>& b) {
  if (a.size() != b.size()) return false;
  for (const auto& [stage, pose] : a) {
    const auto other = b.find(stage);
    if (other == b.end() || other->second.translation() != pose.translation() ||
        other->second.quaternion().coeffs() != pose.quaternion().coeffs())
      return false;
  }
  return true;
}

[[noreturn]] void refuse(const ScanEntry& scan, const std::string& what) {
  throw StoreFailure("the result no longer fits: " + what, scan.name, kComputeAgain);
}

// Links are written once; only their state changes.
std::vector<std::pair<LinkId, LinkState>> linksAmong(const ProjectSnapshot& snapshot,
                                                     const std::set<ScanId>& scans) {
  std::vector<std::pair<LinkId, LinkState>> links;
  for (const Link& link : snapshot.links())
    if (scans.contains(link.fixed) && scans.contains(link.moving)) links.emplace_back(link.id, link.state);
  return links;
}

}  // namespace

void requireUnchanged(const ProjectSnapshot& base, const ProjectSnapshot& now,
                      const std::vector<ScanId>& concerned) {
  if (base.projectId() != now.projectId())
    throw StoreFailure("the result was computed for another project", base.path().string(), "apply it there");
  if (base.revision() == now.revision()) return;
  std::set<ScanId> scans(concerned.begin(), concerned.end());
  if (scans.empty())
    for (const ScanEntry& scan : base.scans()) scans.insert(scan.id);
  for (const ScanId id : scans) {
    const ScanEntry* old = base.find(id);
    if (!old) continue;  // placeholders of the edit's own scans; others are found missing when it is written
    const ScanEntry* current = now.find(id);
    if (!current) refuse(*old, "scan \"" + old->name + "\" has been deleted since");
    if (current->matrix != old->matrix || current->lines != old->lines)
      refuse(*current, "scan \"" + current->name + "\" has other measurements since");
    if (current->geometry_id != old->geometry_id)
      refuse(*current, "the geometry of scan \"" + current->name + "\" has changed since");
    if (!samePoses(current->poses, old->poses))
      refuse(*current, "a pose of scan \"" + current->name + "\" has changed since");
  }
  if (linksAmong(base, scans) != linksAmong(now, scans))
    throw StoreFailure("the result no longer fits: links between the scans concerned have changed since",
                       now.path().string(), kComputeAgain);
}

}  // namespace tiltmap
