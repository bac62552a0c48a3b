// The ICP stepper driven by mouse and keyboard.
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLineEdit>
#include <QPushButton>
#include <QSlider>
#include <QTabWidget>
#include <QTableView>
#include <QToolButton>

#include <gtest/gtest.h>

#include "tests/ui/support/stepper_window.h"
#include "ui/models/study_model.h"
#include "ui/panels/slices_tab.h"
#include "ui/panels/stepper_panel.h"
#include "ui/panels/stepper_plots.h"

namespace tiltmap::test {
namespace {

using StepperPanelsTest = StepperWindowTest;

TEST_F(StepperPanelsTest, StepBackRunSliderAndAcceptByMouse) {
  EXPECT_EQ(window->perspective(), ui::Perspective::Register);
  EXPECT_TRUE(text("stepper-roles").contains("scan 1 (stop 1) (orange) comes to the fixed scan 0"));
  EXPECT_FALSE(find<QToolButton>("stepper-back")->isEnabled());
  EXPECT_FALSE(find<QPushButton>("stepper-accept")->isEnabled());
  EXPECT_EQ(text("stepper-iteration"), "Start");
  stepByMouse();
  stepByMouse();
  EXPECT_EQ(text("stepper-iteration"), "Iteration 2 of 2");
  const QString rms = text("stepper-rms"), cell = text("stepper-motion-03");
  EXPECT_NE(rms, "–");
  stepByMouse();
  EXPECT_NE(text("stepper-rms"), rms);
  click("stepper-back");
  EXPECT_EQ(text("stepper-rms"), rms);
  EXPECT_EQ(text("stepper-motion-03"), cell);
  EXPECT_EQ(text("stepper-iteration"), "Iteration 2 of 3");
  EXPECT_TRUE(text("stepper-verdict").contains("when the registration has ended"));
  runByMouse();
  EXPECT_TRUE(text("stepper-state").contains(ui::qt(stopReasonSentence(stepper().result()->stop_reason))));
  ASSERT_TRUE(stepper().judgement());
  EXPECT_TRUE(text("stepper-verdict").contains(ui::qt(stepper().judgement()->reason).toHtmlEscaped()));
  for (const char* name : {"Overlap", "Residual", "Held", "Within", "Still pulled", "Moved"})
    EXPECT_TRUE(text("stepper-judgement").contains(QString(name) + ": ")) << name;
  auto* slider = find<QSlider>("stepper-slider");
  EXPECT_EQ(slider->maximum(), stepper().count());
  slider->setFocus();
  QTest::keyClick(slider, Qt::Key_Home);
  EXPECT_EQ(stepper().position(), 0);
  QTest::keyClick(slider, Qt::Key_Right);
  EXPECT_EQ(stepper().position(), 1);
  click("stepper-last");
  EXPECT_EQ(stepper().position(), stepper().count());
  click("stepper-accept");
  ASSERT_EQ(snapshot().links().size(), 1U);
  EXPECT_EQ(snapshot().links()[0].fixed_from_moving, stepper().result()->fixed_from_moving);
  EXPECT_FALSE(find<QPushButton>("stepper-accept")->isEnabled());
  ASSERT_TRUE(trigger("edit.undo"));
  EXPECT_TRUE(snapshot().links().empty());
  EXPECT_TRUE(find<QPushButton>("stepper-accept")->isEnabled());
  const auto revision = snapshot().revision();
  click("stepper-discard");
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_EQ(snapshot().revision(), revision);
}

TEST_F(StepperPanelsTest, KeysStepAndWrongOrdersDoNothing) {
  press(QKeySequence("Shift+F8"));
  EXPECT_EQ(stepper().position(), 0);
  press(QKeySequence(Qt::Key_F8));
  ASSERT_TRUE(waitFor([&] { return stepper().count() == 1; }));
  settle();
  press(QKeySequence("Shift+F8"));
  EXPECT_EQ(stepper().position(), 0);
  press(QKeySequence(Qt::Key_F9));
  ASSERT_TRUE(waitFor([&] { return stepper().isEnded(); }));
  settle();
  EXPECT_FALSE(isEnabled("stepper.step"));
  EXPECT_TRUE(isEnabled("stepper.accept"));
  // The same scan twice: told, and nothing can be stepped.
  choose("stepper-moving", 0);
  EXPECT_TRUE(text("stepper-roles").contains("itself"));
  EXPECT_FALSE(find<QToolButton>("stepper-step")->isEnabled());
  EXPECT_FALSE(find<QPushButton>("stepper-run")->isEnabled());
  EXPECT_FALSE(isEnabled("stepper.accept"));
  click("stepper-swap");
  choose("stepper-moving", 2);
  EXPECT_TRUE(find<QToolButton>("stepper-step")->isEnabled());
  EXPECT_EQ(stepper().moving(), id(2));
  workspace().session().close();
  settle();
  EXPECT_EQ(find<QComboBox>("stepper-fixed")->count(), 0);
  EXPECT_FALSE(find<QToolButton>("stepper-step")->isEnabled());
}

TEST_F(StepperPanelsTest, CancelledAtFiftyMomentsTheProjectIsAsItWas) {
  const auto revision = snapshot().revision();
  for (int moment = 0; moment < 50; ++moment) {
    QTest::mouseClick(find<QPushButton>("stepper-run"), Qt::LeftButton);
    for (int k = 0; k < moment % 13; ++k) QCoreApplication::processEvents(QEventLoop::AllEvents, 2);
    if (moment % 2)
      stepper().discard();
    else
      stepper().choose(id(0), moment % 4 ? id(1) : id(2));
    stepper().discard();
    EXPECT_EQ(stepper().count(), 0);
  }
  settle();
  EXPECT_EQ(snapshot().revision(), revision);
  EXPECT_TRUE(snapshot().links().empty());
  QTest::mouseClick(find<QPushButton>("stepper-run"), Qt::LeftButton);
  window->closeNow();  // in the middle
}

TEST_F(StepperPanelsTest, PresetAndParametersStartOver) {
  stepByMouse();
  choose("stepper-preset", 1);
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_EQ(stepper().parameters().preset(), "thesis");
  open("stepper-parameters");
  auto* filter = find<QLineEdit>("stepper-parameter-filter");
  QTest::keyClicks(filter, "max iterations");
  settle();
  stepper().parameters().setValueText("max-iterations", "2");
  runByMouse();
  EXPECT_EQ(stepper().count(), 2);
  EXPECT_GT(stepper().steps()[0]->report.rejected[static_cast<std::size_t>(RejectReason::Statistics)], 0U);
  // The thesis' preset is remembered for the next time.
  EXPECT_EQ(preferences.lastParameters("stepper").preset, "thesis");
  click("stepper-parameters-reset");
  EXPECT_EQ(stepper().parameters().changedCount(), 0);
}

TEST_F(StepperPanelsTest, PlotsAndTableShowTheIterationsAndGoToThem) {
  runByMouse();
  auto* tabs = find<QTabWidget>("stepper-tabs");
  auto* convergence = find<ui::ConvergencePlot>("stepper-convergence");
  ASSERT_EQ(convergence->points(0).size(), stepper().count());
  EXPECT_EQ(convergence->points(0)[1], QPointF(2, 1e3 * stepper().steps()[1]->report.rms_m));
  EXPECT_EQ(convergence->points(1)[0].y(), 2000.0);  // the annealed scale begins wide
  EXPECT_EQ(convergence->mark(), static_cast<double>(stepper().count()));
  const QPointF place = convergence->placeOf({3.0, 10.0});
  QTest::mouseClick(convergence->canvas(), Qt::LeftButton, {}, place.toPoint());
  EXPECT_EQ(stepper().position(), 3);
  EXPECT_EQ(convergence->mark(), 3.0);
  auto* pairs = find<ui::PairsPlot>("stepper-pairs");
  EXPECT_EQ(pairs->points(0)[0].y(), static_cast<double>(stepper().steps()[0]->report.pairs));
  auto* residuals = find<ui::ResidualPlot>("stepper-residuals");
  double all = 0.0, weighted = 0.0;
  for (const ui::PlotBar& bar : residuals->bars(1)) all += bar.height;
  for (const ui::PlotBar& bar : residuals->bars(0)) weighted += bar.height;
  EXPECT_GT(all, 0.9 * static_cast<double>(stepper().current()->report.pairs));
  EXPECT_LT(weighted, all);
  EXPECT_GT(weighted, 0.0);
  auto* table = find<QTableView>("stepper-table");
  tabs->setCurrentWidget(table);
  settle();
  EXPECT_EQ(table->model()->rowCount(), stepper().count());
  clickIndex(table, table->model()->index(1, 2));
  EXPECT_EQ(stepper().position(), 2);
}

TEST_F(StepperPanelsTest, TheStartIsSetByNumbersSweepAndReset) {
  open("stepper-start");
  auto* x = find<QDoubleSpinBox>("stepper-start-x");
  const double odometry = x->value();
  x->setFocus();
  x->selectAll();
  QTest::keyClicks(x, "1.25");
  QTest::keyClick(x, Qt::Key_Return);
  EXPECT_NEAR(stepper().start().start().translation().x(), 1.25, 1e-9);
  EXPECT_TRUE(stepper().start().byHand());
  auto* heading = find<QDoubleSpinBox>("stepper-start-heading");
  heading->setValue(heading->value() + 40.0);
  click("stepper-sweep");
  ASSERT_TRUE(waitFor([&] { return stepper().start().sweep().has_value(); }));
  settle();
  EXPECT_TRUE(text("stepper-sweep-text").contains("Most fits"));
  auto* curve = find<ui::HeadingPlot>("stepper-headings");
  EXPECT_EQ(find<QTabWidget>("stepper-tabs")->currentWidget(), curve);
  EXPECT_EQ(curve->points(0).size(), 121);
  EXPECT_TRUE(curve->mark());
  click("stepper-use-heading");
  EXPECT_NEAR(stepper().start().start().translation().x(), 1.25, 1e-9);
  find<QCheckBox>("stepper-ghost")->setChecked(true);
  ASSERT_TRUE(waitFor([&] { return stepper().start().ghost().has_value(); }));
  settle();
  EXPECT_TRUE(text("stepper-ghost-text").contains("agree"));
  click("stepper-start-reset");
  EXPECT_NEAR(x->value(), odometry, 1e-3);
  EXPECT_FALSE(stepper().start().byHand());
}

TEST_F(StepperPanelsTest, SlicesAreMatchedAndCompared) {
  find<QTabWidget>("stepper-tabs")->setCurrentIndex(5);
  settle();
  click("stepper-match-slices");
  ui::StudyModel& study = ui::StudyModel::of(stepper());
  ASSERT_TRUE(waitFor([&] { return study.slices().has_value(); }));
  settle();
  EXPECT_TRUE(text("stepper-slice-text").contains("points"));
  runByMouse();
  ASSERT_TRUE(study.comparison());
  // Both axes hold all points, whatever the room.
  const auto* plot = find<ui::SlicePlot>("stepper-slices");
  const auto [left, right] = plot->range(ui::Plot::Bottom);
  const auto [bottom, top] = plot->range(ui::Plot::Left);
  EXPECT_NEAR((right - left) / plot->canvas()->width(), (top - bottom) / plot->canvas()->height(),
              0.05 * (right - left) / plot->canvas()->width());
  for (int series = 0; series < 3; ++series) {
    EXPECT_FALSE(plot->points(series).isEmpty());
    for (const QPointF& point : plot->points(series)) {
      ASSERT_TRUE(point.x() >= left && point.x() <= right) << point.x();
      ASSERT_TRUE(point.y() >= bottom && point.y() <= top) << point.y();
    }
  }
  EXPECT_TRUE(text("stepper-slice-text").contains("of height"));
  find<QDoubleSpinBox>("stepper-slice-height")->setValue(1.5);
  EXPECT_FALSE(study.slices());
}

}  // namespace
}  // namespace tiltmap::test
