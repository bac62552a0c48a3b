// The ICP stepper driven by mouse and keyboard.
#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLineEdit>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QPushButton>
#include <QSlider>
#include <QTabWidget>
#include <QTableView>
#include <QTableWidget>
#include <QToolButton>

#include <gtest/gtest.h>

#include "core/world/experiment.h"
#include "tests/ui/support/picture_baseline.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/study_model.h"
#include "ui/panels/stepper_panel.h"
#include "ui/panels/stepper_plots.h"
#include "ui/panels/stepper_view_panel.h"

namespace tiltmap::test {
namespace {

const std::vector<SimulatedStop>& stops() {
  static const std::vector<SimulatedStop> made = must(simulateExperiment(ExperimentId::Exp2Fixed, 1, 3, 2));
  return made;
}

class StepperPanelsTest : public WindowTest {
 protected:
  void SetUp() override {
    must(workspace().session().create(ui::qt(folder / "s.tiltmap")));
    std::vector<Scan> scans;
    for (const SimulatedStop& stop : stops()) scans.push_back(stop.scan);
    must(workspace().session().apply(importEdit(std::move(scans))));
    settle();
    ASSERT_TRUE(trigger("stepper.open"));
    stepper().setPace(0);
    settle();
    view = qobject_cast<ui::StepperViewPanel*>(window->docks().panel("stepper-view"));
    ASSERT_NE(view, nullptr);
  }
  ui::StepperModel& stepper() { return workspace().stepper(); }
  bool waitFor(const std::function<bool()>& condition) { return waitUntil(condition); }
  void stepByMouse() {
    const int before = stepper().count();
    click("stepper-step");
    ASSERT_TRUE(waitFor([&] { return stepper().count() == before + 1; }));
    settle();
  }
  void runByMouse() {
    click("stepper-run");
    ASSERT_TRUE(waitFor([&] { return stepper().isEnded(); }));
    settle();
  }
  QString text(const QString& name) { return find<QLabel>(name)->text(); }
  void choose(const QString& box, int index) {
    auto* combo = find<QComboBox>(box);
    ASSERT_NE(combo, nullptr);
    combo->setFocus();
    combo->setCurrentIndex(index);
    Q_EMIT combo->activated(index);
    settle();
  }
  void open(const QString& fold) {
    auto* button = find<QToolButton>(fold);
    ASSERT_NE(button, nullptr);
    if (!button->isChecked()) QTest::mouseClick(button, Qt::LeftButton);
    settle();
  }
  bool canDraw() {
    QOpenGLContext context;
    return context.create() && !view->picture().isNull();
  }
  // The points of both scans are there to be clicked.
  bool loaded() {
    return waitFor([this] { return view->layer().pickPoint(true, {200, 150}, 1e5).has_value(); });
  }
  void send(QWidget* widget, QEvent::Type type, const QPointF& place, Qt::MouseButton button,
            Qt::MouseButtons buttons) {
    QMouseEvent event(type, place, widget->mapToGlobal(place.toPoint()), button, buttons, Qt::NoModifier);
    QApplication::sendEvent(widget, &event);
    settle();
  }
  QPointF placeOf(const Eigen::Vector2d& pixel) {
    const double ratio = view->view()->devicePixelRatioF();
    return {pixel.x() / ratio, view->view()->height() - pixel.y() / ratio};
  }

  ui::StepperViewPanel* view = nullptr;
};

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
  runByMouse();
  EXPECT_TRUE(text("stepper-state").contains("converged"));
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
  EXPECT_TRUE(text("stepper-slice-text").contains("of height"));
  find<QDoubleSpinBox>("stepper-slice-height")->setValue(1.5);
  EXPECT_FALSE(study.slices());
}

TEST_F(StepperPanelsTest, APairIsPickedAndExplainedAndItsTreeShown) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  stepByMouse();
  (void)view->picture();
  EXPECT_EQ(view->layer().linesDrawn(),
            stepper().current()->pairs.size() -
                stepper().current()->report.rejected[static_cast<std::size_t>(RejectReason::NoPartner)]);
  // The middle of a kept pair as it is drawn.
  std::optional<QPointF> place;
  for (const TracedPair& pair : stepper().pairs()) {
    if (!pair.pair.kept()) continue;
    const Eigen::Vector3d middle = 0.5 * (stepper().pose() * pair.moving_point + pair.fixed_point);
    place = placeOf(view->scene().pixelOf(middle));
    if (view->view()->rect().adjusted(20, 20, -20, -20).contains(place->toPoint())) break;
  }
  ASSERT_TRUE(place);
  QTest::mouseClick(view->view(), Qt::LeftButton, {}, place->toPoint());
  settle();
  ASSERT_TRUE(stepper().picked());
  EXPECT_EQ(text("stepper-picked"), stepper().pickedSentence());
  click("stepper-show-tree");
  ui::StudyModel& study = ui::StudyModel::of(stepper());
  ASSERT_TRUE(study.visit());
  EXPECT_TRUE(text("stepper-picked").contains("compared"));
  EXPECT_TRUE(text("stepper-picked").contains("by direction"));  // the default preset searches no tree
  const QImage with = view->picture();
  click("stepper-show-tree");
  EXPECT_NE(view->picture(), with);
  // A fate that is not shown is not drawn.
  const std::size_t drawn = view->layer().linesDrawn();
  QTest::mouseClick(find<QCheckBox>("stepper-fate-0"), Qt::LeftButton, {}, QPoint(8, 8));
  settle();
  EXPECT_EQ(view->layer().linesDrawn() + stepper().current()->report.pairs, drawn);
}

