// Photographs of the stops: into the project, seen, out again.
#include "core/project/photographs.h"

#include <QBuffer>
#include <QDropEvent>
#include <QFileDialog>
#include <QLineEdit>
#include <QListView>
#include <QMimeData>
#include <QToolButton>
#include <QUrl>

#include "tests/ui/support/window_fixture.h"
#include "ui/models/photograph_model.h"
#include "ui/panels/photographs_panel.h"

namespace tiltmap::test {
namespace {

class PhotographsTest : public WindowTest {
 protected:
  void SetUp() override {
    makeProject(3);
    workspace().selection().setCurrentScan(id(1));
    window->showPanel("photographs");
    settle();
    panel = qobject_cast<ui::PhotographsPanel*>(window->docks().panel("photographs"));
    ASSERT_NE(panel, nullptr);
  }
  QString pictureFile(const std::string& name, const QColor& colour, QSize size = {64, 48}) {
    QImage image(size, QImage::Format_RGB32);
    image.fill(colour);
    EXPECT_TRUE(image.save(ui::qt(folder / name)));
    return ui::qt(folder / name);
  }
  void typeIntoDialog(const QString& file) {
    auto* dialog = window->findChild<QFileDialog*>();
    ASSERT_NE(dialog, nullptr);
    auto* name = dialog->findChild<QLineEdit*>("fileNameEdit");
    name->clear();
    QTest::keyClicks(name, file);
    QTest::keyClick(name, Qt::Key_Return);
    settle();
  }
  bool shows(const QColor& colour) {
    const auto* view = find<QWidget>("photographs-picture");
    return waitUntil([&] {
      const QImage seen = const_cast<QWidget*>(view)->grab().toImage();
      return seen.pixelColor(seen.width() / 2, seen.height() / 2) == colour;
    });
  }
  ui::PhotographsPanel* panel = nullptr;
};

TEST_F(PhotographsTest, AreAddedSeenAndRemoved) {
  EXPECT_TRUE(find("photographs-empty")->isVisible());
  QTest::keyClicks(find<QLineEdit>("photographs-caption"), "the north gate");
  click("photographs-add");
  typeIntoDialog(pictureFile("gate.png", Qt::red));
  ASSERT_EQ(snapshot().scans()[1].photographs.size(), 1U);
  EXPECT_EQ(snapshot().scans()[1].photographs[0].caption, "the north gate");
  EXPECT_GT(snapshot().scans()[1].photographs[0].bytes, 0U) << "kept in the project";
  EXPECT_EQ(find<QLineEdit>("photographs-caption")->text(), "");
  EXPECT_TRUE(shows(Qt::red));
  EXPECT_EQ(panel->model().index(0).data().toString(), "the north gate");
  click("photographs-remove");
  EXPECT_TRUE(snapshot().scans()[1].photographs.empty());
  EXPECT_TRUE(find("photographs-empty")->isVisible());
  ASSERT_TRUE(trigger("edit.undo"));
  EXPECT_EQ(snapshot().scans()[1].photographs.size(), 1U);
  EXPECT_TRUE(shows(Qt::red));
}

TEST_F(PhotographsTest, FollowTheSelectionAndTheList) {
  panel->add({pictureFile("a.png", Qt::red), pictureFile("b.png", Qt::blue)});
  settle();
  ASSERT_EQ(panel->model().rowCount(), 2);
  EXPECT_EQ(snapshot().history().back().title, "2 photographs of " + nameOf(1));
  clickIndex(panel->list(), panel->model().index(0));
  EXPECT_TRUE(shows(Qt::red));
  clickIndex(panel->list(), panel->model().index(1));
  EXPECT_TRUE(shows(Qt::blue));
  workspace().selection().setCurrentScan(id(2));
  settle();
  EXPECT_EQ(panel->model().rowCount(), 0);
  workspace().selection().setCurrentScan(id(1));
  settle();
  EXPECT_EQ(panel->model().rowCount(), 2);
  press(QKeySequence("Ctrl+Z"));
  EXPECT_TRUE(snapshot().scans()[1].photographs.empty()) << "both were one edit";
}

TEST_F(PhotographsTest, DroppedPicturesGoToTheSelectedStopAndScansToTheForm) {
  QMimeData data;
  data.setUrls(
      {QUrl::fromLocalFile(pictureFile("yard.jpg", Qt::green)), QUrl::fromLocalFile("/scans/a.pcd")});
  QDragEnterEvent entering(QPoint(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(window, &entering);
  QDropEvent event(QPointF(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(window, &event);
  settle();
  ASSERT_EQ(snapshot().scans()[1].photographs.size(), 1U);
  EXPECT_EQ(snapshot().scans()[1].photographs[0].media_type, "image/jpeg");
  EXPECT_NE(window->operationDialog("import"), nullptr);
}

TEST_F(PhotographsTest, WhatIsNoPictureIsRefusedAndNothingIsAdded) {
  const QString words = ui::qt(folder.write("words.jpg", "no picture"));
  panel->add({pictureFile("a.png", Qt::red), words});
  EXPECT_TRUE(snapshot().scans()[1].photographs.empty());
  ASSERT_TRUE(workspace().messages().latest());
  EXPECT_EQ(workspace().messages().latest()->kind, ui::MessageKind::Error);
}

TEST_F(PhotographsTest, ArePutIntoAFileAsTheyCame) {
  const QString from = pictureFile("gate.png", Qt::red, {3000, 20});
  panel->add({from});
  settle();
  ASSERT_TRUE(waitUntil([&] { return !panel->model().picture(0).isNull(); }));
  EXPECT_LE(panel->model().picture(0).width(), ui::PhotographModel::kLargest_px);
  EXPECT_EQ(panel->model().proposedName(0), "stop-1-1.png");
  click("photographs-save");
  typeIntoDialog(ui::qt(folder / "out.png"));
  EXPECT_EQ(bytesOf(folder / "out.png"), bytesOf(ui::pathOf(from)));
}

TEST_F(PhotographsTest, OneThatIsGoneSaysSo) {
  const QString outside = pictureFile("outside.png", Qt::red);
  must(workspace().session().apply(
      addPhotographEdit(snapshot().scans()[1], must(photographFromFile(ui::pathOf(outside), "", false)))));
  ASSERT_TRUE(std::filesystem::remove(ui::pathOf(outside)));
  auto other = std::make_unique<ui::PhotographModel>(workspace());
  ASSERT_TRUE(waitUntil([&] { return !other->trouble(0).isEmpty(); }));
  EXPECT_TRUE(other->picture(0).isNull());
}

}  // namespace
}  // namespace tiltmap::test
