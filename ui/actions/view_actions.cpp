// Perspectives, panels, which scans and which stage are shown.
#include "core/project/stage.h"
#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/edits.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/panel.h"

namespace tiltmap::ui {

namespace {

void addPerspectiveActions(ActionRegistry& actions, WindowCommands& window) {
  int key = 1;
  for (const Perspective perspective : kPerspectives) {
    const QString name = perspectiveName(perspective);
    actions.add({"perspective." + name.toLower(),
                 "&" + name,
                 perspectiveHelp(perspective),
                 {},
                 QKeySequence(QString("Ctrl+%1").arg(key++)),
                 [&window, perspective] { window.setPerspective(perspective); },
                 [&window] { return window.workspace().session().isOpen(); },
                 [&window, perspective] { return window.perspective() == perspective; }});
  }
  actions.add({"view.reset-layout",
               "Panels as &delivered",
               "Put the panels of this perspective back in their places",
               "view-restore",
               {},
               [&window] { window.resetLayout(); },
               [&window] { return window.workspace().session().isOpen(); }});
}

void addPanelActions(ActionRegistry& actions, WindowCommands& window) {
  for (const PanelInfo& panel : panels())
    actions.add({"panel." + panel.id,
                 "&" + panel.title,
                 panel.help,
                 panel.icon,
                 {},
                 [&window, id = panel.id] { window.togglePanel(id); },
                 [&window] { return window.workspace().session().isOpen(); },
                 [&window, id = panel.id] { return window.isPanelShown(id); }});
}

void addVisibilityActions(ActionRegistry& actions, Workspace& workspace) {
  const auto open = [&workspace] { return workspace.session().isOpen(); };
  const auto some = [&workspace] {
    return workspace.session().isOpen() && !workspace.selection().scans().empty();
  };
  actions.add({"view.show-all", "Show &all scans", "Make every scan visible", "view-visible",
               QKeySequence("Ctrl+Shift+H"), [&workspace] { workspace.display().showAll(); }, open});
  actions.add({"view.show-only", "Show &only the selected", "Hide every scan that is not selected",
               "view-filter", QKeySequence("Ctrl+H"),
               [&workspace] { workspace.display().showOnly(workspace.selection().scans()); }, some});
  actions.add({"view.hide", "&Hide the selected", "Hide the selected scans", "view-hidden",
               QKeySequence("Ctrl+Alt+H"),
               [&workspace] { workspace.display().setVisible(workspace.selection().scans(), false); }, some});
  actions.add({"view.show",
               "&Show the selected",
               "Make the selected scans visible",
               "view-visible",
               {},
               [&workspace] { workspace.display().setVisible(workspace.selection().scans(), true); },
               some});
}

void addStageActions(ActionRegistry& actions, Workspace& workspace) {
  actions.add({"stage.latest",
               "&Latest result",
               "Place the scans by the last stage there is, always",
               {},
               QKeySequence("Ctrl+Shift+0"),
               [&workspace] { workspace.display().setStage({}); },
               [&workspace] { return workspace.session().isOpen(); },
               [&workspace] { return !workspace.display().chosenStage(); }});
  actions.add({"stage.clear",
               "&Take these poses out",
               "Take the poses of the stage that is shown out of the project; undo brings them back",
               "edit-delete",
               {},
               [&workspace] { (void)workspace.session().apply(clearStageEdit(workspace.display().stage())); },
               [&workspace] {
                 return workspace.session().isWritable() && !workspace.jobs().busy() &&
                        workspace.display().stage() != Stage::Odometry;
               }});
  int key = 1;
  for (const Stage stage : kStages)
    actions.add(
        {"stage." + qt(stageName(stage)),
         "&" + stageTitle(stage),
         stageTip(stage),
         {},
         QKeySequence(QString("Ctrl+Shift+%1").arg(key++)),
         [&workspace, stage] { workspace.display().setStage(stage); },
         [&workspace, stage] { return workspace.snapshot() && workspace.snapshot()->hasStage(stage); },
         [&workspace, stage] { return workspace.display().chosenStage() == stage; }});
}

}  // namespace

void addViewActions(ActionRegistry& actions, WindowCommands& window) {
  addPerspectiveActions(actions, window);
  addPanelActions(actions, window);
  addVisibilityActions(actions, window.workspace());
  addStageActions(actions, window.workspace());
  actions.add({"view.palette", "&Command palette…",
               "Find and run any action by a few letters of its name or help", "system-search",
               QKeySequence("Ctrl+K"), [&window] { window.showCommandPalette(); }});
}

}  // namespace tiltmap::ui
