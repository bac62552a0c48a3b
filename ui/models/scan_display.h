// How scans are shown: visible or not, in which colour, placed by which stage. The same in every panel.
#pragma once

#include <QColor>
#include <QObject>
#include <optional>
#include <set>

#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

class ProjectSession;

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

 Q_SIGNALS:
  void visibilityChanged();
  void stageChanged();

 private:
  const ProjectSession& session_;
  std::set<ScanId> hidden_;
  std::optional<Stage> chosen_;
};

}  // namespace tiltmap::ui
