#include "ui/window/main_window.h"

#include <QCloseEvent>
#include <QDragEnterEvent>
#include <QFileInfo>
#include <QGuiApplication>
#include <QMimeData>
#include <QScreen>
#include <QStackedWidget>
#include <QVBoxLayout>

#include "ui/actions/capture_actions.h"
#include "ui/look/icons.h"
#include "ui/look/theme.h"
#include "ui/models/photograph_model.h"
#include "ui/models/strings.h"
#include "ui/panels/calibration_panel.h"
#include "ui/panels/details_panel.h"
#include "ui/panels/photographs_panel.h"
#include "ui/panels/project_tree_panel.h"
#include "ui/window/about_dialog.h"
#include "ui/window/colour_dialog.h"
#include "ui/window/command_palette.h"
#include "ui/window/dock_area.h"
#include "ui/window/job_bar.h"
#include "ui/window/message_bar.h"
#include "ui/window/operation_dialog.h"
#include "ui/window/preferences_dialog.h"
#include "ui/window/shortcuts_dialog.h"
#include "ui/window/start_page.h"
#include "ui/window/survey_dialog.h"

namespace tiltmap::ui {

MainWindow::MainWindow(Preferences& preferences, const Theme& theme, QWidget* parent)
    : QMainWindow(parent),
      preferences_(preferences),
      theme_(theme),
      workspace_(std::make_unique<Workspace>(preferences)) {
  setObjectName("main-window");
  setAttribute(Qt::WA_DeleteOnClose);
  setAcceptDrops(true);
  setContextMenuPolicy(Qt::NoContextMenu);
  setWindowIcon(icon("tiltmap"));
  addActions();
  docks_ = new DockArea({*workspace_, actions_, theme_}, this);
  start_page_ = new StartPage(*workspace_, actions_, this);
  message_bar_ = new MessageBar(workspace_->messages(), actions_, theme_, this);
  pages_ = new QStackedWidget(this);
  pages_->addWidget(start_page_);
  pages_->addWidget(docks_);
  auto* centre = new QWidget(this);
  auto* layout = new QVBoxLayout(centre);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(message_bar_);
  layout->addWidget(pages_, 1);
  layout->addWidget(new JobBar(*workspace_, this));
  setCentralWidget(centre);
  palette_ = new CommandPalette(actions_, this);
  makeMenus();
  makeToolBar();

  const auto refresh = [this] { actions_.scheduleRefresh(); };
  connect(&workspace_->session(), &ProjectSession::snapshotReplaced, this, refresh);
  connect(&workspace_->selection(), &Selection::scansChanged, this, refresh);
  connect(&workspace_->selection(), &Selection::linksChanged, this, refresh);
  connect(&workspace_->display(), &ScanDisplay::stageChanged, this, refresh);
  connect(&workspace_->jobs(), &JobQueue::busyChanged, this, refresh);
  connect(&workspace_->stepper(), &StepperModel::stateChanged, this, refresh);
  connect(docks_, &DockArea::panelsChanged, this, refresh);
  connect(docks_, &DockArea::perspectiveChanged, this, refresh);
  connect(&workspace_->session(), &ProjectSession::opened, this, &MainWindow::showProject);
  connect(&workspace_->session(), &ProjectSession::closed, this, &MainWindow::showProject);
  connect(&workspace_->jobs(), &JobQueue::busyChanged, this, &MainWindow::refreshTitle);
  restoreWindow();
  showProject();
  actions_.refresh();
}

MainWindow::~MainWindow() {
  // Panels and models hear of nothing any more while they go.
  disconnect(&workspace_->session(), nullptr, this, nullptr);
  disconnect(&workspace_->jobs(), nullptr, this, nullptr);
  workspace_->jobs().cancelAll();
  delete centralWidget();
}

void MainWindow::addActions() {
  addFileActions(actions_, *this);
  addEditActions(actions_, *this);
  addOperationActions(actions_, *this);
  addLinkActions(actions_, *this);
  addStepperActions(actions_, *this);
  addCaptureActions(actions_, *this);
  addViewActions(actions_, *this);
  addHelpActions(actions_, *this);
  for (QAction* action : actions_.all()) addAction(action);
}

void MainWindow::restoreWindow() {
  // With its frame inside the screen, where that is a small one.
  const QRect screen = QGuiApplication::primaryScreen()->availableGeometry();
  resize(QSize(1366, 768).boundedTo(screen.size() - QSize(8, 40)));
  restoreGeometry(preferences_.bytes("window/geometry"));
  const QString name = preferences_.text("window/perspective", "inspect");
  for (const Perspective perspective : kPerspectives)
    if (perspectiveName(perspective).toLower() == name) docks_->setPerspective(perspective);
}

void MainWindow::showProject() {
  const bool open = workspace_->session().isOpen();
  pages_->setCurrentWidget(open ? static_cast<QWidget*>(docks_) : start_page_);
  refreshTitle();
  if (!open || workspace_->session().isWritable()) return;
  QString reason = "Nothing can be written there";
  if (const auto& why = workspace_->session().whyReadOnly()) reason = qt(why->what);
  reason[0] = reason[0].toUpper();
  workspace_->messages().show(
      {MessageKind::Warning,
       "This project is open for reading only.",
       reason + ". Save it under another name to go on; Read again shows what its writer has stored.",
       {},
       "file.save-as"});
}

void MainWindow::refreshTitle() {
  const ProjectSession& session = workspace_->session();
  if (!session.isOpen()) return setWindowTitle("Tiltmap");
  QString title = session.name();
  if (!session.isWritable()) title += " (read only)";
  if (workspace_->jobs().busy()) title += " (working)";
  setWindowTitle(title + " - Tiltmap");
  setWindowFilePath(session.path());
}

void MainWindow::showOperation(const QString& operation, const ParameterValues& values) {
  const Operation* found = operations().find(utf8(operation));
  if (!found) return;
  QPointer<OperationDialog>& dialog = operation_dialogs_[operation];
  if (!dialog) {
    dialog = new OperationDialog(*found, *workspace_, theme_, this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    // Where it is watched, compared and decided.
    connect(dialog, &OperationDialog::proposalStarted, this, [this, operation] {
      showPanel(operation == "relax" ? "relax" : "calibration");
      if (auto* panel = qobject_cast<CalibrationPanel*>(docks_->panel("calibration")))
        panel->showPage(operation);
    });
  }
  dialog->setValues(values);
  dialog->show();
  dialog->raise();
  dialog->activateWindow();
}

OperationDialog* MainWindow::operationDialog(const QString& operation) const {
  const auto found = operation_dialogs_.find(operation);
  return found == operation_dialogs_.end() ? nullptr : found->second.data();
}

void MainWindow::showPanel(const QString& panel) {
  docks_->showPanel(panel);
}
void MainWindow::togglePanel(const QString& panel) {
  docks_->togglePanel(panel);
}
bool MainWindow::isPanelShown(const QString& panel) const {
  return docks_ && docks_->isShown(panel);
}
Perspective MainWindow::perspective() const {
  return docks_ ? docks_->perspective() : Perspective::Inspect;
}
void MainWindow::setPerspective(Perspective perspective) {
  docks_->setPerspective(perspective);
}
void MainWindow::resetLayout() {
  docks_->resetLayout();
}
void MainWindow::showCommandPalette() {
  palette_->popUp();
}

namespace {

template <class Dialog, class Make>
void showOne(QPointer<QDialog>& dialog, const Make& make) {
  if (!dialog) {
    dialog = make();
    dialog->setAttribute(Qt::WA_DeleteOnClose);
  }
  dialog->show();
  dialog->raise();
  dialog->activateWindow();
}

}  // namespace

void MainWindow::showPreferences() {
  showOne<QDialog>(preferences_dialog_, [this] { return new PreferencesDialog(preferences_, this); });
}

void MainWindow::showAbout() {
  showOne<QDialog>(about_dialog_, [this] { return new AboutDialog(this); });
}

void MainWindow::showShortcuts() {
  showOne<QDialog>(shortcuts_dialog_, [this] { return new ShortcutsDialog(actions_, this); });
}

void MainWindow::showColours() {
  showOne<QDialog>(colour_dialog_, [this] { return new ColourDialog(*workspace_, this); });
}

void MainWindow::showSurvey() {
  showOne<QDialog>(survey_dialog_, [this] { return new SurveyDialog(*workspace_, this); });
}

void MainWindow::newWindow() {
  auto* window = new MainWindow(preferences_, theme_);
  window->move(pos() + QPoint(32, 32));
  window->show();
}

void MainWindow::beginRename() {
  showPanel("project-tree");
  if (auto* tree = qobject_cast<ProjectTreePanel*>(docks_->panel("project-tree"))) tree->beginRename();
}

void MainWindow::beginNote() {
  showPanel("details");
  if (auto* details = qobject_cast<DetailsPanel*>(docks_->panel("details"))) details->beginNote();
}

void MainWindow::addPhotographs() {
  showPanel("photographs");
  if (auto* panel = qobject_cast<PhotographsPanel*>(docks_->panel("photographs"))) panel->askForFilesToAdd();
}

void MainWindow::closeNow() {
  workspace_->jobs().cancelAll();
  close();
}

void MainWindow::closeEvent(QCloseEvent* event) {
  // The second time is meant.
  const bool asked = message_bar_->isVisible() && message_bar_->message().action == "file.quit-cancelling";
  if (workspace_->jobs().busy() && !asked) {
    const JobStatus* job = workspace_->jobs().current();
    const bool waits = job && job->phase == JobPhase::Waiting;
    const int queued = workspace_->jobs().queued();
    QString text = (job ? job->title : QString("Work")) +
                   (waits ? " waits to be accepted or discarded." : " is not finished.");
    if (queued > 0) text += QString(" %1 more %2 in the queue.").arg(queued).arg(queued == 1 ? "is" : "are");
    workspace_->messages().show(
        {MessageKind::Warning,
         text,
         QString("Closing now %1 it, and the project stays as it was before. Everything "
                 "that was accepted is stored.")
             .arg(waits ? "discards" : "cancels"),
         {},
         "file.quit-cancelling"});
    event->ignore();
    return;
  }
  workspace_->jobs().cancelAll();
  preferences_.setBytes("window/geometry", saveGeometry());
  preferences_.setText("window/perspective", perspectiveName(docks_->perspective()).toLower());
  docks_->saveLayout();
  preferences_.sync();
  workspace_->session().close();
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (event->mimeData()->hasUrls()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
  QStringList files;
  for (const QUrl& url : event->mimeData()->urls())
    if (url.isLocalFile()) files << url.toLocalFile();
  event->acceptProposedAction();
  openDropped(files);
}

void MainWindow::openDropped(const QStringList& files) {
  QStringList scans, pictures;
  for (const QString& file : files) {
    if (file.endsWith(".tiltmap")) {
      (void)workspace_->session().open(file);
      return;
    }
    (isPictureName(file) ? pictures : scans) << file;
  }
  if (files.isEmpty()) return;
  if (!workspace_->session().isWritable()) {
    workspace_->messages().show({MessageKind::Error,
                                 "Nothing can be added: no project is open for writing.",
                                 "Make a project, then drop them again.",
                                 {},
                                 "file.new"});
    return;
  }
  if (auto* panel = qobject_cast<PhotographsPanel*>(docks_->panel("photographs"));
      panel && !pictures.isEmpty()) {
    showPanel("photographs");
    panel->add(pictures);
  }
  if (scans.isEmpty()) return;
  scans.sort();
  showOperation("import", {{"files", utf8(scans.join('\n'))}});
}

}  // namespace tiltmap::ui
