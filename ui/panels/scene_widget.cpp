#include "ui/panels/scene_widget.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QSurfaceFormat>
#include <QWheelEvent>
#include <chrono>
#include <cmath>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>

#include "ui/scene/offscreen_window.h"

namespace tiltmap::ui {

namespace {

constexpr double kDragBegins_px = 4.0;
constexpr int kStillAfter_ms = 200;
constexpr double kGrasp_px = 9.0;
// A fast graphics card draws more points while moving; one that takes longer than the second draws fewer
// again.
constexpr double kQuickFrame_s = 0.012, kSlowFrame_s = 0.025;
constexpr std::size_t kMostMovingPoints = 20'000'000;

}  // namespace

SceneWidget::SceneWidget(Scene& scene, QWidget* parent)
    : QVTKOpenGLNativeWidget(parent),
      scene_(scene),
      window_(vtkSmartPointer<vtkGenericOpenGLRenderWindow>::New()) {
  QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
  format.setSamples(0);  // slow where software draws, and points gain nothing
  setFormat(format);
  setRenderWindow(window_.Get());
  // VTK's own handling of mouse and keys stays out: turning keeps z upright and goes about what was clicked.
  setEnableHiDPI(false);
  scene_.attach(*window_);
  scene_.setGradual(true);
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setMinimumSize(160, 120);
  still_.setSingleShot(true);
  still_.setInterval(kStillAfter_ms);
  connect(&still_, &QTimer::timeout, this, [this] {
    if (isDragging()) return;
    scene_.setMoving(false);
    update();
  });
  soon_.setSingleShot(true);
  soon_.setInterval(0);
  connect(&soon_, &QTimer::timeout, this, [this] { update(); });
}

SceneWidget::~SceneWidget() {
  scene_.detach();
}

void SceneWidget::drawSoon() {
  soon_.start();
}

Eigen::Vector2d SceneWidget::pixelAt(const QPointF& place) const {
  const double ratio = devicePixelRatioF();
  return {place.x() * ratio, (height() - place.y()) * ratio};
}

QPointF SceneWidget::placeOf(const Eigen::Vector2d& pixel) const {
  const double ratio = devicePixelRatioF();
  return {pixel.x() / ratio, height() - pixel.y() / ratio};
}

Result<QImage> SceneWidget::pictureWithoutScreen() {
  const double ratio = devicePixelRatioF();
  auto offscreen = OffscreenWindow::make(static_cast<int>(std::lround(width() * ratio)),
                                         static_cast<int>(std::lround(height() * ratio)));
  if (!offscreen) return fail(offscreen.error());
  scene_.detach();
  scene_.attach((*offscreen)->window());
  scene_.setPixelRatio(ratio);
  scene_.setGradual(false);
  scene_.render();
  const RgbImage rgb = (*offscreen)->picture();
  scene_.detach();
  scene_.setGradual(true);
  scene_.attach(*window_);
  QImage image(rgb.width, rgb.height, QImage::Format_RGB32);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x)
      image.setPixel(x, y, qRgb(rgb.at(x, y).r, rgb.at(x, y).g, rgb.at(x, y).b));
  return image;
}

