#include "ui/models/selection.h"

#include <algorithm>

#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

bool Selection::isSelected(ScanId scan) const {
  return std::ranges::find(scans_, scan) != scans_.end();
}

void Selection::setScans(std::vector<ScanId> scans, std::optional<ScanId> current) {
  if (!current || std::ranges::find(scans, *current) == scans.end())
    current = scans.empty() ? std::nullopt : std::optional(scans.back());
  if (scans == scans_ && current == current_) return;
  scans_ = std::move(scans);
  current_ = current;
  Q_EMIT scansChanged();
}

void Selection::setLinks(std::vector<LinkId> links) {
  if (links == links_) return;
  links_ = std::move(links);
  Q_EMIT linksChanged();
}

void Selection::clear() {
  setScans({});
  setLinks({});
  setHovered({});
  setPicked({});
}

void Selection::setHovered(std::optional<CellPlace> cell) {
  if (cell == hovered_) return;
  hovered_ = cell;
  Q_EMIT hoveredChanged();
}

void Selection::setPicked(std::optional<CellPlace> cell) {
  if (cell == picked_) return;
  picked_ = cell;
  Q_EMIT pickedChanged();
}

void Selection::keepOnly(const ProjectSnapshot* snapshot) {
  if (!snapshot) return clear();
  std::vector<ScanId> scans;
  for (const ScanId id : scans_)
    if (snapshot->find(id)) scans.push_back(id);
  std::vector<LinkId> links;
  for (const LinkId id : links_)
    if (snapshot->findLink(id)) links.push_back(id);
  setScans(std::move(scans), current_);
  setLinks(std::move(links));
  if (hovered_ && !snapshot->find(hovered_->scan)) setHovered({});
  if (picked_ && !snapshot->find(picked_->scan)) setPicked({});
}

}  // namespace tiltmap::ui
