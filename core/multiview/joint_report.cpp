#include "core/multiview/joint_report.h"

#include <algorithm>
#include <cmath>

#include "core/multiview/relaxation_engine.h"

namespace tiltmap {

namespace {

std::string percent(double share) {
  return std::to_string(std::lround(100.0 * share)) + " %";
}

}  // namespace

void reportAttempts(const std::vector<const JointLink*>& of, const std::vector<MisfitAttempt>& attempts,
                    RelaxationStep& report) {
  for (std::size_t k = 0; k < of.size(); ++k) {
    RelaxationEvent event;
    event.kind = RelaxationEventKind::Aligned;
    event.scan = of[k]->moving;
    event.other = of[k]->fixed;
    event.pairs = attempts[k].pairs;
    event.rms_m = attempts[k].rms_m;
    event.text = stopReasonName(attempts[k].reason);
    report.events.push_back(event);
  }
}

void reportMovement(const std::vector<Pose>& starts, const std::vector<Pose>& poses,
                    const std::vector<char>& pinned, const RegistrationSettings& settings,
                    RelaxationStep& report, std::vector<std::string>& warnings) {
  std::vector<int> far;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (pinned[i]) continue;
    const PoseDifference by = difference(starts[i], poses[i]);
    RelaxationEvent moved;
    moved.kind = RelaxationEventKind::MovedBy;
    moved.scan = static_cast<int>(i);
    moved.translation_m = by.translation_m;
    moved.rotation_rad = by.rotation_rad;
    report.events.push_back(moved);
    if (by.translation_m > settings.max_correction_m || by.rotation_rad > settings.max_correction_rad)
      far.push_back(moved.scan);
  }
  if (!far.empty())
    warnings.push_back(
        "these scans moved further than max-correction allows for a good start; look at them: " +
        namesOf(far));
}

void reportDropped(int scans, const std::vector<JointLink>& links,
                   const std::function<bool(int, int)>& is_excluded, RelaxationStep& report,
                   std::vector<std::string>& warnings) {
  for (int i = 1; i < scans; ++i) {
    const auto found = std::ranges::find_if(
        links, [i](const JointLink& link) { return link.fixed == i - 1 && link.moving == i; });
    if ((found != links.end() && found->used) || is_excluded(i - 1, i)) continue;
    RelaxationEvent dropped;
    dropped.kind = RelaxationEventKind::LinkDropped;
    dropped.scan = i - 1;
    dropped.other = i;
    if (found == links.end()) {
      dropped.text = "they share too little space";
    } else {
      dropped.pairs = found->pairs;
      dropped.rms_m = found->rms_m;
      dropped.text = "overlap " + percent(found->overlap) + ", agreement " + percent(found->agreement);
    }
    report.events.push_back(dropped);
    warnings.push_back("scans " + std::to_string(i - 1) + " and " + std::to_string(i) + " do not fit (" +
                       dropped.text + "): nothing was computed from this pair; check its start");
  }
}

}  // namespace tiltmap
