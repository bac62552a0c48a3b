#include "ui/panels/stepper_scene_widget.h"

#include <QKeyEvent>
#include <QMouseEvent>

#include "ui/models/start_model.h"

namespace tiltmap::ui {

StepperSceneWidget::StepperSceneWidget(Scene& scene, RegistrationLayer& layer, StartModel& start,
                                       QWidget* parent)
    : SceneWidget(scene, parent), layer_(layer), start_(start) {}

void StepperSceneWidget::setAdjusting(bool adjusting) {
  adjusting_ = adjusting;
  held_ = GizmoHandle::None;
  layer_.setGizmo(adjusting);
  drawSoon();
}

bool StepperSceneWidget::event(QEvent* event) {
  if (event->type() == QEvent::ShortcutOverride && adjusting_) {
    const int key = static_cast<QKeyEvent*>(event)->key();
    if (key == Qt::Key_Comma || key == Qt::Key_Period || key == Qt::Key_Less || key == Qt::Key_Greater ||
        key == Qt::Key_Semicolon || key == Qt::Key_Colon) {
      event->accept();
      return true;
    }
  }
  return SceneWidget::event(event);
}

void StepperSceneWidget::mousePressEvent(QMouseEvent* event) {
  if (adjusting_ && event->button() == Qt::LeftButton && event->modifiers() == Qt::NoModifier) {
    held_ = layer_.gizmoAt(pixelAt(event->localPos()));
    if (held_ != GizmoHandle::None) {
      setFocus(Qt::MouseFocusReason);
      last_place_ = event->localPos();
      layer_.setGizmo(true, held_);
      drawSoon();
      event->accept();
      return;
    }
  }
  SceneWidget::mousePressEvent(event);
}

void StepperSceneWidget::mouseMoveEvent(QMouseEvent* event) {
  if (held_ == GizmoHandle::None) return SceneWidget::mouseMoveEvent(event);
  const RegistrationLayer::Drag drag =
      layer_.dragged(held_, pixelAt(last_place_), pixelAt(event->localPos()));
  last_place_ = event->localPos();
  start_.nudge(drag.shift_m, drag.turn_rad);
  layer_.setGizmo(true, held_);
  event->accept();
}

void StepperSceneWidget::mouseReleaseEvent(QMouseEvent* event) {
  if (held_ == GizmoHandle::None) return SceneWidget::mouseReleaseEvent(event);
  held_ = GizmoHandle::None;
  layer_.setGizmo(true);
  drawSoon();
  event->accept();
}

bool StepperSceneWidget::nudge(int key, bool fine) {
  const double step_m = fine ? 0.01 : 0.1;
  const double turn_rad = (fine ? 0.1 : 1.0) * kDegree;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double turn = 0.0;
  switch (key) {
    case Qt::Key_Left:
      shift.x() = -step_m;
      break;
    case Qt::Key_Right:
      shift.x() = step_m;
      break;
    case Qt::Key_Up:
      shift.y() = step_m;
      break;
    case Qt::Key_Down:
      shift.y() = -step_m;
      break;
    case Qt::Key_PageUp:
      shift.z() = step_m;
      break;
    case Qt::Key_PageDown:
      shift.z() = -step_m;
      break;
    case Qt::Key_Comma:
    case Qt::Key_Less:
    case Qt::Key_Semicolon:
      turn = turn_rad;
      break;
    case Qt::Key_Period:
    case Qt::Key_Greater:
    case Qt::Key_Colon:
      turn = -turn_rad;
      break;
    default:
      return false;
  }
  start_.nudge(shift, turn);
  return true;
}

void StepperSceneWidget::keyPressEvent(QKeyEvent* event) {
  const bool plain = !(event->modifiers() & (Qt::ControlModifier | Qt::AltModifier));
  if (adjusting_ && plain && nudge(event->key(), event->modifiers() & Qt::ShiftModifier)) {
    event->accept();
    return;
  }
  SceneWidget::keyPressEvent(event);
}

}  // namespace tiltmap::ui
