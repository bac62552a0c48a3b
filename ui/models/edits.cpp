#include "ui/models/edits.h"

#include <algorithm>

namespace tiltmap::ui {

ProjectEdit reorderEdit(const ProjectSnapshot& snapshot, const std::vector<ScanId>& moved,
                        std::size_t place) {
  const auto isMoved = [&](ScanId id) { return std::ranges::find(moved, id) != moved.end(); };
  std::vector<ScanId> before, taken, after, now;
  for (std::size_t i = 0; i < snapshot.scans().size(); ++i) {
    const ScanId id = snapshot.scans()[i].id;
    now.push_back(id);
    (isMoved(id) ? taken : i < place ? before : after).push_back(id);
  }
  std::vector<ScanId> order = std::move(before);
  order.insert(order.end(), taken.begin(), taken.end());
  order.insert(order.end(), after.begin(), after.end());
  if (order == now) return {};
  ProjectEdit edit;
  edit.title = "reorder scans";
  edit.steps.push_back(ReorderScans{std::move(order)});
  return edit;
}

ProjectEdit deleteLinksEdit(const ProjectSnapshot& snapshot, const std::vector<LinkId>& links) {
  ProjectEdit edit;
  if (links.empty()) return edit;
  const Link* only = links.size() == 1 ? snapshot.findLink(links.front()) : nullptr;
  edit.title =
      only ? "delete link " + linkName(snapshot, *only) : "delete " + std::to_string(links.size()) + " links";
  edit.steps.push_back(DeleteLinks{links});
  return edit;
}

ProjectEdit linkStatesEdit(const ProjectSnapshot& snapshot, const std::vector<LinkId>& links,
                           LinkState state) {
  ProjectEdit edit;
  const std::string verb = state == LinkState::Active ? "enable" : "disable";
  for (const LinkId id : links) {
    const Link* link = snapshot.findLink(id);
    if (!link || link->state == state) continue;
    edit.title = verb + " link " + linkName(snapshot, *link);
    edit.steps.push_back(SetLinkState{id, state});
  }
  if (edit.steps.size() > 1) edit.title = verb + " " + std::to_string(edit.steps.size()) + " links";
  return edit;
}

ProjectEdit acceptLinksEdit(const ProjectSnapshot& snapshot, const std::vector<LinkId>& links) {
  ProjectEdit edit;
  std::size_t accepted = 0;
  for (const LinkId id : links) {
    const Link* link = snapshot.findLink(id);
    if (!link || !link->succeeded || link->origin == LinkOrigin::ByHand) continue;
    ProjectEdit one = acceptLinkEdit(*link);
    edit.title = ++accepted == 1 ? "accept link " + linkName(snapshot, *link)
                                 : "accept " + std::to_string(accepted) + " links";
    std::ranges::move(one.steps, std::back_inserter(edit.steps));
  }
  return edit;
}

ProjectEdit clearStageEdit(Stage stage) {
  ProjectEdit edit;
  edit.title = "clear " + stageName(stage) + " poses";
  edit.steps.push_back(ClearPoses{stage});
  return edit;
}

std::string linkName(const ProjectSnapshot& snapshot, const Link& link) {
  const auto index = [&](ScanId id) {
    const auto place = snapshot.indexOf(id);
    return place ? std::to_string(*place) : std::string("?");
  };
  return index(link.fixed) + " – " + index(link.moving);
}

}  // namespace tiltmap::ui
