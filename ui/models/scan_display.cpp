#include "ui/models/scan_display.h"

#include <algorithm>

#include "core/products/scan_colours.h"
#include "ui/models/project_session.h"

namespace tiltmap::ui {

ScanDisplay::ScanDisplay(const ProjectSession& session, QObject* parent)
    : QObject(parent), session_(session) {
  connect(&session, &ProjectSession::closed, this, [this] {
    hidden_.clear();
    chosen_.reset();
    proposed_.clear();
    before_.clear();
    compare_ = ProposalCompare::Off;
    roles_.clear();
    ghosts_.clear();
    left_out_.clear();
  });
}

void ScanDisplay::setVisible(const std::vector<ScanId>& scans, bool visible) {
  bool any = false;
  for (const ScanId scan : scans) any |= visible ? hidden_.erase(scan) > 0 : hidden_.insert(scan).second;
  if (any) Q_EMIT visibilityChanged();
}

void ScanDisplay::showAll() {
  if (hidden_.empty()) return;
  hidden_.clear();
  Q_EMIT visibilityChanged();
}

void ScanDisplay::showOnly(const std::vector<ScanId>& scans) {
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot) return;
  std::set<ScanId> hidden;
  for (const ScanEntry& scan : snapshot->scans())
    if (std::ranges::find(scans, scan.id) == scans.end()) hidden.insert(scan.id);
  if (hidden == hidden_) return;
  hidden_ = std::move(hidden);
  Q_EMIT visibilityChanged();
}

QColor ScanDisplay::colour(ScanId scan) const {
  const SnapshotPtr snapshot = session_.snapshot();
  const auto index = snapshot ? snapshot->indexOf(scan) : std::nullopt;
  if (!index) return Qt::gray;
  const Rgb rgb = scanColour(snapshot->scans()[*index], *index);
  return {rgb.r, rgb.g, rgb.b};
}

Stage ScanDisplay::stage() const {
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot) return Stage::Odometry;
  return chosen_ && snapshot->hasStage(*chosen_) ? *chosen_ : snapshot->latestStage();
}

void ScanDisplay::setStage(std::optional<Stage> stage) {
  if (stage == chosen_) return;
  chosen_ = stage;
  Q_EMIT stageChanged();
}

void ScanDisplay::propose(std::vector<std::pair<ScanId, Pose>> poses,
                          std::vector<std::pair<ScanId, Pose>> before) {
  if (poses.empty()) return withdraw();
  proposed_ = std::move(poses);
  before_ = std::move(before);
  Q_EMIT placedChanged();
}

void ScanDisplay::withdraw() {
  if (proposed_.empty()) return;
  proposed_.clear();
  before_.clear();
  compareProposal(ProposalCompare::Off);
  Q_EMIT placedChanged();
}

void ScanDisplay::compareProposal(ProposalCompare how) {
  if (!isProposal()) how = ProposalCompare::Off;
  if (how == compare_) return;
  compare_ = how;
  Q_EMIT proposalCompareChanged();
}

SnapshotPtr ScanDisplay::placed() const {
  SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot || !isProposal()) return snapshot;
  if (!before_.empty()) snapshot = snapshot->withPoses(Stage::Pairwise, before_);
  return snapshot->withPoses(Stage::Relaxed, proposed_);
}

void ScanDisplay::showWhatIf(std::map<ScanId, Pose> ghosts, std::vector<LinkId> left_out) {
  if (ghosts.empty() && ghosts_.empty()) return;
  ghosts_ = std::move(ghosts);
  left_out_ = std::move(left_out);
  Q_EMIT whatIfChanged();
}

RelaxationRole ScanDisplay::role(ScanId scan) const {
  const auto found = roles_.find(scan);
  return found == roles_.end() ? RelaxationRole::None : found->second;
}

void ScanDisplay::setRoles(std::map<ScanId, RelaxationRole> roles) {
  if (roles == roles_) return;
  roles_ = std::move(roles);
  Q_EMIT rolesChanged();
}

}  // namespace tiltmap::ui
