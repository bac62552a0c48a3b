// What is selected and pointed at, shared by all panels of a window.
#pragma once

#include <QObject>
#include <optional>
#include <vector>

#include "core/project/link.h"

namespace tiltmap {
class ProjectSnapshot;
}

namespace tiltmap::ui {

// One beam: a cell of a scan's range matrix.
struct CellPlace {
  ScanId scan = 0;
  int row = 0;
  int column = 0;
  bool operator==(const CellPlace&) const = default;
};

// A panel sets what its user chose and listens for what the others set; setting what is already set says
// nothing, so that two panels may follow each other.
class Selection : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  const std::vector<ScanId>& scans() const { return scans_; }
  // The one that single-scan panels show: the last that was chosen, even when several are selected.
  std::optional<ScanId> currentScan() const { return current_; }
  const std::vector<LinkId>& links() const { return links_; }
  bool isSelected(ScanId scan) const;

  void setScans(std::vector<ScanId> scans, std::optional<ScanId> current = {});
  void setCurrentScan(ScanId scan) { setScans({scan}, scan); }
  void setLinks(std::vector<LinkId> links);
  void clear();

  // The beam under the pointer, in the depth image or in 3D; nothing while it is over none.
  std::optional<CellPlace> hovered() const { return hovered_; }
  void setHovered(std::optional<CellPlace> cell);
  // The beam that was clicked.
  std::optional<CellPlace> picked() const { return picked_; }
  void setPicked(std::optional<CellPlace> cell);

  // Forgets what the project no longer has.
  void keepOnly(const ProjectSnapshot* snapshot);

 Q_SIGNALS:
  void scansChanged();
  void linksChanged();
  void hoveredChanged();
  void pickedChanged();

 private:
  std::vector<ScanId> scans_;
  std::optional<ScanId> current_;
  std::vector<LinkId> links_;
  std::optional<CellPlace> hovered_;
  std::optional<CellPlace> picked_;
};

}  // namespace tiltmap::ui
