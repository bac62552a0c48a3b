#include <QApplication>
#include <QClipboard>
#include <QDesktopServices>
#include <QFileInfo>
#include <QUrl>

#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/log.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

void addHelpActions(ActionRegistry& actions, WindowCommands& window) {
  actions.add(
      {"help.log-folder",
       "Open the &log's folder",
       "The log file is what to send along with a report of a fault",
       "folder-open",
       {},
       [] { QDesktopServices::openUrl(QUrl::fromLocalFile(QFileInfo(logFilePath()).absolutePath())); },
       [] { return !logFilePath().isEmpty(); }});
  actions.add({"help.copy-log-path",
               "&Copy the log's path",
               "Put the path of the log file on the clipboard",
               "edit-copy",
               {},
               [&window] {
                 QApplication::clipboard()->setText(logFilePath());
                 window.workspace().messages().note("Copied: " + logFilePath());
               },
               [] { return !logFilePath().isEmpty(); }});
  actions.add({"help.shortcuts", "&Shortcuts", "Every action with its keys, and what it does",
               "input-keyboard", QKeySequence("Ctrl+F1"), [&window] { window.showShortcuts(); }});
  actions.add({"help.about",
               "&About Tiltmap",
               "Version, and the libraries with their licences",
               "help-about",
               {},
               [&window] { window.showAbout(); }});
}

}  // namespace tiltmap::ui
