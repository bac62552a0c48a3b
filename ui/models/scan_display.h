// How scans are shown: visible or not, in which colour, placed by which stage. The same in every panel.
#pragma once

#include <QColor>
#include <QObject>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

class ProjectSession;

// What a scan is to a relaxation that runs.
enum class RelaxationRole { None, Held, Active, Waiting, Queued, Aligning };

// How the poses of a proposal are compared with those it began from, in 3D.
enum class ProposalCompare { Off, Wipe, Blink };

class ScanDisplay : public QObject {
  Q_OBJECT

 public:
  explicit ScanDisplay(const ProjectSession& session, QObject* parent = nullptr);

  bool isVisible(ScanId scan) const { return !hidden_.contains(scan); }
  void setVisible(const std::vector<ScanId>& scans, bool visible);
  void showAll();
  void showOnly(const std::vector<ScanId>& scans);

  // Chosen by a person or by the scan's index, as in pictures and reports.
  QColor colour(ScanId scan) const;

  // The stage whose poses place the scans: the one chosen while the project has it, else the latest.
  Stage stage() const;
  std::optional<Stage> chosenStage() const { return chosen_; }
  void setStage(std::optional<Stage> stage);  // nothing: follow the latest

  // Poses that are only proposed are shown in place of the stage `relaxed`, and of whatever stage was chosen,
  // until they are withdrawn. The project does not know of them. `before`: what they began from, shown as the
  // stage `pairwise`.
  void propose(std::vector<std::pair<ScanId, Pose>> poses, std::vector<std::pair<ScanId, Pose>> before = {});
  void withdraw();
  bool isProposal() const { return !proposed_.empty(); }
  // What views draw: the project, with the proposed poses where there are any.
  SnapshotPtr placed() const;
  Stage placedStage() const { return isProposal() ? Stage::Relaxed : stage(); }

  // Of a proposal only, and over with it.
  void compareProposal(ProposalCompare how);
  ProposalCompare proposalCompare() const { return compare_; }

  // Where scans would be without some links that somebody asks about: shown beside where they are.
  void showWhatIf(std::map<ScanId, Pose> ghosts, std::vector<LinkId> left_out);
  const std::map<ScanId, Pose>& ghosts() const { return ghosts_; }
  const std::vector<LinkId>& leftOut() const { return left_out_; }

  RelaxationRole role(ScanId scan) const;
  void setRoles(std::map<ScanId, RelaxationRole> roles);
  bool hasRoles() const { return !roles_.empty(); }

 Q_SIGNALS:
  void visibilityChanged();
  void stageChanged();
  void placedChanged();  // poses were proposed or withdrawn
  void rolesChanged();
  void whatIfChanged();
  void proposalCompareChanged();

 private:
  const ProjectSession& session_;
  std::set<ScanId> hidden_;
  std::optional<Stage> chosen_;
  std::vector<std::pair<ScanId, Pose>> proposed_, before_;
  ProposalCompare compare_ = ProposalCompare::Off;
  std::map<ScanId, RelaxationRole> roles_;
  std::map<ScanId, Pose> ghosts_;
  std::vector<LinkId> left_out_;
};

}  // namespace tiltmap::ui
