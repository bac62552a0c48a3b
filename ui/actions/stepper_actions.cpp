// The ICP stepper by menu, key and palette.
#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

// The selected link's scans, else two selected scans in the survey's order, else what is chosen already.
void chooseSelected(Workspace& workspace) {
  const SnapshotPtr snapshot = workspace.snapshot();
  if (!workspace.selection().links().empty())
    if (const Link* link = snapshot->findLink(workspace.selection().links().front()))
      return workspace.stepper().choose(link->fixed, link->moving);
  std::vector<ScanId> scans = workspace.selection().scans();
  if (scans.size() != 2) return;
  if (*snapshot->indexOf(scans[1]) < *snapshot->indexOf(scans[0])) std::swap(scans[0], scans[1]);
  workspace.stepper().choose(scans[0], scans[1]);
}

}  // namespace

void addStepperActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  StepperModel& stepper = workspace.stepper();
  actions.add(
      {"stepper.open", "&Step through a pair",
       "Register two scans one iteration after the other; the selected link or the two selected scans",
       "register-pair", QKeySequence("Ctrl+Shift+I"),
       [&window, &workspace] {
         chooseSelected(workspace);
         window.setPerspective(Perspective::Register);
         window.showPanel("stepper-view");
         window.showPanel("stepper-plots");
         window.showPanel("stepper");
       },
       [&workspace] { return workspace.session().isOpen(); }});
  actions.add({"stepper.step", "Step &forward", "One iteration of the ICP stepper forward", "go-next",
               QKeySequence(Qt::Key_F8), [&stepper] { stepper.step(); },
               [&stepper] { return stepper.canStep(); }});
  actions.add({"stepper.back", "Step &back", "One iteration of the ICP stepper back", "go-previous",
               QKeySequence("Shift+F8"), [&stepper] { stepper.back(); },
               [&stepper] { return stepper.canGoBack(); }});
  actions.add(
      {"stepper.run",
       "&Run",
       "Run the ICP stepper to the end, or pause it",
       "media-playback-start",
       QKeySequence(Qt::Key_F9),
       [&stepper] { stepper.isRunning() ? stepper.pause() : stepper.run(); },
       [&stepper] { return stepper.isRunning() || stepper.canStep(); },
       {},
       [&stepper] { return stepper.isRunning() ? QString("Pause stepping") : QString("Run to the end"); }});
  actions.add({"stepper.accept",
               "&Accept the pair",
               "Store the stepper's result as a link",
               "dialog-ok",
               {},
               [&stepper] { (void)stepper.accept(); },
               [&stepper] { return stepper.canAccept(); }});
  actions.add({"stepper.discard",
               "&Discard the iterations",
               "Throw the stepper's iterations away",
               "edit-clear",
               {},
               [&stepper] { stepper.discard(); },
               [&stepper] { return stepper.count() > 0 || stepper.isWorking(); }});
}

}  // namespace tiltmap::ui
