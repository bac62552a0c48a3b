#include "core/project/link_judgement.h"

#include "core/base/parallel.h"

namespace tiltmap {

Result<std::vector<JudgedLink>> judgeLinkScans(const ProjectSnapshot& snapshot, int threads,
                                               const JudgementSettings& settings, const JobControl& control) {
  const std::vector<Link>& links = snapshot.links();
  const std::size_t count = snapshot.scans().size();
  std::vector<bool> wanted(count, false);
  for (const Link& link : links)
    for (const ScanId id : {link.fixed, link.moving})
      if (const auto index = snapshot.indexOf(id)) wanted[*index] = true;
  const RegistrationSettings preparing;
  std::vector<Result<JudgedScanPtr>> scans(count, JudgedScanPtr());
  parallelFor(count, threads, [&](std::size_t i) {
    if (!wanted[i] || control.stopRequested()) return;
    scans[i] = snapshot.scans()[i].scan().map(
        [&](const Scan& scan) { return judgedScan(prepare(scan, preparing)); });
    control.tell(static_cast<double>(i + 1) / static_cast<double>(count),
                 "looking at scan " + std::to_string(i));
  });
  if (control.stopRequested())
    return fail(kCancelled, "judge", "nothing was changed; start again when you like");
  for (const auto& scan : scans)
    if (!scan) return fail(scan.error());

  std::vector<JudgedLink> judged(links.size());
  parallelFor(links.size(), threads, [&](std::size_t k) {
    const Link& link = links[k];
    judged[k].link = link.id;
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving || control.stopRequested()) return;
    PairClaim claim;
    claim.fixed_from_moving = link.fixed_from_moving;
    claim.start = snapshot.scans()[*fixed].odometry().inverse() * snapshot.scans()[*moving].odometry();
    claim.succeeded = link.succeeded;
    if (!link.succeeded) claim.ended = "registration ended with: " + link.stop_reason;
    judged[k].judgement = judgePair(**scans[*fixed], **scans[*moving], claim, settings);
  });
  if (control.stopRequested())
    return fail(kCancelled, "judge", "nothing was changed; start again when you like");
  return judged;
}

}  // namespace tiltmap
