// The menus and the tool bar of the main window: only which action stands where.
#include <QFileInfo>
#include <QMenu>
#include <QMenuBar>
#include <QToolBar>
#include <QToolButton>
#include <QWidgetAction>

#include "ui/models/strings.h"
#include "ui/panels/panel.h"
#include "ui/window/main_window.h"

namespace tiltmap::ui {

namespace {

void fill(QMenu* menu, const ActionRegistry& actions, const QStringList& ids) {
  menu->setToolTipsVisible(true);
  for (const QString& id : ids)
    if (id.isEmpty())
      menu->addSeparator();
    else if (QAction* action = actions.find(id))
      menu->addAction(action);
}

// Operations that no menu names (new ones) come where they are seen: under Register.
QStringList otherOperations() {
  static const QStringList kPlaced = {"simulate", "capture",   "import",   "register", "relax",
                                      "export",   "rebase",    "rename",   "report",   "picture",
                                      "merge",    "calibrate", "body-mask"};
  QStringList ids;
  for (const Operation* operation : operations().all())
    if (!kPlaced.contains(qt(operation->id()))) ids << "op." + qt(operation->id());
  return ids;
}

}  // namespace

void MainWindow::makeMenus() {
  QMenu* project = menuBar()->addMenu("&Project");
  fill(project, actions_, {"file.new", "file.open"});
  QMenu* recent = project->addMenu("Open &recent");
  recent->setObjectName("recent-menu");
  connect(recent, &QMenu::aboutToShow, this, [this, recent] { fillRecent(recent); });
  fill(project, actions_,
       {"file.demo", "", "op.import", "op.simulate", "op.merge", "", "file.save-as", "file.copy",
        "file.refresh", "file.compact", "file.verify", "", "file.close", "file.new-window", "file.quit"});
  fill(menuBar()->addMenu("&Edit"), actions_,
       {"edit.undo", "edit.redo", "", "edit.rename", "edit.note", "edit.photograph", "edit.colour",
        "edit.colour-default", "edit.move-up", "edit.move-down", "edit.rebase", "edit.delete", "",
        "edit.survey", "", "edit.select-all", "", "edit.preferences"});
  QMenu* view = menuBar()->addMenu("&View");
  fill(view, actions_,
       {"perspective.capture", "perspective.inspect", "perspective.register", "perspective.relax", ""});
  QMenu* panel_menu = view->addMenu("&Panels");
  for (const PanelInfo& panel : panels()) fill(panel_menu, actions_, {"panel." + panel.id});
  fill(panel_menu, actions_, {"", "view.reset-layout"});
  QMenu* stage = view->addMenu("&Stage shown");
  fill(stage, actions_,
       {"stage.latest", "", "stage.truth", "stage.odometry", "stage.pairwise", "stage.relaxed", "",
        "stage.clear"});
  fill(view, actions_, {"", "view.show-all", "view.show-only", "view.show", "view.hide", "", "view.palette"});
  fill(menuBar()->addMenu("&Capture"), actions_,
       {"capture.open", "capture.stop", "", "file.capture", "op.capture", "", "panel.calibration",
        "op.calibrate", "op.body-mask", "", "op.import", "op.simulate"});
  QMenu* registering = menuBar()->addMenu("&Register");
  fill(registering, actions_, {"op.register", "op.rebase"});
  fill(registering, actions_, otherOperations());
  fill(registering, actions_,
       {"", "stepper.open", "stepper.step", "stepper.back", "stepper.run", "stepper.accept",
        "stepper.discard"});
  fill(registering, actions_,
       {"", "link.show", "link.register", "link.accept", "link.disable", "link.enable"});
  fill(menuBar()->addMenu("Re&lax"), actions_,
       {"op.relax", "", "panel.relax", "panel.sitemap", "panel.links", "", "job.cancel"});
  fill(menuBar()->addMenu("E&xport"), actions_,
       {"op.export", "op.report", "op.picture", "panel.localisation"});
  fill(menuBar()->addMenu("&Help"), actions_,
       {"view.palette", "help.shortcuts", "", "help.log-folder", "help.copy-log-path", "", "help.about"});
}

void MainWindow::makeToolBar() {
  QToolBar* bar = addToolBar("Tools");
  bar->setObjectName("tools");
  bar->setMovable(false);
  bar->setFloatable(false);
  bar->setIconSize(QSize(20, 20));
  const QStringList ids = {"file.open", "op.import",   "",         "edit.undo", "edit.redo",
                           "",          "op.register", "op.relax", "op.export"};
  for (const QString& id : ids)
    if (id.isEmpty())
      bar->addSeparator();
    else if (QAction* action = actions_.find(id))
      bar->addAction(action);
  auto* space = new QWidget(bar);
  space->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  bar->addWidget(space);
  for (const Perspective perspective : kPerspectives) {
    QAction* action = actions_.get("perspective." + perspectiveName(perspective).toLower());
    bar->addAction(action);
    if (auto* button = qobject_cast<QToolButton*>(bar->widgetForAction(action)))
      button->setToolButtonStyle(Qt::ToolButtonTextOnly);
  }
  bar->addSeparator();
  bar->addAction(actions_.get("view.palette"));
  for (QAction* action : bar->actions())
    if (auto* button = qobject_cast<QToolButton*>(bar->widgetForAction(action)))
      button->setFocusPolicy(Qt::TabFocus);
}

void MainWindow::fillRecent(QMenu* menu) {
  menu->clear();
  int number = 1;
  for (const QString& path : preferences_.recentFiles()) {
    const QFileInfo file(path);
    QAction* action = menu->addAction(QString("&%1  %2").arg(number++).arg(file.completeBaseName()));
    action->setToolTip(path);
    action->setEnabled(file.exists());
    connect(action, &QAction::triggered, this, [this, path] { (void)workspace_->session().open(path); });
  }
  menu->setToolTipsVisible(true);
  if (menu->isEmpty()) menu->addAction("None yet")->setEnabled(false);
  menu->addSeparator();
  connect(menu->addAction("&Forget these"), &QAction::triggered, &preferences_,
          &Preferences::clearRecentFiles);
}

}  // namespace tiltmap::ui
