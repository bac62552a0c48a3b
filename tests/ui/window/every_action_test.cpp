// Every action of the window, run as its user would: by its keys where it has some, else from its menu, else
// from the command palette. Each row says what must have come of it.
#include <QClipboard>
#include <QDesktopServices>
#include <QDialog>
#include <QFileDialog>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QMenuBar>
#include <QPlainTextEdit>
#include <QUrl>
#include <set>

#include "tests/ui/support/held_operation.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/log.h"
#include "ui/models/strings.h"
#include "ui/panels/project_tree_panel.h"
#include "ui/window/command_palette.h"
#include "ui/window/operation_dialog.h"

namespace tiltmap::test {

using namespace ui;

// What would be handed to the desktop's file manager.
class UrlCatcher : public QObject {
  Q_OBJECT

 public:
  UrlCatcher() { QDesktopServices::setUrlHandler("file", this, "take"); }
  ~UrlCatcher() override { QDesktopServices::unsetUrlHandler("file"); }
  QUrl taken;

 public Q_SLOTS:
  void take(const QUrl& url) { taken = url; }
};

class EveryAction : public WindowTest, public ::testing::WithParamInterface<QString> {
 public:
  struct Row {
    QString id;
    std::function<void(EveryAction&)> prepare;
    std::function<bool(EveryAction&)> done;
  };
  static std::vector<Row> rows();
  // Those that come one a panel or one a perspective follow one rule.
  static std::vector<QString> ids() {
    std::vector<QString> all;
    for (const Row& row : rows()) all.push_back(row.id);
    for (const PanelInfo& panel : panels()) all.push_back("panel." + panel.id);
    return all;
  }

 protected:
  ~EveryAction() override {
    std::vector<MainWindow*> others;
    for (QWidget* widget : QApplication::topLevelWidgets())
      if (auto* other = qobject_cast<MainWindow*>(widget); other && other != window) others.push_back(other);
    for (const MainWindow* other : others) delete other;
    closeLogFile();
  }

  // Three registered scans, the middle one selected.
  void registered() {
    makeProject(3, true);
    workspace().selection().setCurrentScan(id(1));
    settle();
  }
  void linkSelected() {
    registered();
    workspace().selection().setScans({});
    workspace().selection().setLinks({snapshot().links()[0].id});
    settle();
  }
  void working() {
    registered();
    JobRequest request;
    request.operation = &held;
    ASSERT_TRUE(workspace().start(request));
    ASSERT_TRUE(waitUntil([this] { return held.runs == 1; }));
  }
  // As in a second program on one project.
  void readOnly() {
    makeProject(1);
    const QString path = workspace().session().path();
    workspace().session().close();
    writer = must(Project::open(pathOf(path), Access::ReadWrite));
    must(workspace().session().open(path));
    ASSERT_FALSE(workspace().session().isWritable());
  }
  bool asks(const QString& title) {
    for (const auto* dialog : window->findChildren<QFileDialog*>())
      if (dialog->isVisible() && dialog->windowTitle() == title) return true;
    return false;
  }
  bool shows(const QString& dialog) {
    const auto* found = window->findChild<QDialog*>(dialog);
    return found && found->isVisible() && !found->isModal();
  }
  std::vector<ScanId> order() { return scanIds(snapshot()); }

  void choose(QMenu* menu, QAction* action) {
    menu->popup(QPoint());
    settle();
    QTest::mouseClick(menu, Qt::LeftButton, {}, menu->actionGeometry(action).center());
    menu->hide();
    settle();
  }
  void chooseInPalette(QAction* action) {
    press(QKeySequence("Ctrl+K"));
    auto* palette = find<CommandPalette>("command-palette");
    auto* list = find<QListWidget>("palette-list", palette);
    QTest::keyClicks(find<QLineEdit>("palette-search", palette),
                     QString(action->text()).remove('&').remove(QString::fromUtf8("…")));
    for (int row = 0; row < list->count(); ++row) {
      if (list->item(row)->data(Qt::UserRole) != action->objectName()) continue;
      clickIndex(list, list->model()->index(row, 0));
      return;
    }
    ADD_FAILURE() << action->objectName().toStdString() << " is not in the palette";
  }
  void perform(const QString& id) {
    window->actions().refresh();
    QAction* action = window->actions().get(id);
    ASSERT_TRUE(action->isEnabled()) << id.toStdString();
    if (!action->shortcut().isEmpty()) return press(action->shortcut());
    for (QMenu* menu : window->menuBar()->findChildren<QMenu*>())
      if (menu->actions().contains(action)) return choose(menu, action);
    chooseInPalette(action);
  }

