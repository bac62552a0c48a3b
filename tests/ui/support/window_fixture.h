// A window on a project, driven as its user would.
#pragma once

#include <QAbstractItemView>
#include <QAction>
#include <QApplication>
#include <QLabel>
#include <QPointer>
#include <QTest>

#include <gtest/gtest.h>

#include "tests/ui/models/model_samples.h"
#include "ui/look/theme.h"
#include "ui/panels/depth_image_panel.h"
#include "ui/panels/view3d_panel.h"
#include "ui/window/dock_area.h"
#include "ui/window/main_window.h"

namespace tiltmap::test {

class WindowTest : public ::testing::Test {
 protected:
  explicit WindowTest(QSize size = QSize(1366, 768))
      : preferences(ui::qt(folder / "settings.ini")), theme(preferences) {
    window = openWindow(size);
  }
  ~WindowTest() override {
    if (window) {
      window->workspace().jobs().cancelAll();
      delete window.data();
    }
    QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  }

  ui::MainWindow* openWindow(QSize size = QSize(1366, 768)) {
    auto* opened = new ui::MainWindow(preferences, theme);
    opened->resize(size);
    opened->show();
    opened->activateWindow();
    QApplication::setActiveWindow(opened);
    (void)QTest::qWaitForWindowExposed(opened);
    QCoreApplication::processEvents();
    return opened;
  }

  ui::Workspace& workspace() { return window->workspace(); }
  const ProjectSnapshot& snapshot() { return *workspace().snapshot(); }
  ScanId id(std::size_t index) { return snapshot().scans()[index].id; }
  std::string nameOf(std::size_t index) { return snapshot().scans()[index].name; }

  // A project of small scans, with links and pairwise poses where wanted.
  void makeProject(int scans, bool registered = false, const std::string& name = "survey.tiltmap") {
    must(workspace().session().create(ui::qt(folder / name)));
    if (scans > 0) must(workspace().session().apply(importEdit(sampleScans(scans))));
    if (registered) must(workspace().session().apply(sampleRegister(workspace().snapshot())));
    settle();
  }
  void settle() {
    for (int i = 0; i < 3; ++i) QCoreApplication::processEvents();
    // What is read aside is there at once for a person.
    EXPECT_TRUE(waitUntil([] {
      for (const QWidget* top : QApplication::topLevelWidgets())
        for (const auto* view : top->findChildren<ui::View3dPanel*>())
          if (view->isReading()) return false;
      for (const QWidget* top : QApplication::topLevelWidgets())
        for (const auto* panel : top->findChildren<ui::DepthImagePanel*>())
          if (panel->isReading()) return false;
      return true;
    }));
  }

  template <class Widget = QWidget>
  Widget* find(const QString& name, QWidget* under = nullptr) {
    auto* found = (under ? under : window.data())->findChild<Widget*>(name);
    if (!found) ADD_FAILURE() << "there is no widget " << name.toStdString();
    return found;
  }
  void click(const QString& name, QWidget* under = nullptr) {
    auto* widget = find(name, under);
    ASSERT_NE(widget, nullptr);
    // As a person does who waits for a button to come alive: panels follow a worker by their own pace.
    ASSERT_TRUE(waitUntil([&] { return widget->isVisible() && widget->isEnabled(); }))
        << name.toStdString() << (widget->isVisible() ? " is not enabled" : " cannot be seen");
    QTest::mouseClick(widget, Qt::LeftButton);
    settle();
  }
  // A shortcut pressed in the window.
  void press(const QKeySequence& keys) {
    QApplication::setActiveWindow(window);
    QTest::keySequence(window.data(), keys);
    settle();
  }
  bool isEnabled(const QString& action) {
    window->actions().refresh();
    return window->actions().get(action)->isEnabled();
  }
  ::testing::AssertionResult trigger(const QString& action) {
    if (!window->actions().trigger(action))
      return ::testing::AssertionFailure() << action.toStdString() << " cannot be triggered";
    settle();
    return ::testing::AssertionSuccess();
  }
  // A row of a list, table or tree clicked in the middle of one of its cells.
  void clickIndex(QAbstractItemView* view, const QModelIndex& index, Qt::KeyboardModifiers keys = {}) {
    view->scrollTo(index);
    QTest::mouseClick(view->viewport(), Qt::LeftButton, keys, view->visualRect(index).center());
    settle();
  }
  bool waitForJobs() {
    return waitUntil([this] { return !workspace().jobs().busy(); });
  }

  TemporaryFolder folder;
  ui::Preferences preferences;
  ui::Theme theme;
  QPointer<ui::MainWindow> window;
};

}  // namespace tiltmap::test
