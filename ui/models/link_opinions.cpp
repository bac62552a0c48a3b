#include "ui/models/link_opinions.h"

#include <algorithm>

#include "core/registration/pair_judgement.h"

namespace tiltmap::ui {

namespace {

bool sameLink(const Link& a, const Link& b) {
  return a.id == b.id && a.fixed == b.fixed && a.moving == b.moving && a.state == b.state &&
         a.succeeded == b.succeeded && a.fixed_from_moving == b.fixed_from_moving &&
         a.information == b.information && sameJudgement(a.judgement.get(), b.judgement.get());
}

}  // namespace

std::vector<LinkJudgement> LinkOpinions::of(const ProjectSnapshot& snapshot, Stage stage) {
  std::vector<ScanId> scans;
  for (const ScanEntry& scan : snapshot.scans()) scans.push_back(scan.id);
  // Limits change with jobs only.
  const bool known = computed_ > 0 && scans == scans_ && snapshot.jobs().size() == jobs_ &&
                     std::ranges::equal(links_, snapshot.links(), sameLink);
  if (!known) {
    scans_ = std::move(scans);
    links_ = snapshot.links();
    jobs_ = snapshot.jobs().size();
    settings_ = judgementSettingsOf(snapshot);
    agreements_ = linkAgreements(snapshot, settings_);
    ++computed_;
  }
  return judgeLinks(snapshot, stage, agreements_, settings_);
}

}  // namespace tiltmap::ui
