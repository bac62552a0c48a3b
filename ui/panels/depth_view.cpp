#include "ui/panels/depth_view.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/products/depth_figure.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr double kUsualLine_px = 15.0;  // the height of a line of text that the margins are meant for
constexpr double kLeft = 40.0, kRight = 66.0, kTop = 12.0, kBottom = 34.0;
constexpr double kBarWidth = 12.0;
constexpr double kMostZoom = 64.0;
const QColor kHoverMark(255, 170, 40), kPickMark(255, 90, 200);

}  // namespace

DepthView::DepthView(const Theme& theme, QWidget* parent) : QWidget(parent), theme_(theme) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  connect(&theme, &Theme::changed, this, &DepthView::redraw);
}

void DepthView::setImage(std::shared_ptr<const DepthImage> image, const QString& message) {
  if (image == image_ && message == message_) return;
  image_ = std::move(image);
  message_ = message;
  redraw();
}

void DepthView::setRange(std::optional<std::pair<double, double>> range) {
  range_ = range;
  redraw();
}

std::pair<double, double> DepthView::range() const {
  if (range_) return *range_;
  return image_ ? std::pair(image_->low, image_->high) : std::pair(0.0, 1.0);
}

void DepthView::setMarks(std::optional<MatrixCell> hovered_cell, std::optional<MatrixCell> picked_cell) {
  hovered_ = hovered_cell;
  picked_ = picked_cell;
  update();
}

void DepthView::redraw() {
  cells_ = {};
  if (image_) {
    const QColor none = theme_.colours().no_data;
    const auto [low, high] = range();
    const RgbImage picture =
        depthPicture(*image_, low, high,
                     {static_cast<std::uint8_t>(none.red()), static_cast<std::uint8_t>(none.green()),
                      static_cast<std::uint8_t>(none.blue())});
    cells_ = QImage(picture.width, picture.height, QImage::Format_RGB32);
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const Rgb c = picture.at(x, y);
        cells_.setPixel(x, y, qRgb(c.r, c.g, c.b));
      }
  }
  update();
}

void DepthView::redrawRow(int row) {
  if (!image_) return;
  const QColor none = theme_.colours().no_data;
  const auto [low, high] = range();
  for (int column = 0; column < image_->columns; ++column) {
    const float value = image_->value[image_->index(row, column)];
    QRgb colour = none.rgb();
    if (std::isfinite(value)) {
      const Rgb c = depthColour(*image_, value, low, high);
      colour = qRgb(c.r, c.g, c.b);
    }
    cells_.setPixel(image_->pixelOfColumn(column), image_->pixelOfRow(row), colour);
  }
  update();
}

QRectF DepthView::room() const {
  // Room for the axes' texts, of which two lines stand below.
  const QFontMetricsF metrics(font());
  const double larger = std::max(1.0, metrics.height() / kUsualLine_px);
  return QRectF(rect()).adjusted(kLeft * larger, kTop, -kRight * larger,
                                 -std::max(kBottom, 2.0 * metrics.height() + 8.0));
}

QRectF DepthView::whole() const {
  if (!image_) return {};
  const QRectF inside = room();
  const double wide = image_->columns * (image_->regular ? std::abs(image_->azimuth.step) : 1.0);
  const double high = image_->rows * (image_->regular ? std::abs(image_->tilt.step) : 1.0);
  const double scale = std::min(inside.width() / wide, inside.height() / high) * window_.zoom;
  const QSizeF size(wide * scale, high * scale);
  return {inside.center().x() - window_.centre.x() * size.width(),
          inside.center().y() - window_.centre.y() * size.height(), size.width(), size.height()};
}

std::optional<MatrixCell> DepthView::cellAt(const QPointF& place) const {
  const QRectF all = whole();
  if (!image_ || !all.contains(place) || !room().contains(place)) return {};
  const int x = static_cast<int>((place.x() - all.left()) / all.width() * image_->columns);
  const int y = static_cast<int>((place.y() - all.top()) / all.height() * image_->rows);
  if (x < 0 || y < 0 || x >= image_->columns || y >= image_->rows) return {};
  return MatrixCell{image_->rowAtPixel(y), image_->columnAtPixel(x)};
}

QPointF DepthView::placeOf(const MatrixCell& cell) const {
  if (!image_) return {};
  const QRectF all = whole();
  return {all.left() + (image_->pixelOfColumn(cell.column) + 0.5) / image_->columns * all.width(),
          all.top() + (image_->pixelOfRow(cell.row) + 0.5) / image_->rows * all.height()};
}

