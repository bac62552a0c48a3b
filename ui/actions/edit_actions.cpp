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

// The selected scans together, to before the one above the first or behind the one below the last.
void moveSelected(Workspace& workspace, int by) {
  const SnapshotPtr snapshot = workspace.snapshot();
  const std::vector<ScanId>& moved = workspace.selection().scans();
  std::optional<std::size_t> first, last;
  for (const ScanId scan : moved)
    if (const auto index = snapshot->indexOf(scan)) {
      first = std::min(first.value_or(*index), *index);
      last = std::max(last.value_or(*index), *index);
    }
  if (!first) return;
  const std::size_t place = by < 0 ? (*first == 0 ? 0 : *first - 1) : *last + 2;
  const ProjectEdit edit = reorderEdit(*snapshot, moved, std::min(place, snapshot->scans().size()));
  if (!edit.empty()) (void)workspace.session().apply(edit);
}

void rebaseOnCurrent(Workspace& workspace) {
  const auto edit = rebaseEdit(workspace.snapshot(), *workspace.selection().currentScan(), Pose());
  if (edit)
    (void)workspace.session().apply(*edit);
  else
    workspace.messages().error(edit.error());
}

}  // namespace

void addEditActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  const auto free = [&workspace] { return workspace.session().isWritable() && !workspace.jobs().busy(); };
  const auto oneScan = [&workspace, free] {
    return free() && workspace.selection().currentScan().has_value();
  };

  const auto someScans = [&workspace, free] { return free() && !workspace.selection().scans().empty(); };

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
  actions.add({"edit.photograph",
               "Add photogra&phs…",
               "Put photographs of the selected stop into the project",
               "camera-photo",
               {},
               [&window] { window.addPhotographs(); },
               [&workspace, free] { return free() && !workspace.snapshot()->scans().empty(); }});
  actions.add({"edit.colour", "Co&lour…",
               "Give the selected scans a colour of their own in every view and picture", "color-picker",
               QKeySequence("Ctrl+Shift+C"), [&window] { window.showColours(); }, someScans});
  actions.add(
      {"edit.colour-default",
       "Colour b&y place",
       "The selected scans have the colour of their place in the survey again",
       "edit-reset",
       {},
       [&workspace] {
         (void)workspace.session().apply(
             colourEdit(*workspace.snapshot(), workspace.selection().scans(), std::nullopt));
       },
       [&workspace, someScans] {
         return someScans() &&
                !colourEdit(*workspace.snapshot(), workspace.selection().scans(), std::nullopt).empty();
       }});
  actions.add(
      {"edit.rebase",
       "Make it the &origin",
       "Move the poses of every stage as a rigid whole until the selected scan stands at the world's origin",
       "crosshairs",
       {},
       [&workspace] { rebaseOnCurrent(workspace); },
       oneScan});
  actions.add({"edit.survey",
               "&Survey data…",
               "Site, operator, device and date, as they stand in the report",
               "document-properties",
               {},
               [&window] { window.showSurvey(); },
               free});
  actions.add(
      {"edit.delete", "&Delete", "Take the selected scans or links out of the project; undo brings them back",
       "edit-delete", QKeySequence::Delete, [&workspace] { deleteSelected(workspace); },
       [&workspace, free] {
         return free() && !(workspace.selection().scans().empty() && workspace.selection().links().empty());
       }});
  actions.add({"edit.move-up", "Move &up", "The selected scans come earlier in the survey's order", "go-up",
               QKeySequence("Alt+Up"), [&workspace] { moveSelected(workspace, -1); }, someScans});
  actions.add({"edit.move-down", "Move d&own", "The selected scans come later in the survey's order",
               "go-down", QKeySequence("Alt+Down"), [&workspace] { moveSelected(workspace, 1); }, someScans});
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
