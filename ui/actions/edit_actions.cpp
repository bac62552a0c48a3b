// Undo, redo, and what is done to the selected scans by hand.
#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/edits.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

// Links and scans are selected apart; what was selected last in the tree is what Delete means.
void deleteSelected(Workspace& workspace) {
  const SnapshotPtr snapshot = workspace.snapshot();
  const Selection& selection = workspace.selection();
  const ProjectEdit edit = !selection.links().empty() ? deleteLinksEdit(*snapshot, selection.links())
                                                      : deleteEdit(*snapshot, selection.scans());
  (void)workspace.session().apply(edit);
}

void moveSelected(Workspace& workspace, int by) {
  const SnapshotPtr snapshot = workspace.snapshot();
  const auto current = workspace.selection().currentScan();
  const auto index = current ? snapshot->indexOf(*current) : std::nullopt;
  if (!index) return;
  const auto place = by < 0 ? (*index == 0 ? 0 : *index - 1) : *index + 2;
  const ProjectEdit edit = reorderEdit(*snapshot, {*current}, std::min(place, snapshot->scans().size()));
  if (!edit.empty()) (void)workspace.session().apply(edit);
}

}  // namespace

void addEditActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  const auto free = [&workspace] { return workspace.session().isWritable() && !workspace.jobs().busy(); };
  const auto oneScan = [&workspace, free] {
    return free() && workspace.selection().currentScan().has_value();
  };

  actions.add({"edit.undo",
               "&Undo",
               "Take the last edit back; the project file keeps the history",
               "edit-undo",
               QKeySequence::Undo,
               [&workspace] { (void)workspace.session().undo(); },
               [&workspace, free] { return free() && workspace.session().canUndo(); },
               {},
               [&workspace] {
                 const QString title = workspace.session().undoTitle();
                 return title.isEmpty() ? QString("&Undo") : "&Undo " + title;
               }});
  actions.add({"edit.redo",
               "&Redo",
               "Bring back what was undone last",
               "edit-redo",
               QKeySequence("Ctrl+Shift+Z"),
               [&workspace] { (void)workspace.session().redo(); },
               [&workspace, free] { return free() && workspace.session().canRedo(); },
               {},
               [&workspace] {
                 const QString title = workspace.session().redoTitle();
                 return title.isEmpty() ? QString("&Redo") : "&Redo " + title;
               }});
  actions.add({"edit.rename", "Re&name scan", "Give the selected scan another name", "edit-rename",
               QKeySequence(Qt::Key_F2), [&window] { window.beginRename(); }, oneScan});
  actions.add({"edit.note", "Edit no&te", "Write a note about the selected scan", "document-edit",
               QKeySequence("Ctrl+T"), [&window] { window.beginNote(); }, oneScan});
  actions.add(
      {"edit.delete", "&Delete", "Take the selected scans or links out of the project; undo brings them back",
       "edit-delete", QKeySequence::Delete, [&workspace] { deleteSelected(workspace); },
       [&workspace, free] {
         return free() && !(workspace.selection().scans().empty() && workspace.selection().links().empty());
       }});
  actions.add({"edit.move-up", "Move &up", "The selected scan comes earlier in the survey's order", "go-up",
               QKeySequence("Alt+Up"), [&workspace] { moveSelected(workspace, -1); }, oneScan});
  actions.add({"edit.move-down", "Move d&own", "The selected scan comes later in the survey's order",
               "go-down", QKeySequence("Alt+Down"), [&workspace] { moveSelected(workspace, 1); }, oneScan});
  actions.add({"edit.select-all", "Select &all scans", "Select every scan of the project", "edit-select-all",
               QKeySequence("Ctrl+Shift+A"),
               [&workspace] {
                 std::vector<ScanId> all;
                 for (const ScanEntry& scan : workspace.snapshot()->scans()) all.push_back(scan.id);
                 workspace.selection().setScans(std::move(all), workspace.selection().currentScan());
               },
               [&workspace] { return workspace.session().isOpen(); }});
  actions.add({"edit.preferences", "&Preferences…", "Theme, units, threads", "configure",
               QKeySequence("Ctrl+,"), [&window] { window.showPreferences(); }});
}

}  // namespace tiltmap::ui
