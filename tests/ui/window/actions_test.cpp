// Shortcuts, menus, palette, perspectives, persistence, two windows.
#include <QClipboard>
#include <QLineEdit>
#include <QListWidget>
#include <QMenuBar>
#include <set>

#include "tests/ui/support/window_fixture.h"
#include "ui/models/log.h"
#include "ui/window/command_palette.h"

namespace tiltmap::test {

using namespace ui;

class ActionsTest : public WindowTest {};

TEST_F(ActionsTest, EveryActionSaysWhatItDoesAndIsInTheWindow) {
  std::set<QString> shortcuts;
  for (const QAction* action : window->actions().all()) {
    EXPECT_FALSE(action->text().isEmpty()) << action->objectName().toStdString();
    EXPECT_FALSE(action->statusTip().isEmpty()) << action->objectName().toStdString();
    if (!action->shortcut().isEmpty()) {
      EXPECT_TRUE(shortcuts.insert(action->shortcut().toString()).second)
          << action->objectName().toStdString();
      EXPECT_TRUE(
          action->toolTip().contains(action->shortcut().toString(QKeySequence::NativeText).toHtmlEscaped()));
    }
  }
}

TEST_F(ActionsTest, UndoAndRedoByKeyboard) {
  makeProject(2);
  must(workspace().session().apply(renameEdit(id(0), "gate")));
  settle();
  EXPECT_TRUE(window->actions().get("edit.undo")->text().startsWith("&Undo rename"));
  press(QKeySequence("Ctrl+Z"));
  EXPECT_EQ(nameOf(0), "stop 1");
  press(QKeySequence("Ctrl+Shift+Z"));
  EXPECT_EQ(nameOf(0), "gate");
}

TEST_F(ActionsTest, DeleteTakesTheSelectedScansAndUndoBringsThemBack) {
  makeProject(3);
  EXPECT_FALSE(isEnabled("edit.delete"));
  workspace().selection().setScans({id(0), id(1)});
  settle();
  press(QKeySequence(Qt::Key_Delete));
  EXPECT_EQ(snapshot().scans().size(), 1U);
  press(QKeySequence("Ctrl+Z"));
  EXPECT_EQ(snapshot().scans().size(), 3U);
}

TEST_F(ActionsTest, MovesScansInTheOrder) {
  makeProject(3);
  const auto before = scanIds(snapshot());
  workspace().selection().setCurrentScan(before[2]);
  settle();
  press(QKeySequence("Alt+Up"));
  EXPECT_EQ(scanIds(snapshot()), (std::vector<ScanId>{before[0], before[2], before[1]}));
  press(QKeySequence("Alt+Down"));
  EXPECT_EQ(scanIds(snapshot()), before);
}

TEST_F(ActionsTest, VisibilityAndStage) {
  makeProject(3, true);
  workspace().selection().setCurrentScan(id(1));
  settle();
  press(QKeySequence("Ctrl+H"));
  EXPECT_FALSE(workspace().display().isVisible(id(0)));
  press(QKeySequence("Ctrl+Shift+H"));
  EXPECT_TRUE(workspace().display().isVisible(id(0)));
  ASSERT_TRUE(trigger("view.hide"));
  EXPECT_FALSE(workspace().display().isVisible(id(1)));
  ASSERT_TRUE(trigger("view.show"));
  EXPECT_TRUE(workspace().display().isVisible(id(1)));
  ASSERT_TRUE(trigger("stage.odometry"));
  EXPECT_EQ(workspace().display().stage(), Stage::Odometry);
  ASSERT_TRUE(trigger("stage.latest"));
  EXPECT_EQ(workspace().display().stage(), Stage::Pairwise);
  EXPECT_FALSE(window->actions().trigger("stage.relaxed")) << "there is no such result yet";
}

TEST_F(ActionsTest, LinksAreDisabledAndEnabled) {
  makeProject(3, true);
  const LinkId link = snapshot().links()[0].id;
  workspace().selection().setLinks({link});
  ASSERT_TRUE(trigger("link.disable"));
  EXPECT_EQ(snapshot().findLink(link)->state, LinkState::Disabled);
  EXPECT_FALSE(isEnabled("link.disable"));
  ASSERT_TRUE(trigger("link.enable"));
  EXPECT_EQ(snapshot().findLink(link)->state, LinkState::Active);
  ASSERT_TRUE(trigger("link.show"));
  EXPECT_FALSE(workspace().display().isVisible(id(2)));
  ASSERT_TRUE(trigger("edit.delete"));
  EXPECT_EQ(snapshot().findLink(link), nullptr);
}

TEST_F(ActionsTest, PaletteFindsByNameAndHelpAndRuns) {
  makeProject(2);
  press(QKeySequence("Ctrl+K"));
  auto* palette = find<CommandPalette>("command-palette");
  ASSERT_TRUE(palette->isVisible());
  auto* search = find<QLineEdit>("palette-search", palette);
  auto* list = find<QListWidget>("palette-list", palette);
  const int all = list->count();
  EXPECT_GT(all, 40);
  QTest::keyClicks(search, "whose colours");
  EXPECT_EQ(list->count(), 0);
  search->clear();
  QTest::keyClicks(search, "select all");
  ASSERT_GE(list->count(), 1);
  QTest::keyClick(search, Qt::Key_Return);
  settle();
  EXPECT_FALSE(palette->isVisible());
  EXPECT_EQ(workspace().selection().scans().size(), 2U);
  EXPECT_GT(CommandPalette::score(*window->actions().get("edit.undo"), "undo"), 3);
  EXPECT_EQ(CommandPalette::score(*window->actions().get("edit.undo"), "take last edit"), 2)
      << "words of the help";
}

TEST_F(ActionsTest, PerspectivesAndPanelsAreRemembered) {
  makeProject(1);
  EXPECT_EQ(window->perspective(), Perspective::Inspect);
  press(QKeySequence("Ctrl+4"));
  EXPECT_EQ(window->perspective(), Perspective::Relax);
  ASSERT_TRUE(trigger("panel.history"));
  EXPECT_FALSE(window->docks().isShown("history"));
  press(QKeySequence("Ctrl+2"));
  EXPECT_TRUE(window->docks().isShown("history")) << "each perspective has its own arrangement";
  press(QKeySequence("Ctrl+4"));
  EXPECT_FALSE(window->docks().isShown("history"));
  window->close();
  QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  window = openWindow();
  EXPECT_EQ(window->perspective(), Perspective::Relax);
  EXPECT_FALSE(window->docks().isShown("history"));
  makeProject(0, false, "other.tiltmap");
  ASSERT_TRUE(trigger("view.reset-layout"));
  EXPECT_TRUE(window->docks().isShown("history"));
}

TEST_F(ActionsTest, EveryPanelShowsAndHides) {
  makeProject(2, true);
  for (const PanelInfo& panel : panels()) {
    window->showPanel(panel.id);
    EXPECT_TRUE(window->docks().isShown(panel.id)) << panel.id.toStdString();
    ASSERT_TRUE(trigger("panel." + panel.id));
    EXPECT_FALSE(window->docks().isShown(panel.id)) << panel.id.toStdString();
  }
}

TEST_F(ActionsTest, TwoWindowsHaveTwoProjects) {
  makeProject(1);
  QPointer<MainWindow> other = openWindow();
  must(other->workspace().session().create(qt(folder / "second.tiltmap")));
  EXPECT_EQ(other->windowTitle(), "second - Tiltmap");
  EXPECT_EQ(window->windowTitle(), "survey - Tiltmap");
  must(other->workspace().session().apply(importEdit(sampleScans(2))));
  EXPECT_EQ(snapshot().scans().size(), 1U);
  delete other.data();
  must(workspace().session().apply(renameEdit(id(0), "alive")));
  EXPECT_EQ(nameOf(0), "alive");
}

TEST_F(ActionsTest, ChecksAndCompactsTheFile) {
  makeProject(3);
  ASSERT_TRUE(trigger("file.verify"));
  ASSERT_TRUE(waitForJobs());
  settle();
  EXPECT_TRUE(workspace().messages().latest()->text.contains("is sound"));
  must(workspace().session().apply(deleteEdit(snapshot(), {id(0)})));
  ASSERT_TRUE(trigger("file.compact-now"));
  EXPECT_FALSE(workspace().session().canUndo());
  EXPECT_FALSE(isEnabled("edit.undo"));
}

TEST_F(ActionsTest, TheLogsPathIsCopied) {
  ASSERT_EQ(openLogFile(qt(folder / "tiltmap.log")), "");
  ASSERT_TRUE(trigger("help.copy-log-path"));
  EXPECT_EQ(QApplication::clipboard()->text(), qt(folder / "tiltmap.log"));
  closeLogFile();
}

TEST_F(ActionsTest, AReadOnlyProjectOffersNoEdits) {
  makeProject(1);
  QPointer<MainWindow> other = openWindow();
  must(other->workspace().session().open(workspace().session().path()));
  other->workspace().selection().setCurrentScan(id(0));
  other->actions().refresh();
  EXPECT_TRUE(other->windowTitle().contains("(read only)"));
  for (const char* action : {"edit.delete", "edit.rename", "op.register", "op.import"})
    EXPECT_FALSE(other->actions().get(action)->isEnabled()) << action;
  EXPECT_TRUE(other->actions().get("op.export")->isEnabled());
  delete other.data();
}

}  // namespace tiltmap::test
