// The 3D view itself: a scene in a widget, driven by mouse and keys.
#pragma once

#include <QPoint>
#include <QTimer>
#include <QVTKOpenGLNativeWidget.h>
#include <functional>
#include <vtkSmartPointer.h>

#include "ui/scene/scene.h"

class vtkGenericOpenGLRenderWindow;

namespace tiltmap::ui {

// Left button turns about what was clicked, middle or right (or Shift and left) shifts, the wheel zooms at
// the pointer; a click without dragging picks. Keys: 8 top, 2 bottom, 5 front, 0 back, 4 left, 6 right, 7 and
// 9 from above at an angle, O orthographic, F frames the selection, arrows turn, + and - zoom.
class SceneWidget : public QVTKOpenGLNativeWidget {
  Q_OBJECT

 public:
  explicit SceneWidget(Scene& scene, QWidget* parent = nullptr);
  ~SceneWidget() override;

  void drawSoon();
  // Device pixels from the lower left, of a place in the widget.
  Eigen::Vector2d pixelAt(const QPointF& place) const;
  // The other way.
  QPointF placeOf(const Eigen::Vector2d& pixel) const;
  // What the view shows, where no screen draws it. Error: no OpenGL.
  Result<QImage> pictureWithoutScreen();

 Q_SIGNALS:
  void clicked(const QPointF& place);
  void hovered(const QPointF& place);
  void left();
  void frameAsked();
  void orthographicChanged();

 protected:
  bool event(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void paintGL() override;

 private:
  bool isDragging() const { return buttons_ != Qt::NoButton; }
  void beginMoving();

  Scene& scene_;
  vtkSmartPointer<vtkGenericOpenGLRenderWindow> window_;
  Qt::MouseButtons buttons_ = Qt::NoButton;
  QPointF pressed_, last_;
  bool dragged_ = false;
  QTimer still_;  // fires when nothing has moved for a while
  QTimer soon_;
};

}  // namespace tiltmap::ui