void DepthView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  if (!image_) {
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap, message_);
    return;
  }
  const QRectF all = whole(), seen = all.intersected(room());
  painter.save();
  painter.setClipRect(seen);
  // Cells stay cells: no smoothing, which would invent ranges between near and far.
  painter.drawImage(all, cells_);
  if (picked_) paintMark(painter, *picked_, kPickMark);
  if (hovered_) paintMark(painter, *hovered_, kHoverMark);
  painter.restore();
  paintAxes(painter, seen, all);
  if (image_->hasColourBar()) paintBar(painter, seen);
}

void DepthView::paintMark(QPainter& painter, const MatrixCell& cell, const QColor& colour) const {
  const QPointF place = placeOf(cell);
  const QRectF all = whole();
  const double radius = std::max(6.0, 0.5 * all.width() / image_->columns + 3.0);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(QColor(0, 0, 0, 190), 4.0));
  painter.drawEllipse(place, radius, radius);
  painter.setPen(QPen(colour, 2.0));
  painter.drawEllipse(place, radius, radius);
}

void DepthView::paintAxes(QPainter& painter, const QRectF& seen, const QRectF& all) const {
  painter.setRenderHint(QPainter::Antialiasing, false);
  painter.setPen(theme_.colours().muted);
  QFont font = this->font();
  font.setPointSizeF(std::max(7.5, font.pointSizeF() - 1.0));
  painter.setFont(font);
  const QFontMetricsF metrics(font);
  const auto span = [](const DepthAxis& axis, int cells, double from, double to, bool turned) {
    const double a = turned ? cells - 0.5 - from * cells : from * cells - 0.5;
    const double b = turned ? cells - 0.5 - to * cells : to * cells - 0.5;
    return std::pair(std::min(axis.at(a), axis.at(b)), std::max(axis.at(a), axis.at(b)));
  };
  const auto share = [](const DepthAxis& axis, int cells, double value, bool turned) {
    const double cell = axis.cellOf(value);
    return (turned ? cells - 0.5 - cell : cell + 0.5) / cells;
  };
  const auto [x_low, x_high] =
      span(image_->azimuth, image_->columns, (seen.left() - all.left()) / all.width(),
           (seen.right() - all.left()) / all.width(), image_->columnsTurned());
  for (const double value : axisTicks(x_low, x_high, std::max(2, static_cast<int>(seen.width() / 44.0)))) {
    const double x =
        all.left() + share(image_->azimuth, image_->columns, value, image_->columnsTurned()) * all.width();
    painter.drawLine(QPointF(x, seen.bottom() + 1), QPointF(x, seen.bottom() + 5));
    painter.drawText(QRectF(x - 30, seen.bottom() + 5, 60, metrics.height()), Qt::AlignHCenter | Qt::AlignTop,
                     qt(shortestReal(value)));
  }
  const auto [y_low, y_high] = span(image_->tilt, image_->rows, (seen.top() - all.top()) / all.height(),
                                    (seen.bottom() - all.top()) / all.height(), image_->rowsTurned());
  for (const double value : axisTicks(y_low, y_high, std::max(2, static_cast<int>(seen.height() / 28.0)))) {
    const double y =
        all.top() + share(image_->tilt, image_->rows, value, image_->rowsTurned()) * all.height();
    painter.drawLine(QPointF(seen.left() - 5, y), QPointF(seen.left() - 1, y));
    painter.drawText(QRectF(seen.left() - 40, y - 10, 33, 20), Qt::AlignRight | Qt::AlignVCenter,
                     qt(shortestReal(value)));
  }
  const QString caption = qt(image_->azimuth.title) + "  ×  " + qt(image_->tilt.title).toLower();
  painter.drawText(
      QRectF(seen.left() - 40, seen.bottom() + 5 + metrics.height(), seen.width() + 80, metrics.height()),
      Qt::AlignHCenter | Qt::AlignTop, caption);
}

void DepthView::paintBar(QPainter& painter, const QRectF& seen) const {
  const auto [low, high] = range();
  if (!(high > low)) return;
  const QFontMetricsF metrics(painter.font());
  const QRectF bar(seen.right() + 12, seen.top() + metrics.height(), kBarWidth,
                   std::max(10.0, seen.height() - metrics.height()));
  for (int y = 0; y < static_cast<int>(bar.height()); ++y) {
    const Rgb c = depthColour(*image_, high - y / (bar.height() - 1.0) * (high - low), low, high);
    painter.fillRect(QRectF(bar.left(), bar.top() + y, bar.width(), 1.0), QColor(c.r, c.g, c.b));
  }
  if (!image_->unit.empty())
    painter.drawText(QRectF(bar.left() - 2, bar.top() - metrics.height() - 2, 50, metrics.height()),
                     Qt::AlignLeft | Qt::AlignVCenter, qt(image_->unit));
  for (const double value : axisTicks(low, high, std::max(2, static_cast<int>(bar.height() / 28.0)))) {
    const double y = bar.bottom() - (value - low) / (high - low) * bar.height();
    painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + 3, y));
    painter.drawText(QRectF(bar.right() + 6, y - 10, 40, 20), Qt::AlignLeft | Qt::AlignVCenter,
                     qt(shortestReal(value)));
  }
}

