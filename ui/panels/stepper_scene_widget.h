// The stepper's 3D view: as every scene, and with a gizmo and keys that move the start.
#pragma once

#include "ui/panels/scene_widget.h"
#include "ui/scene/registration_layer.h"

namespace tiltmap::ui {

class StartModel;

// While adjusting: dragging a handle moves the start; arrow keys shift it by 0.1 m (left and right along x,
// up and down along y), page up and down along z, comma and period turn it by 1 degree; with Shift a tenth of
// that.
class StepperSceneWidget : public SceneWidget {
  Q_OBJECT

 public:
  StepperSceneWidget(Scene& scene, RegistrationLayer& layer, StartModel& start, QWidget* parent = nullptr);

  void setAdjusting(bool adjusting);
  bool isAdjusting() const { return adjusting_; }

 protected:
  bool event(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  bool nudge(int key, bool fine);

  RegistrationLayer& layer_;
  StartModel& start_;
  bool adjusting_ = false;
  GizmoHandle held_ = GizmoHandle::None;
  QPointF last_place_;
};

}  // namespace tiltmap::ui
