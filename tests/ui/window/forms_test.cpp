// What people do to a survey through forms and the tree: each changes the project, and undo takes it back.
#include <QFileDialog>
#include <QLineEdit>
#include <QMimeData>
#include <QPushButton>
#include <QTableWidget>
#include <QThread>
#include <QTreeView>
#include <csignal>
#include <fstream>

#include "core/products/scan_colours.h"
#include "tests/support/program.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/project_tree_model.h"
#include "ui/models/relaxation_model.h"
#include "ui/panels/project_tree_panel.h"
#include "ui/window/message_bar.h"
#include "ui/window/operation_dialog.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::test {

using namespace ui;

class FormsTest : public WindowTest {
 protected:
  OperationDialog* form(const QString& operation) {
    EXPECT_TRUE(trigger("op." + operation));
    return window->operationDialog(operation);
  }
  void type(QWidget* field, const QString& text) {
    auto* line = qobject_cast<QLineEdit*>(field);
    ASSERT_NE(line, nullptr);
    line->setFocus();
    line->selectAll();
    QTest::keyClick(line, Qt::Key_Backspace);
    QTest::keyClicks(line, text);
    settle();
  }
  void run(OperationDialog* dialog) {
    ASSERT_NE(dialog, nullptr);
    click("run", dialog);
    ASSERT_TRUE(waitForJobs());
    settle();
  }
  void undo() { press(QKeySequence("Ctrl+Z")); }
  ProjectTreePanel* tree() { return qobject_cast<ProjectTreePanel*>(window->docks().panel("project-tree")); }
  // What a drag from inside the tree carries, let go above the row of the scan at `before`. (Qt hands a view
  // its own drags only while a real one runs.)
  void dropBefore(const QModelIndexList& rows, std::size_t before) {
    QTreeView* view = tree()->view();
    EXPECT_TRUE(view->dragEnabled());
    EXPECT_EQ(view->dragDropMode(), QAbstractItemView::InternalMove);
    for (const QModelIndex& row : rows) EXPECT_TRUE(view->model()->flags(row) & Qt::ItemIsDragEnabled);
    const std::unique_ptr<QMimeData> data(view->model()->mimeData(rows));
    const QModelIndex scans = tree()->model().groupIndex(TreeItem::Kind::ScansGroup);
    ASSERT_TRUE(
        view->model()->canDropMimeData(data.get(), Qt::MoveAction, static_cast<int>(before), 0, scans));
    view->model()->dropMimeData(data.get(), Qt::MoveAction, static_cast<int>(before), 0, scans);
    settle();
  }
};

TEST_F(FormsTest, SimulatesRegistersAndRelaxes) {
  makeProject(0);
  OperationDialog* simulate = form("simulate");
  simulate->setValues({{"experiment", std::string("exp1")}});
  run(simulate);
  run(form("register"));
  ASSERT_TRUE(snapshot().hasStage(Stage::Pairwise));
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
  // A relaxation moves every scan, so that it ends as a proposal from the menu as well.
  OperationDialog* relax = form("relax");
  EXPECT_TRUE(find<QLabel>("proposal", relax)->text().contains("nothing is stored"));
  click("run", relax);
  ASSERT_TRUE(waitUntil([&] { return workspace().relaxation().isProposal(); }));
  settle();
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_TRUE(window->isPanelShown("relax"));
  click("relax-discard");
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
  // Several wait their turn, and each is decided by itself, here by the bar at the bottom.
  click("run", form("relax"));
  click("run", form("relax"));
  EXPECT_EQ(workspace().jobs().queued(), 1);
  ASSERT_TRUE(waitUntil([&] { return workspace().relaxation().isProposal(); }));
  settle();
  click("job-accept");
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed));
  ASSERT_TRUE(waitUntil([&] { return workspace().relaxation().isProposal(); }));
  settle();
  click("job-cancel");
  EXPECT_FALSE(workspace().jobs().busy());
  EXPECT_EQ(workspace().display().stage(), Stage::Relaxed) << "what came last is shown";
  undo();
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
}

TEST_F(FormsTest, CancellingARelaxationInTheMiddleLeavesEverything) {
  makeProject(0);
  OperationDialog* simulate = form("simulate");
  simulate->setValues({{"experiment", std::string("exp2fixed")}});
  run(simulate);
  const auto revision = snapshot().revision();
  OperationDialog* relax = form("relax");
  // Not click(): that runs the event loop for as long as there is progress to show.
  QTest::mouseClick(find("run", relax), Qt::LeftButton);
  auto* cancel = find<QPushButton>("job-cancel");
  ASSERT_TRUE(workspace().jobs().busy());
  ASSERT_TRUE(cancel->isVisible());
  QThread::msleep(50);
  QTest::mouseClick(cancel, Qt::LeftButton);
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(snapshot().revision(), revision);
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
}

