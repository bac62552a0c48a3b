// The panels, in step with each other and with the project.
#include <QClipboard>
#include <QComboBox>
#include <QLineEdit>
#include <QMenu>
#include <QPlainTextEdit>
#include <QTextBrowser>
#include <QTreeView>

#include "core/io/pose_file.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/history_model.h"
#include "ui/models/localisation_model.h"
#include "ui/models/log.h"
#include "ui/models/project_tree_model.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/localisation_panel.h"
#include "ui/panels/log_panel.h"
#include "ui/panels/project_tree_panel.h"
#include "ui/panels/table_view.h"

namespace tiltmap::test {

using namespace ui;

class PanelsTest : public WindowTest {
 protected:
  template <class Panel>
  Panel* panel(const QString& id) {
    window->showPanel(id);
    settle();
    return qobject_cast<Panel*>(window->docks().panel(id));
  }
};

TEST_F(PanelsTest, ClickingAScanSelectsItEverywhere) {
  makeProject(3, true);
  auto* tree = panel<ProjectTreePanel>("project-tree");
  clickIndex(tree->view(), tree->model().indexOfScan(id(1)));
  EXPECT_EQ(workspace().selection().scans(), std::vector<ScanId>{id(1)});
  EXPECT_TRUE(find<QTextBrowser>("details-text")->toPlainText().contains("Scan 1: stop 2"));
  auto* table = panel<LocalisationPanel>("localisation");
  ASSERT_EQ(table->view()->selectionModel()->selectedRows().size(), 1);
  EXPECT_EQ(table->view()->selectionModel()->selectedRows()[0].row(), 1);
  clickIndex(table->view(), table->model().index(2, 0));
  EXPECT_EQ(workspace().selection().currentScan(), id(2));
  EXPECT_EQ(tree->model().itemAt(tree->view()->currentIndex())->scan, id(2));
}

TEST_F(PanelsTest, AnEmptyProjectSaysWhatToDoNext) {
  makeProject(0);
  EXPECT_TRUE(find("project-tree-empty")->isVisible());
  must(workspace().session().apply(importEdit(sampleScans(1))));
  settle();
  EXPECT_FALSE(find("project-tree-empty")->isVisible());
}

TEST_F(PanelsTest, TheCheckBoxInTheTreeHides) {
  makeProject(2);
  auto* tree = panel<ProjectTreePanel>("project-tree");
  const QModelIndex scan = tree->model().indexOfScan(id(0));
  clickIndex(tree->view(), scan);
  QTest::keyClick(tree->view(), Qt::Key_Space);
  settle();
  EXPECT_FALSE(workspace().display().isVisible(id(0)));
}

TEST_F(PanelsTest, RenamesInTheTreeByKeyboard) {
  makeProject(2);
  auto* tree = panel<ProjectTreePanel>("project-tree");
  clickIndex(tree->view(), tree->model().indexOfScan(id(1)));
  ASSERT_TRUE(trigger("edit.rename"));
  auto* field = tree->view()->findChild<QLineEdit*>();
  ASSERT_NE(field, nullptr);
  field->selectAll();
  QTest::keyClicks(field, "south gate");
  QTest::keyClick(field, Qt::Key_Return);
  settle();
  EXPECT_EQ(nameOf(1), "south gate");
}

TEST_F(PanelsTest, ANoteIsStoredWhenTheFieldIsLeft) {
  makeProject(2);
  workspace().selection().setCurrentScan(id(0));
  ASSERT_TRUE(trigger("edit.note"));
  auto* note = find<QPlainTextEdit>("details-note");
  QTest::keyClicks(note, "wet ground");
  EXPECT_EQ(snapshot().scans()[0].note, "");
  workspace().selection().setCurrentScan(id(1));
  settle();
  EXPECT_EQ(snapshot().scans()[0].note, "wet ground");
  EXPECT_EQ(note->toPlainText(), "");
  press(QKeySequence("Ctrl+Z"));
  EXPECT_EQ(snapshot().scans()[0].note, "");
}

TEST_F(PanelsTest, TheTreesMenuHasTheActionsOfWhatIsUnderIt) {
  makeProject(2, true);
  auto* tree = panel<ProjectTreePanel>("project-tree");
  const QModelIndex link = tree->model().indexOfLink(snapshot().links()[0].id);
  clickIndex(tree->view(), link);
  Q_EMIT tree->view()->customContextMenuRequested(tree->view()->visualRect(link).center());
  settle();
  auto* menu = tree->findChild<QMenu*>();
  ASSERT_NE(menu, nullptr);
  EXPECT_TRUE(menu->actions().contains(window->actions().get("link.disable")));
  EXPECT_TRUE(window->actions().get("link.disable")->isEnabled());
  menu->close();
}

TEST_F(PanelsTest, DoubleClickOnAStageShowsIt) {
  makeProject(2, true);
  auto* tree = panel<ProjectTreePanel>("project-tree");
  const QModelIndex odometry =
      tree->model().index(0, 0, tree->model().groupIndex(TreeItem::Kind::StagesGroup));
  tree->view()->scrollTo(odometry);
  const QPoint at = tree->view()->visualRect(odometry).center();
  QTest::mouseClick(tree->view()->viewport(), Qt::LeftButton, {}, at);
  QTest::mouseDClick(tree->view()->viewport(), Qt::LeftButton, {}, at);
  settle();
  EXPECT_EQ(workspace().display().stage(), Stage::Odometry);
}

// Only Enter and a double click do: keys that go through the tree change nothing.
TEST_F(PanelsTest, OnlyEnterShowsTheStageThatKeysHaveReached) {
  makeProject(2, true);
  auto* tree = panel<ProjectTreePanel>("project-tree");
  const QModelIndex group = tree->model().groupIndex(TreeItem::Kind::StagesGroup);
  tree->view()->setCurrentIndex(group);
  const Stage before = workspace().display().stage();
  QTest::keyClick(tree->view(), Qt::Key_Down);
  QTest::keyClick(tree->view(), Qt::Key_Shift);
  settle();
  ASSERT_EQ(tree->view()->currentIndex(), tree->model().index(0, 0, group));
  EXPECT_EQ(workspace().display().stage(), before);
  QTest::keyClick(tree->view(), Qt::Key_Return);
  settle();
  EXPECT_EQ(workspace().display().stage(), Stage::Odometry);
}

TEST_F(PanelsTest, APerspectiveShowsItsOwnPanelsHoweverOneCameThere) {
  makeProject(2);
  const auto tabs = [&] {
    int visible = 0;
    for (const auto* widget : window->findChildren<QWidget*>())
      visible += widget->inherits("ads::CDockWidgetTab") && !widget->isHidden();
    return visible;
  };
  for (const Perspective perspective : {Perspective::Capture, Perspective::Relax, Perspective::Register,
                                        Perspective::Inspect, Perspective::Capture, Perspective::Register}) {
    window->setPerspective(perspective);
    settle();
    EXPECT_EQ(tabs(), static_cast<int>(delivered(perspective).size()))
        << perspectiveName(perspective).toStdString();
    for (const PanelInfo& info : panels())
      EXPECT_EQ(window->isPanelShown(info.id),
                std::ranges::any_of(delivered(perspective),
                                    [&](const DockPlace& place) { return place.panel == info.id; }))
          << info.id.toStdString() << " in " << perspectiveName(perspective).toStdString();
  }
}

TEST_F(PanelsTest, PanelsHaveTheirSharesOfTheWindowWhateverWasThereBefore) {
  makeProject(2);
  // So wide that the shares decide and not what a panel needs at least in a large font.
  window->resize(2400, 1200);
  const auto share = [&](const char* panel) {
    return static_cast<double>(window->docks().panel(panel)->width()) / window->width();
  };
  for (const bool again : {false, true}) {
    window->setPerspective(Perspective::Capture);
    settle();
    EXPECT_NEAR(share("project-tree"), 0.17, 0.03);
    window->setPerspective(Perspective::Relax);
    if (again) window->resetLayout();
    settle();
    EXPECT_NEAR(share("project-tree"), 0.18, 0.03);
    EXPECT_NEAR(share("relax"), 0.36 * 0.82, 0.03);
    EXPECT_NEAR(share("view3d"), 0.64 * 0.82, 0.04);
  }
}

TEST_F(PanelsTest, TheLocalisationTableIsCopiedAndExported) {
  makeProject(2, true);
  auto* table = panel<LocalisationPanel>("localisation");
  EXPECT_EQ(table->model().rowCount(), 2);
  click("localisation-copy", table);
  EXPECT_EQ(QApplication::clipboard()->text(), table->model().asText());
  EXPECT_TRUE(QApplication::clipboard()->text().contains("after pairwise registration"));
  table->exportTo(qt(folder / "stops.csv"));
  EXPECT_EQ(bytesOf(folder / "stops.csv"), csvOf(table->model().table()));
  table->exportTo(qt(folder / "stops.tum"));
  auto* log = panel<LogPanel>("log");
  logLine(LogLevel::Info, "a heron on the roof");
  settle();
  QTest::keyClicks(find<QLineEdit>("log-filter", log), "heron");
  settle();
  ASSERT_EQ(log->view()->model()->rowCount(), 1);
  EXPECT_EQ(log->view()->model()->index(0, 2).data().toString(), "a heron on the roof");
}

}  // namespace tiltmap::test
