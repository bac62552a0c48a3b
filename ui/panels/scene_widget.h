// The 3D view itself: a scene in a widget, driven by mouse and keys.
#pragma once

#include <QImage>
#include <QPoint>
#include <QTimer>
#include <QVTKOpenGLNativeWidget.h>
#include <functional>
#include <optional>
#include <vtkSmartPointer.h>

#include "ui/scene/scene.h"

class vtkGenericOpenGLRenderWindow;

namespace tiltmap::ui {

// Left button turns about what was clicked, middle or right (or Shift and left) shifts, the wheel zooms at
// the pointer; a click without dragging picks. Keys: 8 top, 2 bottom, 5 front, 0 back, 4 left, 6 right, 7 and
// 9 from above at an angle, O orthographic, F frames the selection, arrows turn, + and - zoom, M measures,
// Esc forgets what was measured. The divider of a comparison and the sides of a slice box can be dragged.
class SceneWidget : public QVTKOpenGLNativeWidget {
  Q_OBJECT

 public:
  explicit SceneWidget(Scene& scene, QWidget* parent = nullptr);
  ~SceneWidget() override;

  void drawSoon();
  // Device pixels from the lower left, of a place in the widget.
  Eigen::Vector2d pixelAt(const QPointF& place) const;
  // Everything drawn at this size in pixels, text and points as large against the picture as they are in the
  // view. Error: a size that cannot be drawn.
  Result<QImage> pictureOf(const QSize& size, const SceneColours& colours, const SceneColours& usual);
  // All points drawn, however long it takes.
  QImage wholePicture();
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
  void sliceDragged();
  void measureAsked();
  void escaped();

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
  void dragTo(const QPointF& place, Qt::KeyboardModifiers keys);
  bool isAtDivider(const QPointF& place) const;
  void showCursor(const QPointF& place);
  void adaptMovingPoints(double frame_s);

  Scene& scene_;
  vtkSmartPointer<vtkGenericOpenGLRenderWindow> window_;
  Qt::MouseButtons buttons_ = Qt::NoButton;
  QPointF pressed_, last_;
  bool dragged_ = false;
  bool drags_divider_ = false;
  std::optional<SliceHandle> handle_;  // being dragged
  std::size_t moving_points_ = kMovingPoints;
  QTimer still_;  // fires when nothing has moved for a while
  QTimer soon_;
};

}  // namespace tiltmap::ui