TEST_F(FormsTest, MergesAnotherProject) {
  {
    const auto other = must(Project::create(folder / "other.tiltmap"));
    must(other->apply(importEdit(sampleScans(2))));
  }
  makeProject(3);
  OperationDialog* dialog = form("merge");
  EXPECT_FALSE(find<QPushButton>("run", dialog)->isEnabled()) << "no project is named yet";
  type(dialog->form().editor("file"), qt(folder / "other.tiltmap"));
  type(dialog->form().editor("at"), "5 nowhere");
  EXPECT_FALSE(find<QPushButton>("run", dialog)->isEnabled());
  type(dialog->form().editor("at"), "5 -2 90");
  run(dialog);
  ASSERT_EQ(snapshot().scans().size(), 5U);
  const Pose expected = Pose::planar(5, -2, 90 * kDegree) * sampleScan(1).odometry;
  EXPECT_LT((snapshot().scans()[3].odometry().translation() - expected.translation()).norm(), 1e-9);
  undo();
  EXPECT_EQ(snapshot().scans().size(), 3U);
}

TEST_F(FormsTest, AProjectIsNotMergedWithItself) {
  makeProject(2);
  OperationDialog* dialog = form("merge");
  type(dialog->form().editor("file"), workspace().session().path());
  run(dialog);
  EXPECT_EQ(snapshot().scans().size(), 2U);
  EXPECT_TRUE(find<QLabel>("message-text")->text().contains("merged with itself"));
}

TEST_F(FormsTest, RebasesThroughTheForm) {
  makeProject(3);
  OperationDialog* dialog = form("rebase");
  type(dialog->form().editor("scan"), "2");
  run(dialog);
  EXPECT_LT(snapshot().scans()[2].odometry().translation().norm(), 1e-12);
  undo();
  EXPECT_GT(snapshot().scans()[2].odometry().translation().norm(), 1.0);
}

TEST_F(FormsTest, AColourIsChosenWrittenAndTakenBack) {
  makeProject(3);
  workspace().selection().setScans({id(0), id(2)});
  ASSERT_TRUE(trigger("edit.colour"));
  auto* dialog = find("colours");
  click("colour:5", dialog);
  const Rgb orange = scanColour(5);
  EXPECT_EQ(workspace().display().colour(id(0)), QColor(orange.r, orange.g, orange.b));
  EXPECT_EQ(workspace().display().colour(id(2)), QColor(orange.r, orange.g, orange.b));
  EXPECT_FALSE(snapshot().scans()[1].colour);
  EXPECT_FALSE(find<QPushButton>("colour-use", dialog)->isEnabled());
  type(find("colour-written", dialog), "#12ab34");
  click("colour-use", dialog);
  EXPECT_EQ(snapshot().scans()[0].colour, 0x12ab34U);
  const QImage swatch =
      tree()->model().indexOfScan(id(0)).data(Qt::DecorationRole).value<QIcon>().pixmap(16, 16).toImage();
  EXPECT_EQ(swatch.pixelColor(swatch.width() / 2, swatch.height() / 2), QColor(0x12, 0xab, 0x34));
  click("colour-by-place", dialog);
  EXPECT_FALSE(snapshot().scans()[0].colour);
  undo();
  EXPECT_EQ(snapshot().scans()[0].colour, 0x12ab34U);
  // Kept with the project.
  const QString path = workspace().session().path();
  workspace().session().close();
  must(workspace().session().open(path));
  EXPECT_EQ(workspace().display().colour(id(2)), QColor(0x12, 0xab, 0x34));
}

TEST_F(FormsTest, SurveyDataIsStored) {
  makeProject(1);
  ASSERT_TRUE(trigger("edit.survey"));
  auto* dialog = find("survey");
  EXPECT_FALSE(find("survey-store", dialog)->isEnabled()) << "nothing is entered";
  type(find("survey-site", dialog), "Old mill");
  type(find("survey-date", dialog), "2031-04-05");
  click("survey-store", dialog);
  EXPECT_EQ(snapshot().survey().site, "Old mill");
  EXPECT_EQ(snapshot().survey().date, "2031-04-05");
  undo();
  EXPECT_EQ(snapshot().survey().site, "");
}

TEST_F(FormsTest, ShortcutsAreFound) {
  ASSERT_TRUE(trigger("help.shortcuts"));
  auto* dialog = find("shortcuts");
  auto* table = find<QTableWidget>("shortcuts-table", dialog);
  EXPECT_GT(table->rowCount(), 30);
  QTest::keyClicks(find("shortcuts-filter", dialog), "ctrl+k");
  ASSERT_EQ(table->rowCount(), 1);
  EXPECT_EQ(table->item(0, 0)->text(), "Command palette");
}

