// One action for every operation of the program: a new one is in menus and palette without a line here.
#include <algorithm>
#include <map>

#include "core/project/operation.h"
#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

struct OperationLook {
  QString icon;
  QString shortcut;
  bool changes = true;  // needs a project that can be written
};

const std::map<std::string, OperationLook>& looks() {
  static const std::map<std::string, OperationLook> known = {
      {"simulate", {"tilt-unit", "", true}},
      {"import", {"document-import", "Ctrl+I", true}},
      {"register", {"register-pair", "Ctrl+R", true}},
      {"relax", {"relax", "Ctrl+L", true}},
      {"export", {"document-export", "Ctrl+E", false}},
      {"rebase", {"crosshairs", "", true}},
      {"merge", {"list-add", "", true}},
      {"judge", {"dialog-ok-apply", "", true}},
  };
  return known;
}

}  // namespace

void addOperationActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  for (const Operation* operation : operations().all()) {
    if (operation->id() == "rename") continue;  // done in place
    const auto found = looks().find(operation->id());
    const OperationLook look = found == looks().end() ? OperationLook{"system-run", "", true} : found->second;
    const QString id = qt(operation->id());
    actions.add({"op." + id, "&" + qt(operation->title()) + "…", qt(operation->help()), look.icon,
                 QKeySequence(look.shortcut), [&window, id] { window.showOperation(id); },
                 [&workspace, changes = look.changes] {
                   return changes ? workspace.session().isWritable() : workspace.session().isOpen();
                 }});
  }
  actions.add({"job.cancel", "&Cancel the work", "Stop what is running; the project stays as it is",
               "process-stop", QKeySequence("Ctrl+."),
               [&workspace] {
                 if (const JobStatus* job = workspace.jobs().current()) workspace.jobs().cancel(job->id);
               },
               [&workspace] { return workspace.jobs().current() != nullptr; }});
}

}  // namespace tiltmap::ui
