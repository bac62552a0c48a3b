#include "core/project/operations/pair_links.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/text.h"
#include "core/base/version.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

namespace {

// The link that chains `index` to the scan before it: the one just found, else one the project already has.
const Link* chainLink(const ProjectSnapshot& snapshot, const std::vector<Link>& found, std::size_t index) {
  const ScanId fixed = snapshot.scans()[index - 1].id, moving = snapshot.scans()[index].id;
  for (const Link& link : found)
    if (link.fixed == fixed && link.moving == moving) return &link;
  for (const Link& link : snapshot.links())
    if (link.fixed == fixed && link.moving == moving && link.usable()) return &link;
  return nullptr;
}

std::vector<std::pair<ScanId, Pose>> chainedPoses(const ProjectSnapshot& snapshot,
                                                  const std::vector<Link>& found) {
  std::vector<std::pair<ScanId, Pose>> poses;
  for (std::size_t i = 0; i < snapshot.scans().size(); ++i) {
    const ScanEntry& scan = snapshot.scans()[i];
    if (i == 0) {
      poses.emplace_back(scan.id, scan.odometry());
      continue;
    }
    const Link* link = chainLink(snapshot, found, i);
    poses.emplace_back(scan.id, poses.back().second * (link && link->usable()
                                                           ? link->fixed_from_moving
                                                           : odometryStart(snapshot.scans()[i - 1], scan)));
  }
  return poses;
}

std::string startWords(const Pose& start) {
  const Eigen::Vector3d& t = start.translation();
  const Eigen::Quaterniond& q = start.quaternion();
  std::string text =
      "started from a pose set by hand, not from the odometry: x y z (m) and quaternion x y z w";
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
    text += " " + shortestReal(value);
  return text;
}

bool joins(const Link& link, ScanId a, ScanId b) {
  return (link.fixed == a && link.moving == b) || (link.fixed == b && link.moving == a);
}

}  // namespace

Pose odometryStart(const ScanEntry& fixed, const ScanEntry& moving) {
  return fixed.odometry().inverse() * moving.odometry();
}

Link pairLink(ScanId fixed, ScanId moving, const PairResult& result, double milliseconds) {
  Link link;
  link.fixed = fixed;
  link.moving = moving;
  link.fixed_from_moving = result.fixed_from_moving;
  link.iterations = result.iterations;
  link.correspondences = static_cast<int>(result.correspondences);
  link.rms_m = result.rms_m;
  link.overlap = result.overlap;
  link.milliseconds = milliseconds;
  link.stop_reason = stopReasonName(result.stop_reason);
  link.succeeded = result.succeeded();
  if (result.succeeded()) link.information = result.information;
  return link;
}

Link judgedLink(Link link, const PairJudgement& judgement) {
  link.judgement = std::make_shared<const PairJudgement>(judgement);
  return link;
}

ProjectEdit pairLinksEdit(const SnapshotPtr& snapshot, std::vector<Link> links) {
  auto poses = chainedPoses(*snapshot, links);
  return registerEdit(snapshot, std::move(links), std::move(poses));
}

ProjectEdit steppedPairEdit(const SnapshotPtr& snapshot, const SteppedPair& pair) {
  const auto fixed = snapshot->indexOf(pair.fixed), moving = snapshot->indexOf(pair.moving);
  if (!fixed || !moving) throw std::invalid_argument("steppedPairEdit: a scan is not in the project");
  if (!pair.result.succeeded())
    throw std::invalid_argument("steppedPairEdit: the registration did not succeed");
  Link link = pairLink(pair.fixed, pair.moving, pair.result, pair.result.milliseconds);
  link.judgement = pair.judgement;
  if (pair.start_by_hand) link.origin = LinkOrigin::ByHand;
  ProjectEdit edit = pairLinksEdit(snapshot, {link});
  edit.title = "accept scan " + std::to_string(*moving) + " on scan " + std::to_string(*fixed);
  DeleteLinks replaced;
  if (pair.start_by_hand)
    for (const Link& other : snapshot->links())
      if (other.origin != LinkOrigin::ByHand && joins(other, pair.fixed, pair.moving))
        replaced.links.push_back(other.id);
  if (!replaced.links.empty()) edit.steps.insert(edit.steps.begin(), std::move(replaced));

  JobRecord record;
  record.operation = "register";
  record.preset = pair.preset;
  record.values = pair.values;
  record.values["pairs"] = std::to_string(*fixed) + ":" + std::to_string(*moving);
  record.program_version = programVersion();
  record.started = pair.started;
  record.finished = utcNow();
  record.state = JobState::Accepted;
  if (pair.start_by_hand) record.warnings.push_back(startWords(pair.start));
  edit.jobs.push_back(std::move(record));
  return edit;
}

}  // namespace tiltmap