TEST_F(FormsTest, ACopyIsSavedAndTheOriginalStaysOpen) {
  makeProject(2, true);
  ASSERT_TRUE(trigger("file.copy"));
  auto* dialog = window->findChild<QFileDialog*>();
  ASSERT_NE(dialog, nullptr);
  auto* name = dialog->findChild<QLineEdit*>("fileNameEdit");
  name->clear();
  QTest::keyClicks(name, qt(folder / "second.tiltmap"));
  QTest::keyClick(name, Qt::Key_Return);
  settle();
  EXPECT_EQ(workspace().session().name(), "survey");
  const auto copy = must(Project::open(folder / "second.tiltmap", Access::ReadOnly));
  EXPECT_EQ(copy->snapshot()->links().size(), snapshot().links().size());
}

TEST_F(FormsTest, SavingAsGoesOnInTheCopy) {
  makeProject(2);
  press(QKeySequence("Ctrl+Shift+S"));
  auto* dialog = window->findChild<QFileDialog*>();
  ASSERT_NE(dialog, nullptr);
  auto* name = dialog->findChild<QLineEdit*>("fileNameEdit");
  name->clear();
  QTest::keyClicks(name, qt(folder / "onward.tiltmap"));
  QTest::keyClick(name, Qt::Key_Return);
  settle();
  EXPECT_EQ(window->windowTitle(), "onward - Tiltmap");
  EXPECT_EQ(snapshot().scans().size(), 2U);
}

TEST_F(FormsTest, ScansAreDraggedToAnotherPlace) {
  makeProject(4);
  const auto before = scanIds(snapshot());
  dropBefore({tree()->model().indexOfScan(before[3])}, 1);
  EXPECT_EQ(scanIds(snapshot()), (std::vector<ScanId>{before[0], before[3], before[1], before[2]}));
  undo();
  EXPECT_EQ(scanIds(snapshot()), before);
}

TEST_F(FormsTest, SeveralScansMoveTogetherByKeyboard) {
  makeProject(4);
  const auto before = scanIds(snapshot());
  workspace().selection().setScans({before[1], before[2]});
  settle();
  press(QKeySequence("Alt+Down"));
  EXPECT_EQ(scanIds(snapshot()), (std::vector<ScanId>{before[0], before[3], before[1], before[2]}));
  press(QKeySequence("Alt+Up"));
  EXPECT_EQ(scanIds(snapshot()), before);
}

TEST_F(FormsTest, CompactingAsksFirst) {
  makeProject(3);
  must(workspace().session().apply(deleteEdit(snapshot(), {id(0)})));
  ASSERT_TRUE(trigger("file.compact"));
  EXPECT_TRUE(workspace().session().canUndo()) << "nothing has happened yet";
  EXPECT_TRUE(find<QLabel>("message-text")->text().contains("ends undo"));
  click("message-action");
  EXPECT_FALSE(workspace().session().canUndo());
}

TEST_F(FormsTest, AProjectThatAnotherProcessWritesIsOpenedForReadingAndSaysWhy) {
  if (!std::getenv("TILTMAP_PROGRAM"))
    GTEST_SKIP() << "TILTMAP_PROGRAM is not set; run the tests through ctest";
  {
    const auto project = must(Project::create(folder / "shared.tiltmap"));
    must(project->apply(importEdit(sampleScans(1))));
  }
  const pid_t other = startTiltmap({"gui", "shared.tiltmap"}, folder.path());
  // Looked at from outside: trying to write here would be in the other one's way.
  EXPECT_TRUE(waitUntil([&] {
    std::ifstream lock(folder / "shared.tiltmap-lock");
    std::string holder;
    return std::getline(lock, holder) && holder.starts_with("process " + std::to_string(other) + " ");
  }));
  must(workspace().session().open(qt(folder / "shared.tiltmap")));
  settle();
  EXPECT_EQ(window->windowTitle(), "shared (read only) - Tiltmap");
  EXPECT_FALSE(isEnabled("op.register"));
  const QString text = find<QLabel>("message-text")->text();
  EXPECT_TRUE(text.contains("reading only")) << text.toStdString();
  EXPECT_TRUE(text.contains(QString::number(other))) << "who writes it: " << text.toStdString();
  ASSERT_EQ(kill(other, SIGTERM), 0);
  EXPECT_EQ(waitForTiltmap(other, folder.path()).exit_code, 0);
  // Free again.
  const QString path = workspace().session().path();
  workspace().session().close();
  must(workspace().session().open(path));
  EXPECT_TRUE(workspace().session().isWritable());
}

}  // namespace tiltmap::test
