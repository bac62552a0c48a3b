#include "ui/panels/relaxation_overlay.h"

#include <QToolButton>
#include <algorithm>

#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/compare_bar.h"
#include "ui/panels/scene_widget.h"
#include "ui/scene/scene.h"

namespace tiltmap::ui {

namespace {

constexpr int kMostNamed = 8;

// "3, 4, 7", the first ones of many.
QString listed(const std::vector<int>& scans) {
  QStringList names;
  for (const int scan : scans) {
    if (names.size() == kMostNamed) return names.join(", ") + QString(" … %1 in all").arg(scans.size());
    names << QString::number(scan);
  }
  return names.join(", ");
}

SceneRoles rolesOf(const RelaxationModel& relaxation) {
  SceneRoles roles;
  if (!relaxation.isRunning() || relaxation.scans().empty()) return roles;
  const RelaxationState& state = relaxation.state();
  std::map<RelaxationRole, std::vector<int>> members;
  const auto& scans = relaxation.scans();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const RelaxationRole role = relaxation.role(static_cast<int>(i));
    roles.of[scans[i]] = role;
    if (role != RelaxationRole::None) members[role].push_back(static_cast<int>(i));
  }
  // The queue in its own order: who is next.
  if (auto queued = members.find(RelaxationRole::Queued); queued != members.end())
    std::ranges::sort(queued->second, {}, [&](int scan) { return std::ranges::find(state.queue, scan); });
  for (const int other : state.onto)
    if (other >= 0 && static_cast<std::size_t>(other) < scans.size())
      roles.onto.push_back(scans[static_cast<std::size_t>(other)]);
  for (const RelaxationRole role : {RelaxationRole::Aligning, RelaxationRole::Queued, RelaxationRole::Active,
                                    RelaxationRole::Waiting, RelaxationRole::Held}) {
    const auto found = members.find(role);
    if (found == members.end()) continue;
    QString text = relaxationRoleName(role) + ": " + listed(found->second);
    if (role == RelaxationRole::Aligning && !state.onto.empty()) text += " onto " + listed(state.onto);
    roles.legend.emplace_back(role, utf8(text));
  }
  return roles;
}

}  // namespace

RelaxationOverlay::RelaxationOverlay(const PanelContext& context, Scene& scene, SceneWidget& view,
                                     QToolButton& compare, CompareBar& bar, QObject* parent)
    : QObject(parent), context_(context), scene_(scene), view_(view), compare_(compare), bar_(bar) {
  Workspace& workspace = context_.workspace;
  connect(&workspace.relaxation(), &RelaxationModel::changed, this, &RelaxationOverlay::refresh);
  connect(&workspace.relaxation(), &RelaxationModel::reset, this, &RelaxationOverlay::refresh);
  connect(&workspace.display(), &ScanDisplay::rolesChanged, this, &RelaxationOverlay::refresh);
  connect(&workspace.display(), &ScanDisplay::whatIfChanged, this, &RelaxationOverlay::refresh);
  connect(&workspace.display(), &ScanDisplay::proposalCompareChanged, this,
          &RelaxationOverlay::followCompare);
  connect(&compare, &QToolButton::toggled, this, [this](bool on) {
    // Ended by hand in the view: the decision's buttons follow.
    if (!on) context_.workspace.display().compareProposal(ProposalCompare::Off);
  });
  refresh();
  followCompare();
}

void RelaxationOverlay::refresh() {
  const ScanDisplay& display = context_.workspace.display();
  scene_.setRoles(rolesOf(context_.workspace.relaxation()));
  scene_.setGhosts(display.ghosts());
  std::map<Stage, std::string> words;
  if (context_.workspace.relaxation().isProposal())
    words = {{Stage::Pairwise, "Before: pairwise"}, {Stage::Relaxed, "After: the proposal"}};
  scene_.setStageWords(std::move(words));
  view_.drawSoon();
}

void RelaxationOverlay::followCompare() {
  const ProposalCompare how = context_.workspace.display().proposalCompare();
  const bool on = how != ProposalCompare::Off;
  if (on) bar_.choose(Stage::Pairwise, how == ProposalCompare::Blink);
  if (on || switched_on_) compare_.setChecked(on);
  switched_on_ = on;
  refresh();
}

}  // namespace tiltmap::ui
