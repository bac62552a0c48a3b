// With no project: what is offered, and what comes of it.
#include <QAbstractButton>
#include <QDropEvent>
#include <QFileDialog>
#include <QLineEdit>
#include <QListWidget>
#include <QMimeData>
#include <QStackedWidget>
#include <QUrl>

#include "tests/ui/support/window_fixture.h"
#include "ui/models/parameter_model.h"
#include "ui/window/operation_dialog.h"

namespace tiltmap::test {

using namespace ui;

class StartTest : public WindowTest {
 protected:
  // Types a name into the file dialog that is open and accepts it.
  void answer(const std::filesystem::path& file) {
    auto* dialog = window->findChild<QFileDialog*>();
    ASSERT_NE(dialog, nullptr);
    auto* name = dialog->findChild<QLineEdit*>("fileNameEdit");
    ASSERT_NE(name, nullptr);
    name->clear();
    QTest::keyClicks(name, qt(file));
    QTest::keyClick(name, Qt::Key_Return);
    settle();
  }
  void drop(const QList<QUrl>& urls) {
    QMimeData data;
    data.setUrls(urls);
    QDragEnterEvent entering(QPoint(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window, &entering);
    EXPECT_TRUE(entering.isAccepted());
    QDropEvent event(QPointF(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window, &event);
    settle();
  }
};

TEST_F(StartTest, OffersWaysToAProject) {
  EXPECT_EQ(window->windowTitle(), "Tiltmap");
  for (const char* name : {"start:file.new", "start:file.open", "start:file.demo", "start:file.capture"}) {
    auto* button = find<QAbstractButton>(name);
    ASSERT_NE(button, nullptr);
    EXPECT_TRUE(button->isVisible()) << name;
    EXPECT_FALSE(button->accessibleName().isEmpty()) << name;
  }
}

TEST_F(StartTest, MakesANewProject) {
  click("start:file.new");
  answer(folder / "fresh.tiltmap");
  EXPECT_TRUE(std::filesystem::exists(folder / "fresh.tiltmap"));
  EXPECT_EQ(window->windowTitle(), "fresh - Tiltmap");
  EXPECT_TRUE(window->docks().isVisible());
}

TEST_F(StartTest, CaptureMakesAProjectInItsPerspective) {
  click("start:file.capture");
  answer(folder / "yard.tiltmap");
  EXPECT_EQ(window->perspective(), Perspective::Capture);
  EXPECT_TRUE(workspace().session().isOpen());
}

TEST_F(StartTest, OpensByShortcutAndListsItAsRecent) {
  must(Project::create(folder / "old.tiltmap"));
  press(QKeySequence::Open);
  answer(folder / "old.tiltmap");
  EXPECT_EQ(workspace().session().name(), "old");
  ASSERT_TRUE(trigger("file.close"));
  auto* recent = find<QListWidget>("recent-files");
  ASSERT_EQ(recent->count(), 1);
  clickIndex(recent, recent->model()->index(0, 0));
  QTest::keyClick(recent, Qt::Key_Return);
  settle();
  EXPECT_EQ(workspace().session().name(), "old");
}

TEST_F(StartTest, AProjectDroppedOnTheWindowIsOpened) {
  must(Project::create(folder / "dropped.tiltmap"));
  drop({QUrl::fromLocalFile(qt(folder / "dropped.tiltmap"))});
  EXPECT_EQ(window->windowTitle(), "dropped - Tiltmap");
}

TEST_F(StartTest, DroppedScansComeIntoTheImportForm) {
  drop({QUrl::fromLocalFile("/scans/b.pcd")});
  EXPECT_EQ(workspace().messages().latest()->action, "file.new") << "there is no project yet";
  makeProject(0);
  drop({QUrl::fromLocalFile("/scans/b.pcd"), QUrl::fromLocalFile("/scans/a.pcd")});
  OperationDialog* form = window->operationDialog("import");
  ASSERT_NE(form, nullptr);
  EXPECT_EQ(form->model().valueText("files"), "/scans/a.pcd\n/scans/b.pcd");
}

TEST_F(StartTest, MakesTheDemoAndOpensItTheSecondTime) {
  click("start:file.demo");
  ASSERT_TRUE(workspace().session().isOpen());
  EXPECT_TRUE(workspace().jobs().busy());
  EXPECT_TRUE(window->windowTitle().contains("(working)"));
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(snapshot().scans().size(), 14U);
  EXPECT_TRUE(snapshot().hasStage(Stage::Pairwise));
  const auto revision = snapshot().revision();
  ASSERT_TRUE(trigger("file.close"));
  click("start:file.demo");
  EXPECT_EQ(snapshot().revision(), revision);
  EXPECT_FALSE(workspace().jobs().busy());
}

}  // namespace tiltmap::test
