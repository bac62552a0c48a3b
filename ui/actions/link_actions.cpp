// What is done to the selected links by hand.
#include <algorithm>

#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/edits.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

bool anyLinkIn(const Workspace& workspace, LinkState state) {
  const SnapshotPtr snapshot = workspace.snapshot();
  if (!workspace.session().isWritable() || workspace.jobs().busy()) return false;
  return std::ranges::any_of(workspace.selection().links(), [&](LinkId id) {
    const Link* link = snapshot->findLink(id);
    return link && link->state == state;
  });
}

void setState(Workspace& workspace, LinkState state) {
  const ProjectEdit edit = linkStatesEdit(*workspace.snapshot(), workspace.selection().links(), state);
  if (!edit.empty()) (void)workspace.session().apply(edit);
}

// "4:5,7:8": the selected links as the register operation takes pairs.
QString selectedPairs(const Workspace& workspace) {
  const SnapshotPtr snapshot = workspace.snapshot();
  QStringList pairs;
  for (const LinkId id : workspace.selection().links()) {
    const Link* link = snapshot->findLink(id);
    if (!link) continue;
    const auto fixed = snapshot->indexOf(link->fixed), moving = snapshot->indexOf(link->moving);
    if (fixed && moving) pairs << QString("%1:%2").arg(*fixed).arg(*moving);
  }
  return pairs.join(',');
}

}  // namespace

void addLinkActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  actions.add({"link.disable",
               "&Disable link",
               "Keep the selected links but compute nothing from them",
               "remove-link",
               {},
               [&workspace] { setState(workspace, LinkState::Disabled); },
               [&workspace] { return anyLinkIn(workspace, LinkState::Active); }});
  actions.add({"link.enable",
               "&Enable link",
               "Use the selected links again",
               "link",
               {},
               [&workspace] { setState(workspace, LinkState::Active); },
               [&workspace] { return anyLinkIn(workspace, LinkState::Disabled); }});
  actions.add({"link.accept",
               "&Accept link",
               "Vouch for the selected links: registering again leaves them as they are",
               "dialog-ok",
               {},
               [&workspace] {
                 (void)workspace.session().apply(
                     acceptLinksEdit(*workspace.snapshot(), workspace.selection().links()));
               },
               [&workspace] {
                 return workspace.session().isWritable() && !workspace.jobs().busy() &&
                        !acceptLinksEdit(*workspace.snapshot(), workspace.selection().links()).empty();
               }});
  actions.add(
      {"link.register",
       "Re&gister again…",
       "Register the selected links' scans once more",
       "view-refresh",
       {},
       [&window, &workspace] {
         window.showOperation("register", {{"pairs", utf8(selectedPairs(workspace))}});
       },
       [&workspace] { return workspace.session().isWritable() && !workspace.selection().links().empty(); }});
  actions.add(
      {"link.show",
       "&Show both scans",
       "Show the scans of the selected links only",
       "view-visible",
       {},
       [&workspace] {
         const SnapshotPtr snapshot = workspace.snapshot();
         std::vector<ScanId> scans;
         for (const LinkId id : workspace.selection().links())
           if (const Link* link = snapshot->findLink(id)) {
             scans.push_back(link->fixed);
             scans.push_back(link->moving);
           }
         workspace.display().showOnly(scans);
       },
       [&workspace] { return workspace.session().isOpen() && !workspace.selection().links().empty(); }});
}

}  // namespace tiltmap::ui