void DepthView::setWindow(const DepthWindow& window) {
  window_ = window;
  update();
}

void DepthView::changeWindow(DepthWindow window) {
  window.zoom = std::clamp(window.zoom, 1.0, kMostZoom);
  // Some of the matrix is always there.
  const double free = window.zoom > 1.0 ? 0.5 : 0.0;
  window.centre = {std::clamp(window.centre.x(), 0.5 - free, 0.5 + free),
                   std::clamp(window.centre.y(), 0.5 - free, 0.5 + free)};
  if (window == window_) return;
  window_ = window;
  update();
  Q_EMIT windowChanged(window_);
}

void DepthView::zoomAt(const QPointF& place, double factor) {
  if (!image_) return;
  const QRectF all = whole();
  const QPointF part((place.x() - all.left()) / all.width(), (place.y() - all.top()) / all.height());
  DepthWindow to = window_;
  to.zoom = std::clamp(window_.zoom * factor, 1.0, kMostZoom);
  // The same part of the picture stays below the pointer.
  const double ratio = window_.zoom / to.zoom;
  to.centre = part + (window_.centre - part) * ratio;
  changeWindow(to);
}

void DepthView::mousePressEvent(QMouseEvent* event) {
  if (!image_) return;
  dragging_ = true;
  dragged_ = false;
  pressed_ = last_ = event->localPos();
}

void DepthView::mouseMoveEvent(QMouseEvent* event) {
  if (!dragging_) {
    Q_EMIT hovered(cellAt(event->localPos()));
    return;
  }
  const QPointF from_press = event->localPos() - pressed_;
  if (!dragged_ && std::hypot(from_press.x(), from_press.y()) < 4.0) return;
  dragged_ = true;
  const QRectF all = whole();
  const QPointF by = event->localPos() - last_;
  last_ = event->localPos();
  DepthWindow to = window_;
  to.centre -= QPointF(by.x() / all.width(), by.y() / all.height());
  changeWindow(to);
}

void DepthView::mouseReleaseEvent(QMouseEvent* event) {
  const bool click = dragging_ && !dragged_ && event->button() == Qt::LeftButton;
  dragging_ = false;
  if (!click) return;
  if (const auto cell = cellAt(event->localPos())) Q_EMIT picked(*cell);
}

void DepthView::mouseDoubleClickEvent(QMouseEvent*) {
  changeWindow({});
}

void DepthView::wheelEvent(QWheelEvent* event) {
  event->accept();
  zoomAt(event->position(), std::pow(1.25, event->angleDelta().y() / 120.0));
}

void DepthView::keyPressEvent(QKeyEvent* event) {
  const auto step = [&](int right, int up) {
    if (!image_) return;
    const MatrixCell from = picked_.value_or(MatrixCell{image_->rows / 2, image_->columns / 2});
    const int x = std::clamp(image_->pixelOfColumn(from.column) + right, 0, image_->columns - 1);
    const int y = std::clamp(image_->pixelOfRow(from.row) - up, 0, image_->rows - 1);
    Q_EMIT picked({image_->rowAtPixel(y), image_->columnAtPixel(x)});
  };
  switch (event->key()) {
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      zoomAt(room().center(), 1.25);
      break;
    case Qt::Key_Minus:
      zoomAt(room().center(), 0.8);
      break;
    case Qt::Key_F:
    case Qt::Key_Home:
      changeWindow({});
      break;
    case Qt::Key_Left:
      step(-1, 0);
      break;
    case Qt::Key_Right:
      step(1, 0);
      break;
    case Qt::Key_Up:
      step(0, 1);
      break;
    case Qt::Key_Down:
      step(0, -1);
      break;
    default:
      QWidget::keyPressEvent(event);
  }
}

bool DepthView::event(QEvent* event) {
  // The dock's tooltip would lie over the cells; what is under the pointer stands in the read-out.
  if (event->type() == QEvent::ToolTip) return true;
  return QWidget::event(event);
}

void DepthView::leaveEvent(QEvent* event) {
  Q_EMIT hovered({});
  QWidget::leaveEvent(event);
}

}  // namespace tiltmap::ui
