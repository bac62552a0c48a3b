#include "ui/actions/capture_actions.h"

#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/capture_model.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

void addCaptureActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  actions.add({"capture.open", "Capture with &instruments",
               "Connect scanner and tilt unit, see what they see, and capture stop after stop", "tilt-unit",
               QKeySequence("Ctrl+Shift+K"),
               [&window] {
                 window.setPerspective(Perspective::Capture);
                 window.showPanel("capture");
               },
               [&workspace] { return workspace.session().isOpen(); }});
  // Always there: what is stopped may have been begun before anything was shown.
  actions.add({"capture.stop",
               "S&top the instruments",
               "Stop whatever the instruments do; every line that is complete is kept",
               "process-stop",
               QKeySequence(Qt::Key_F12),
               [&workspace] { captureModel(workspace).stop(); },
               {}});
}

}  // namespace tiltmap::ui