TEST_F(StepperPanelsTest, TheGizmoAndTheKeysMoveTheStart) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  click("stepper-adjust");
  (void)view->picture();
  const Pose before = stepper().start().start();
  const QPointF handle = placeOf(view->layer().handlePixel(ui::GizmoHandle::X));
  const QPointF far = handle + (handle - placeOf(view->scene().pixelOf(before.translation())));
  send(view->view(), QEvent::MouseButtonPress, handle, Qt::LeftButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseMove, 0.5 * (handle + far), Qt::NoButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseMove, far, Qt::NoButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseButtonRelease, far, Qt::LeftButton, Qt::NoButton);
  const Eigen::Vector3d shift = stepper().start().start().translation() - before.translation();
  EXPECT_GT(shift.x(), 0.1);
  EXPECT_NEAR(shift.y(), 0.0, 1e-9);
  EXPECT_NEAR(shift.z(), 0.0, 1e-9);
  (void)view->picture();
  const QPointF ring = placeOf(view->layer().handlePixel(ui::GizmoHandle::Turn));
  send(view->view(), QEvent::MouseButtonPress, ring, Qt::LeftButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseMove, ring + QPointF(14, 4), Qt::NoButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseButtonRelease, ring + QPointF(14, 4), Qt::LeftButton, Qt::NoButton);
  EXPECT_GT(difference(stepper().start().start(), before).rotation_rad, 1.0 * kDegree);

  const Pose here = stepper().start().start();
  const auto moved = [&] {
    return Eigen::Vector3d(stepper().start().start().translation() - here.translation());
  };
  QTest::keyClick(view->view(), Qt::Key_Right);
  EXPECT_NEAR(moved().x(), 0.1, 1e-9);
  QTest::keyClick(view->view(), Qt::Key_Up, Qt::ShiftModifier);
  EXPECT_NEAR(moved().y(), 0.01, 1e-9);
  QTest::keyClick(view->view(), Qt::Key_PageDown);
  EXPECT_NEAR(moved().z(), -0.1, 1e-9);
  QTest::keyClick(view->view(), Qt::Key_Comma);
  EXPECT_NEAR(difference(stepper().start().start(), here).rotation_rad, 1.0 * kDegree, 1e-9);
  click("stepper-adjust");
  const Pose after = stepper().start().start();
  QTest::keyClick(view->view(), Qt::Key_Right);  // turns the view again
  EXPECT_EQ(stepper().start().start(), after);
}

TEST_F(StepperPanelsTest, PointsArePickedInBothScansAndMakeAStart) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  open("stepper-start");
  click("stepper-pick-points");
  (void)view->picture();
  EXPECT_TRUE(text("stepper-picked").contains("fixed (grey)"));
  const QRect inside = view->view()->rect();
  for (int k = 0; k < 6; ++k) {
    const bool of_fixed = k % 2 == 0;
    // Three different places, each as near to a point as the view has one.
    const QPointF wish(inside.width() * (0.35 + 0.12 * (k / 2)), inside.height() * (k / 2 == 1 ? 0.45 : 0.6));
    const double ratio = view->view()->devicePixelRatioF();
    const Eigen::Vector2d pixel(wish.x() * ratio, (view->view()->height() - wish.y()) * ratio);
    const auto point = view->layer().pickPoint(of_fixed, pixel, 1e5);
    ASSERT_TRUE(point);
    const Pose pose = of_fixed ? Pose() : stepper().pose();
    QTest::mouseClick(view->view(), Qt::LeftButton, {},
                      placeOf(view->scene().pixelOf(pose * *point)).toPoint());
    settle();
  }
  EXPECT_EQ(stepper().start().pointPairs().size(), 3U);
  EXPECT_EQ(find<QTableWidget>("stepper-points")->rowCount(), 3);
  ASSERT_TRUE(stepper().start().pointPairFit());
  EXPECT_EQ(find<QTableWidget>("stepper-points")->item(0, 1)->text(),
            QString::number(1e3 * stepper().start().pointPairFit()->residual_m[0], 'f', 1));
  click("stepper-use-points");
  EXPECT_TRUE(stepper().start().byHand());
  click("stepper-remove-point");
  EXPECT_EQ(stepper().start().pointPairs().size(), 2U);
}

TEST_F(StepperPanelsTest, TheViewShowsBothScansInTheirColours) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  EXPECT_TRUE(text("stepper-view-title").contains("orange"));
  const QImage picture = view->picture();
  const ui::RegistrationColours colours = ui::RegistrationColours::of(theme.isDark());
  const auto shows = [&](Rgb colour) {
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x)
        if (picture.pixelColor(x, y) == QColor(colour.r, colour.g, colour.b)) return true;
    return false;
  };
  EXPECT_TRUE(shows(colours.fixed));
  EXPECT_TRUE(shows(colours.moving));
}

TEST_F(StepperPanelsTest, EveryControlHasANameATipAndAPlaceInTheFocusOrder) {
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

TEST_F(StepperPanelsTest, ThePanelsFitBesideEachOtherOnASmallScreen) {
  runByMouse();
  EXPECT_LE(window->docks().panel("stepper")->minimumSizeHint().width(), 300);
  EXPECT_LE(view->minimumSizeHint().width(), 640);
  EXPECT_LE(window->docks().panel("stepper-plots")->minimumSizeHint().width(), 560);
  EXPECT_LE(window->width(), 1366);
}

TEST_F(StepperPanelsTest, ThePanelLooksAsItDid) {
  preferences.setTheme(ui::ThemeChoice::Dark);
  for (int k = 0; k < 4; ++k) stepByMouse();
  ui::StepperPanel panel({workspace(), window->actions(), theme});
  panel.setAutoFillBackground(true);
  panel.resize(360, 720);
  panel.show();
  settle();
  EXPECT_TRUE(looksLike(panel.grab().toImage(), "stepper-panel"));
}

}  // namespace
}  // namespace tiltmap::test