void SceneWidget::paintGL() {
  scene_.setPixelRatio(devicePixelRatioF());
  const int width_px = static_cast<int>(std::lround(width() * devicePixelRatioF()));
  const int height_px = static_cast<int>(std::lround(height() * devicePixelRatioF()));
  if (window_->GetSize()[0] != width_px || window_->GetSize()[1] != height_px)
    window_->SetSize(width_px, height_px);
  scene_.prepare();
  const auto begin = std::chrono::steady_clock::now();
  // Qt has drawn since and left OpenGL as it likes; what VTK remembers of it is no longer so.
  vtkOpenGLState& state = *window_->GetState();
  state.Reset();
  state.Push();
  state.vtkglDepthFunc(0x0203);  // GL_LEQUAL, as VTK expects; Qt sets GL_LESS
  window_->Render();
  state.Pop();
  if (scene_.isMoving()) {
    window_->WaitForCompletion();
    adaptMovingPoints(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  } else if (!scene_.isRefined()) {
    soon_.start();  // the rest when mouse and keys have had their turn
  }
  QVTKOpenGLNativeWidget::paintGL();
}

void SceneWidget::adaptMovingPoints(double frame_s) {
  if (frame_s < kQuickFrame_s)
    moving_points_ = std::min(kMostMovingPoints, moving_points_ + moving_points_ / 4);
  else if (frame_s > kSlowFrame_s)
    moving_points_ = std::max(kMovingPoints, moving_points_ - moving_points_ / 4);
  scene_.setMovingPoints(moving_points_);
}

QImage SceneWidget::wholePicture() {
  scene_.setGradual(false);
  const QImage picture = grabFramebuffer();
  scene_.setGradual(true);
  return picture;
}

Result<QImage> SceneWidget::pictureOf(const QSize& size, const SceneColours& colours,
                                      const SceneColours& usual) {
  makeCurrent();
  auto window = OffscreenWindow::inCurrentContext(size.width(), size.height());
  if (!window) return fail(window.error());
  const double ratio = scene_.pixelRatio();
  const double height_px = std::max(1.0, height() * devicePixelRatioF());
  scene_.attach((*window)->window());
  scene_.setGradual(false);
  scene_.setMoving(false);
  scene_.setColours(colours);
  scene_.setPixelRatio(ratio * size.height() / height_px);
  scene_.render();
  const RgbImage drawn = (*window)->picture();
  scene_.detach();
  window->reset();
  scene_.attach(*window_);
  scene_.setGradual(true);
  scene_.setColours(usual);
  scene_.setPixelRatio(ratio);
  doneCurrent();
  drawSoon();
  QImage picture(drawn.width, drawn.height, QImage::Format_RGB888);
  for (int y = 0; y < drawn.height; ++y) {
    unsigned char* line = picture.scanLine(y);
    for (int x = 0; x < drawn.width; ++x) {
      const Rgb c = drawn.at(x, y);
      line[3 * x] = c.r, line[3 * x + 1] = c.g, line[3 * x + 2] = c.b;
    }
  }
  return picture;
}

bool SceneWidget::event(QEvent* event) {
  // Digits and letters are this view's own keys, not shortcuts of the window.
  if (event->type() == QEvent::ShortcutOverride) {
    const auto* key = static_cast<QKeyEvent*>(event);
    if (!(key->modifiers() & (Qt::ControlModifier | Qt::AltModifier)) &&
        QString("02456789FMO+-=").contains(QChar(key->key())) && key->key() < 256)
      event->accept();
    return true;
  }
  switch (event->type()) {
    // The base class would hand these to VTK's interactor as well.
    case QEvent::MouseButtonPress:
      mousePressEvent(static_cast<QMouseEvent*>(event));
      return true;
    case QEvent::MouseButtonRelease:
      mouseReleaseEvent(static_cast<QMouseEvent*>(event));
      return true;
    case QEvent::MouseButtonDblClick:
      mouseDoubleClickEvent(static_cast<QMouseEvent*>(event));
      return true;
    case QEvent::MouseMove:
      mouseMoveEvent(static_cast<QMouseEvent*>(event));
      return true;
    case QEvent::Wheel:
      wheelEvent(static_cast<QWheelEvent*>(event));
      return true;
    default:
      return QVTKOpenGLNativeWidget::event(event);
  }
}

void SceneWidget::beginMoving() {
  scene_.setMoving(true);
  still_.start();
}

void SceneWidget::mousePressEvent(QMouseEvent* event) {
  setFocus(Qt::MouseFocusReason);
  buttons_ = event->buttons();
  pressed_ = last_ = event->localPos();
  dragged_ = false;
  handle_ = event->button() == Qt::LeftButton
                ? scene_.sliceHandleAt(pixelAt(pressed_), kGrasp_px * devicePixelRatioF())
                : std::nullopt;
  drags_divider_ = !handle_ && event->button() == Qt::LeftButton && isAtDivider(pressed_);
  if (!handle_ && !drags_divider_) scene_.setPivot(pixelAt(pressed_));
  event->accept();
}

bool SceneWidget::isAtDivider(const QPointF& place) const {
  return scene_.compare() == SceneCompare::Wipe &&
         std::abs(place.x() - scene_.divider() * width()) <= kGrasp_px;
}

void SceneWidget::showCursor(const QPointF& place) {
  if (scene_.sliceHandleAt(pixelAt(place), kGrasp_px * devicePixelRatioF()))
    setCursor(Qt::SizeAllCursor);
  else if (isAtDivider(place))
    setCursor(Qt::SplitHCursor);
  else
    unsetCursor();
}

void SceneWidget::dragTo(const QPointF& place, Qt::KeyboardModifiers keys) {
  const Eigen::Vector2d by = pixelAt(place) - pixelAt(last_);
  last_ = place;
  if (drags_divider_) {
    scene_.setDivider(place.x() / std::max(1, width()));  // the pictures of both sides stay as they are
    update();
    return;
  }
  beginMoving();
  if (handle_) {
    scene_.dragSlice(*handle_, by);
    Q_EMIT sliceDragged();
  } else if (buttons_ == Qt::LeftButton && !(keys & Qt::ShiftModifier)) {
    scene_.turn(by);
  } else {
    scene_.pan(by);
  }
  update();
}

void SceneWidget::mouseMoveEvent(QMouseEvent* event) {
  event->accept();
  if (!isDragging()) {
    showCursor(event->localPos());
    Q_EMIT hovered(event->localPos());
    return;
  }
  const QPointF from_press = event->localPos() - pressed_;
  if (!dragged_ && std::hypot(from_press.x(), from_press.y()) < kDragBegins_px) return;
  dragged_ = true;
  dragTo(event->localPos(), event->modifiers());
}

void SceneWidget::mouseReleaseEvent(QMouseEvent* event) {
  event->accept();
  const bool click = isDragging() && !dragged_ && event->button() == Qt::LeftButton;
  buttons_ = event->buttons();
  if (!isDragging()) {
    still_.start();
    handle_.reset();
    drags_divider_ = false;
  }
  if (click) Q_EMIT clicked(event->localPos());
}

void SceneWidget::mouseDoubleClickEvent(QMouseEvent* event) {
  mousePressEvent(event);
}

void SceneWidget::wheelEvent(QWheelEvent* event) {
  event->accept();
  if (!still_.isActive()) scene_.setPivot(pixelAt(event->position()));
  beginMoving();
  scene_.zoom(std::pow(1.15, event->angleDelta().y() / 120.0));
  update();
}

void SceneWidget::keyPressEvent(QKeyEvent* event) {
  const double step = 40.0 * devicePixelRatioF();
  const auto turned = [&](double x, double y) {
    scene_.setPivot(pixelAt(QPointF(0.5 * width(), 0.5 * height())));
    scene_.turn({x, y});
  };
  const auto zoomed = [&](double factor) {
    scene_.setPivot(pixelAt(QPointF(0.5 * width(), 0.5 * height())));
    scene_.zoom(factor);
  };
  if (event->modifiers() & (Qt::ControlModifier | Qt::AltModifier)) {
    event->ignore();
    return;
  }
  switch (event->key()) {
    case Qt::Key_8:
      scene_.setView(SceneView::Top);
      break;
    case Qt::Key_2:
      scene_.setView(SceneView::Bottom);
      break;
    case Qt::Key_5:
      scene_.setView(SceneView::Front);
      break;
    case Qt::Key_0:
      scene_.setView(SceneView::Back);
      break;
    case Qt::Key_4:
      scene_.setView(SceneView::Left);
      break;
    case Qt::Key_6:
      scene_.setView(SceneView::Right);
      break;
    case Qt::Key_7:
      scene_.setView(SceneView::Iso);
      break;
    case Qt::Key_9:
      scene_.setView(SceneView::IsoBack);
      break;
    case Qt::Key_F:
      Q_EMIT frameAsked();
      break;
    case Qt::Key_O:
      scene_.setOrthographic(!scene_.isOrthographic());
      Q_EMIT orthographicChanged();
      break;
    case Qt::Key_M:
      Q_EMIT measureAsked();
      break;
    case Qt::Key_Escape:
      Q_EMIT escaped();
      break;
    case Qt::Key_Left:
      turned(-step, 0);
      break;
    case Qt::Key_Right:
      turned(step, 0);
      break;
    case Qt::Key_Up:
      turned(0, step);
      break;
    case Qt::Key_Down:
      turned(0, -step);
      break;
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      zoomed(1.25);
      break;
    case Qt::Key_Minus:
      zoomed(0.8);
      break;
    default:
      event->ignore();
      return;
  }
  event->accept();
  update();
}

void SceneWidget::leaveEvent(QEvent* event) {
  Q_EMIT left();
  QVTKOpenGLNativeWidget::leaveEvent(event);
}

}  // namespace tiltmap::ui
