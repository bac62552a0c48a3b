// How the panels of the stepper look, and that everything in them is named and fits.
#include <QComboBox>
#include <QPainter>
#include <QPushButton>
#include <QSlider>
#include <QTabWidget>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/ui/support/picture_baseline.h"
#include "tests/ui/support/stepper_window.h"
#include "ui/models/study_model.h"

namespace tiltmap::test {
namespace {

using StepperLookTest = StepperWindowTest;

TEST_F(StepperLookTest, EveryControlHasANameATipAndAPlaceInTheFocusOrder) {
  for (const char* panel : {"stepper", "stepper-view", "stepper-plots"})
    for (QWidget* control : window->docks().panel(panel)->findChildren<QWidget*>()) {
      const bool counts = qobject_cast<QAbstractButton*>(control) || qobject_cast<QComboBox*>(control) ||
                          qobject_cast<QSlider*>(control);
      if (!counts || !control->objectName().startsWith("stepper-")) continue;
      EXPECT_FALSE(control->accessibleName().isEmpty() && control->property("text").toString().isEmpty())
          << control->objectName().toStdString();
      EXPECT_FALSE(control->toolTip().isEmpty()) << control->objectName().toStdString();
      EXPECT_NE(control->focusPolicy(), Qt::NoFocus) << control->objectName().toStdString();
    }
}

TEST_F(StepperLookTest, ThePanelsFitBesideEachOtherOnASmallScreen) {
  runByMouse();
  EXPECT_LE(window->docks().panel("stepper")->minimumSizeHint().width(), 300);
  EXPECT_LE(view->minimumSizeHint().width(), 640);
  EXPECT_LE(window->docks().panel("stepper-plots")->minimumSizeHint().width(), 560);
  EXPECT_LE(window->width(), 1366);
}

// The panel with its 3D view, which Qt does not draw with the rest everywhere.
QImage withView(QWidget& panel, ui::StepperViewPanel& view) {
  QImage picture = panel.grab().toImage();
  QPainter painter(&picture);
  painter.drawImage(QRect(view.view()->mapTo(&panel, QPoint()), view.view()->size()), view.picture());
  painter.end();
  return picture;
}

TEST_F(StepperLookTest, TheViewLooksAsItDid) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  preferences.setTheme(ui::ThemeChoice::Dark);
  ASSERT_TRUE(loaded());
  for (int k = 0; k < 2; ++k) stepByMouse();
  view->resize(640, 420);
  EXPECT_TRUE(looksLike(withView(*view, *view).scaled(640, 416), "stepper-view"));
}

TEST_F(StepperLookTest, ThePlotsLookAsTheyDid) {
  preferences.setTheme(ui::ThemeChoice::Dark);
  open("stepper-start");
  click("stepper-sweep");
  ASSERT_TRUE(waitFor([this] { return stepper().start().sweep().has_value(); }));
  runByMouse();
  auto* tabs = find<QTabWidget>("stepper-tabs");
  const char* const names[] = {"convergence", "pairs", "residuals", "iterations", "headings", "slices"};
  ASSERT_EQ(tabs->count(), static_cast<int>(std::size(names)));
  for (int tab = 0; tab < tabs->count(); ++tab) {
    tabs->setCurrentIndex(tab);
    settle();
    if (tab == 5) {
      click("stepper-match-slices");
      ASSERT_TRUE(waitFor([this] { return ui::StudyModel::of(stepper()).slices().has_value(); }));
      settle();
    }
    const QImage picture = window->docks().panel("stepper-plots")->grab().toImage().scaled(560, 240);
    EXPECT_TRUE(looksLike(picture, QString("stepper-plots-%1").arg(names[tab]).toUtf8().constData()));
  }
}

TEST_F(StepperLookTest, ThePanelLooksAsItDid) {
  preferences.setTheme(ui::ThemeChoice::Dark);
  for (int k = 0; k < 4; ++k) stepByMouse();
  QWidget* panel = window->docks().panel("stepper");
  const QImage picture = panel->grab().toImage().scaled(320, 480);
  EXPECT_TRUE(looksLike(picture, "stepper-panel"));
}

}  // namespace
}  // namespace tiltmap::test
