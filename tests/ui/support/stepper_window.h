// A window with three simulated stops in the ICP stepper, driven by mouse and keyboard.
#pragma once

#include <QComboBox>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QPushButton>
#include <QToolButton>

#include <gtest/gtest.h>

#include "core/world/experiment.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/panels/stepper_view_panel.h"

namespace tiltmap::test {
inline const std::vector<SimulatedStop>& stepperStops() {
  static const std::vector<SimulatedStop> made = must(simulateExperiment(ExperimentId::Exp2Fixed, 1, 3, 2));
  return made;
}

class StepperWindowTest : public WindowTest {
 protected:
  void SetUp() override {
    must(workspace().session().create(ui::qt(folder / "s.tiltmap")));
    std::vector<Scan> scans;
    for (const SimulatedStop& stop : stepperStops()) scans.push_back(stop.scan);
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

}  // namespace tiltmap::test
