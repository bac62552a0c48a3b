// Projects: new, open, save as, copy, compact, check, close.
#include <QApplication>
#include <QFileInfo>
#include <QStandardPaths>
#include <QWidget>

#include "core/project/operations/merge_operation.h"
#include "ui/actions/action_registry.h"
#include "ui/actions/demo_project.h"
#include "ui/actions/window_commands.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

void askNew(WindowCommands& window, Perspective then) {
  askForFiles(window.widget(), window.workspace().preferences(),
              {FileQuestion::Save, "New project", kProjectFilter, "tiltmap", "projects", "survey.tiltmap"},
              [&window, then](const QStringList& files) {
                if (window.workspace().session().create(files.front())) window.setPerspective(then);
              });
}

void askOpen(WindowCommands& window) {
  askForFiles(
      window.widget(), window.workspace().preferences(),
      {FileQuestion::OpenOne, "Open project", kProjectFilter, {}, "projects", {}},
      [&window](const QStringList& files) { (void)window.workspace().session().open(files.front()); });
}

void askSaveAs(WindowCommands& window) {
  Workspace& workspace = window.workspace();
  askForFiles(window.widget(), workspace.preferences(),
              {FileQuestion::Save, "Save project as", kProjectFilter, "tiltmap", "projects",
               workspace.session().name() + "-copy.tiltmap"},
              [&workspace](const QStringList& files) {
                if (workspace.session().saveAs(files.front()))
                  workspace.messages().note("Going on in the copy, " + files.front() + ".");
              });
}

void askCopy(WindowCommands& window) {
  Workspace& workspace = window.workspace();
  askForFiles(
      window.widget(), workspace.preferences(),
      {FileQuestion::Save, "Save a copy of the project", kProjectFilter, "tiltmap", "projects",
       workspace.session().name() + "-copy.tiltmap"},
      [&workspace](const QStringList& files) {
        if (workspace.session().saveCopy(files.front()))
          workspace.messages().note("Copied to " + files.front() + "; this window stays with the original.");
      });
}

// Only what cannot be undone asks.
void askCompact(Workspace& workspace) {
  workspace.messages().show(
      {MessageKind::Warning,
       "Compacting ends undo.",
       "What was done before can then no longer be taken back, and deleted scans are gone.",
       {},
       "file.compact-now"});
}

void compact(Workspace& workspace) {
  QApplication::setOverrideCursor(Qt::WaitCursor);
  const auto report = workspace.session().compact();
  QApplication::restoreOverrideCursor();
  if (!report) return;
  const auto saved =
      report->bytes_before > report->bytes_after ? report->bytes_before - report->bytes_after : 0;
  workspace.messages().note(
      QString("Compacted: %1 given back, %2 left. What was done before can no longer be undone.")
          .arg(sizeText(saved), sizeText(report->bytes_after)));
}

// As a job: a project of many gigabytes takes a while.
void verify(Workspace& workspace) {
  JobRequest request;
  request.operation = &verifyOperation();
  const auto started = workspace.start(request);
  if (!started) return;
  const auto connection = std::make_shared<QMetaObject::Connection>();
  *connection = QObject::connect(
      &workspace.jobs(), &JobQueue::finished, &workspace,
      [&workspace, connection, job = *started](int finished) {
        if (finished != job) return;
        QObject::disconnect(*connection);
        const JobStatus* status = workspace.jobs().find(job);
        if (status && status->phase == JobPhase::Accepted)
          workspace.messages().note("Every page and every matrix of the project file is sound.");
      });
}

}  // namespace

void addFileActions(ActionRegistry& actions, WindowCommands& window) {
  Workspace& workspace = window.workspace();
  const ProjectSession& session = workspace.session();
  const auto open = [&session] { return session.isOpen(); };
  const auto idle = [&workspace] { return workspace.session().isWritable() && !workspace.jobs().busy(); };

  actions.add({"file.new", "&New project…", "Make an empty project file; everything is stored as you go",
               "document-new", QKeySequence::New, [&window] { askNew(window, Perspective::Inspect); }});
  actions.add({"file.open", "&Open project…", "Open a project file", "document-open", QKeySequence::Open,
               [&window] { askOpen(window); }});
  actions.add({"file.demo",
               "Open the &demo",
               "A simulated survey of 14 stops, made and registered the first time",
               "media-playback-start",
               {},
               [&window] { openDemo(window.workspace()); }});
  actions.add({"file.capture",
               "&Capture a survey…",
               "Make a project and bring its scans in, in the Capture perspective",
               "tilt-unit",
               {},
               [&window] { askNew(window, Perspective::Capture); }});
  actions.add({"file.save-as", "Save &as…", "Write the whole project elsewhere and go on in the copy",
               "document-save-as", QKeySequence("Ctrl+Shift+S"), [&window] { askSaveAs(window); }, open});
  actions.add({"file.copy",
               "Save a co&py…",
               "Write the whole project elsewhere, history included, and go on in this one",
               "edit-copy",
               {},
               [&window] { askCopy(window); },
               open});
  actions.add({"file.refresh", "&Read again",
               "For a project opened for reading: what its writer has stored since", "view-refresh",
               QKeySequence::Refresh, [&workspace] { (void)workspace.session().refresh(); },
               [&session] { return session.isOpen() && !session.isWritable(); }});
  actions.add({"file.compact",
               "Com&pact",
               "Give back the space of what was deleted; what was done before can then no longer be undone",
               "archive-insert",
               {},
               [&workspace] { askCompact(workspace); },
               idle});
  actions.add({"file.compact-now",
               "Compact now",
               "Give back the space of what was deleted, without asking; undo ends here",
               "archive-insert",
               {},
               [&workspace] { compact(workspace); },
               idle});
  actions.add({"file.verify",
               "Chec&k the file",
               "Read every page and every matrix of the project file",
               "dialog-ok-apply",
               {},
               [&workspace] { verify(workspace); },
               open});
  actions.add({"file.close", "&Close project", "Close the project; everything is stored already",
               "document-close", QKeySequence::Close, [&workspace] { workspace.session().close(); }, open});
  actions.add({"file.new-window", "New &window", "Another window, for another project", "window-new",
               QKeySequence("Ctrl+Shift+N"), [&window] { window.newWindow(); }});
  actions.add({"file.quit", "&Quit", "Close this window", "application-exit", QKeySequence("Ctrl+Q"),
               [&window] { window.widget()->close(); }});
  actions.add({"file.quit-cancelling",
               "Cancel and close",
               "Stop the work that is running, and close this window",
               "application-exit",
               {},
               [&window] { window.closeNow(); },
               [&workspace] { return workspace.jobs().busy(); }});
}

}  // namespace tiltmap::ui