  HeldOperation held;
  UrlCatcher urls;
  std::unique_ptr<Project> writer;
  std::vector<ScanId> order_before;
};

std::vector<EveryAction::Row> EveryAction::rows() {
  using T = EveryAction;
  const auto nothing = [](T&) {};
  const auto registered = [](T& t) { t.registered(); };
  const auto link = [](T& t) { t.linkSelected(); };
  const auto form = [](const QString& operation) {
    return [operation](T& t) {
      const OperationDialog* dialog = t.window->operationDialog(operation);
      return dialog && dialog->isVisible() && !dialog->isModal();
    };
  };
  const auto perspective = [](Perspective which) {
    return [which](T& t) { return t.window->perspective() == which; };
  };
  const auto stage = [](std::optional<Stage> which) {
    return [which](T& t) { return t.workspace().display().chosenStage() == which; };
  };
  return {
      {"file.new", nothing, [](T& t) { return t.asks("New project"); }},
      {"file.open", nothing, [](T& t) { return t.asks("Open project"); }},
      {"file.demo", nothing,
       [](T& t) {
         // Another test may have made it already.
         return t.workspace().session().name() == "demo" &&
                (t.workspace().jobs().busy() || t.snapshot().scans().size() == 14);
       }},
      {"file.capture", nothing, [](T& t) { return t.asks("New project"); }},
      {"file.save-as", registered, [](T& t) { return t.asks("Save project as"); }},
      {"file.copy", registered, [](T& t) { return t.asks("Save a copy of the project"); }},
      {"file.refresh",
       [](T& t) {
         t.readOnly();
         must(t.writer->apply(renameEdit(t.id(0), "written elsewhere")));
         ASSERT_EQ(t.nameOf(0), "stop 1");
       },
       [](T& t) { return t.nameOf(0) == "written elsewhere"; }},
      {"file.compact", registered,
       [](T& t) {
         return t.workspace().messages().latest()->action == "file.compact-now" &&
                t.workspace().session().canUndo();
       }},
      {"file.compact-now", registered, [](T& t) { return !t.workspace().session().canUndo(); }},
      {"file.verify", registered,
       [](T& t) {
         return t.workspace().messages().latest() &&
                t.workspace().messages().latest()->text.contains("is sound");
       }},
      {"file.close", registered, [](T& t) { return !t.workspace().session().isOpen(); }},
      {"file.new-window", nothing,
       [](T&) {
         int windows = 0;
         for (const QWidget* widget : QApplication::topLevelWidgets())
           windows += qobject_cast<const MainWindow*>(widget) && widget->isVisible();
         return windows == 2;
       }},
      {"file.quit", registered,
       [](T& t) {
         QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
         return t.window.isNull();
       }},
      {"file.quit-cancelling", [](T& t) { t.working(); },
       [](T& t) {
         QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
         return t.window.isNull();
       }},
      {"edit.undo", registered, [](T& t) { return t.snapshot().links().empty(); }},
      {"edit.redo",
       [](T& t) {
         t.registered();
         must(t.workspace().session().undo());
       },
       [](T& t) { return !t.snapshot().links().empty(); }},
      {"edit.rename", registered,
       [](T& t) {
         return t.window->findChild<QAbstractItemView*>("project-tree-view")->findChild<QLineEdit*>();
       }},
      {"edit.note", registered, [](T& t) { return t.find<QPlainTextEdit>("details-note")->hasFocus(); }},
      {"edit.colour", registered, [](T& t) { return t.shows("colours"); }},
      {"edit.colour-default",
       [](T& t) {
         t.registered();
         must(t.workspace().session().apply(colourEdit(t.snapshot(), {t.id(1)}, 0xff8800U)));
         t.settle();
       },
       [](T& t) { return !t.snapshot().scans()[1].colour; }},
      {"edit.rebase", registered,
       [](T& t) { return t.snapshot().scans()[1].odometry().translation().norm() < 1e-12; }},
      {"edit.photograph", registered, [](T& t) { return t.asks("Add photographs"); }},
      {"edit.survey", registered, [](T& t) { return t.shows("survey"); }},
      {"edit.delete", registered, [](T& t) { return t.snapshot().scans().size() == 2; }},
      {"edit.move-up",
       [](T& t) {
         t.registered();
         t.order_before = t.order();
       },
       [](T& t) { return t.order().front() == t.order_before[1]; }},
      {"edit.move-down",
       [](T& t) {
         t.registered();
         t.order_before = t.order();
       },
       [](T& t) { return t.order().back() == t.order_before[1]; }},
      {"edit.select-all", registered, [](T& t) { return t.workspace().selection().scans().size() == 3; }},
      {"edit.preferences", nothing, [](T& t) { return t.shows("preferences"); }},
      {"op.simulate", registered, form("simulate")},
      {"op.import", registered, form("import")},
      {"op.register", registered, form("register")},
      {"op.relax", registered, form("relax")},
      {"op.calibrate", registered, form("calibrate")},
      {"op.body-mask", registered, form("body-mask")},
      {"op.export", registered, form("export")},
      {"op.rebase", registered, form("rebase")},
      {"op.merge", registered, form("merge")},
      {"op.link", registered, form("link")},
      {"op.judge", registered, form("judge")},
      {"job.cancel", [](T& t) { t.working(); }, [](T& t) { return !t.workspace().jobs().busy(); }},
      {"link.accept", link, [](T& t) { return t.snapshot().links().back().origin == LinkOrigin::ByHand; }},
      {"link.disable", link, [](T& t) { return t.snapshot().links()[0].state == LinkState::Disabled; }},
      {"link.enable",
       [](T& t) {
         t.linkSelected();
         must(t.workspace().session().apply(linkStateEdit(t.snapshot().links()[0].id, LinkState::Disabled)));
         t.settle();
       },
       [](T& t) { return t.snapshot().links()[0].state == LinkState::Active; }},
      {"link.register", link, form("register")},
      {"link.show", link, [](T& t) { return !t.workspace().display().isVisible(t.id(2)); }},
      {"perspective.capture", registered, perspective(Perspective::Capture)},
      {"perspective.inspect",
       [](T& t) {
         t.registered();
         t.window->setPerspective(Perspective::Relax);
       },
       perspective(Perspective::Inspect)},
      {"perspective.register", registered, perspective(Perspective::Register)},
      {"perspective.relax", registered, perspective(Perspective::Relax)},
      {"view.reset-layout",
       [](T& t) {
         t.registered();
         t.window->togglePanel("log");
       },
       [](T& t) { return t.window->isPanelShown("log"); }},
      {"view.show-all",
       [](T& t) {
         t.registered();
         t.workspace().display().setVisible({t.id(0)}, false);
       },
       [](T& t) { return t.workspace().display().isVisible(t.id(0)); }},
      {"view.show-only", registered,
       [](T& t) {
         return !t.workspace().display().isVisible(t.id(0)) && t.workspace().display().isVisible(t.id(1));
       }},
      {"view.hide", registered, [](T& t) { return !t.workspace().display().isVisible(t.id(1)); }},
      {"view.show",
       [](T& t) {
         t.registered();
         t.workspace().display().setVisible({t.id(1)}, false);
       },
       [](T& t) { return t.workspace().display().isVisible(t.id(1)); }},
      {"view.palette", nothing, [](T& t) { return t.find<CommandPalette>("command-palette")->isVisible(); }},
      {"stage.latest",
       [](T& t) {
         t.registered();
         t.workspace().display().setStage(Stage::Odometry);
       },
       stage(std::nullopt)},
      {"stage.truth",
       [](T& t) {
         t.registered();
         must(t.workspace().session().apply(posesEdit(Stage::Truth, {{t.id(0), Pose()}})));
       },
       stage(Stage::Truth)},
      {"stage.odometry", registered, stage(Stage::Odometry)},
      {"stage.pairwise", registered, stage(Stage::Pairwise)},
      {"stage.relaxed",
       [](T& t) {
         t.registered();
         must(t.workspace().session().apply(posesEdit(Stage::Relaxed, {{t.id(0), Pose()}})));
       },
       stage(Stage::Relaxed)},
      {"stage.clear", registered, [](T& t) { return !t.snapshot().hasStage(Stage::Pairwise); }},
      {"help.log-folder", [](T& t) { ASSERT_EQ(openLogFile(qt(t.folder / "tiltmap.log")), ""); },
       [](T& t) { return t.urls.taken.toLocalFile() == qt(t.folder.path()); }},
      {"help.copy-log-path", [](T& t) { ASSERT_EQ(openLogFile(qt(t.folder / "tiltmap.log")), ""); },
       [](T& t) { return QApplication::clipboard()->text() == qt(t.folder / "tiltmap.log"); }},
      {"help.shortcuts", nothing, [](T& t) { return t.shows("shortcuts"); }},
      {"help.about", nothing, [](T& t) { return t.shows("about"); }},
  };
}

TEST_P(EveryAction, DoesWhatItSays) {
  const QString id = GetParam();
  if (id.startsWith("panel.")) {
    registered();
    const QString panel = id.mid(6);
    const bool shown = window->isPanelShown(panel);
    perform(id);
    EXPECT_NE(window->isPanelShown(panel), shown);
    return;
  }
  for (const Row& row : rows()) {
    if (row.id != id) continue;
    row.prepare(*this);
    ASSERT_FALSE(HasFatalFailure());
    perform(id);
    ASSERT_FALSE(HasFatalFailure());
    EXPECT_TRUE(waitUntil([&] { return row.done(*this); })) << id.toStdString();
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryAction, ::testing::ValuesIn(EveryAction::ids()),
                         [](const ::testing::TestParamInfo<QString>& row) {
                           std::string name = row.param.toStdString();
                           for (char& letter : name)
                             if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
                           return name;
                         });

class ActionList : public WindowTest {};

TEST_F(ActionList, NoActionIsWithoutARow) {
  std::set<QString> known;
  for (const QString& id : EveryAction::ids()) known.insert(id);
  // Actions of one panel alone are driven by that panel's own tests.
  const QStringList whole_window = {"file",        "edit",  "op",   "job",   "link",
                                    "perspective", "panel", "view", "stage", "help"};
  for (const QAction* action : window->actions().all())
    EXPECT_TRUE(!whole_window.contains(action->objectName().section('.', 0, 0)) ||
                known.contains(action->objectName()))
        << action->objectName().toStdString() << " is driven by no test: add a row to EveryAction::rows()";
  for (const QString& id : known)
    EXPECT_NE(window->actions().find(id), nullptr) << id.toStdString() << " is no more";
}

}  // namespace tiltmap::test

#include "every_action_test.moc"
