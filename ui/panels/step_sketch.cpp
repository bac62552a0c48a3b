#include "ui/panels/step_sketch.h"

#include <QPainter>
#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ui/look/theme.h"
#include "ui/models/step_words.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

constexpr double kGrid_m[] = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0};
constexpr double kCells = 4.0;       // at least so many of the grid along the shorter side
constexpr double kBorder_px = 34.0;  // for arrows and names
constexpr double kArrow_px = 22.0, kStop_px = 6.0;

}  // namespace

StepSketch::StepSketch(const Theme& theme, QWidget* parent) : QWidget(parent), theme_(theme) {
  describe(this, "step-sketch", "Sketch of the step",
           "The last stop and the new one from above, each with an arrow where it looks");
  connect(&theme, &Theme::changed, this, qOverload<>(&QWidget::update));
  fit();
}

void StepSketch::setStep(const std::optional<Pose>& step, bool first) {
  step_ = step;
  first_ = first;
  setAccessibleDescription(step ? stepInWords(*step) : QString());
  fit();
  update();
}

void StepSketch::fit() {
  const Eigen::Vector2d to = step_ ? Eigen::Vector2d(step_->translation().head<2>()) : Eigen::Vector2d(0, 0);
  middle_m_ = 0.5 * to;
  const double wide = std::max(20.0, width() - 2.0 * kBorder_px);
  const double high = std::max(20.0, height() - 2.0 * kBorder_px);
  // From step to step the scale stays what it is while the grid does.
  grid_m_ = std::end(kGrid_m)[-1];
  for (const double grid : kGrid_m) {
    const double scale = std::min(wide, high) / (kCells * grid);
    if (std::abs(to.x()) * scale > wide || std::abs(to.y()) * scale > high) continue;
    grid_m_ = grid;
    break;
  }
  pixels_a_metre_ = std::min(wide, high) / (kCells * grid_m_);
  // Further than the widest grid: as much smaller as it takes.
  pixels_a_metre_ = std::min(
      {pixels_a_metre_, wide / std::max(1e-6, std::abs(to.x())), high / std::max(1e-6, std::abs(to.y()))});
}

void StepSketch::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  fit();
}

QPointF StepSketch::placeOf(const Eigen::Vector2d& place_m) const {
  const Eigen::Vector2d from = pixels_a_metre_ * (place_m - middle_m_);
  return {width() / 2.0 + from.x(), height() / 2.0 - from.y()};
}

void StepSketch::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  painter.setRenderHint(QPainter::Antialiasing);
  paintGrid(painter);
  if (step_) {
    const Eigen::Vector2d to = step_->translation().head<2>();
    painter.setPen(QPen(theme_.colours().muted, 1.5, Qt::DashLine));
    painter.drawLine(placeOf({0, 0}), placeOf(to));
    paintStop(painter, {0, 0}, 0.0, false, "last");
    paintStop(painter, to, headingChange(*step_), true, "new");
  } else {
    paintStop(painter, {0, 0}, 0.0, first_, first_ ? "first" : "last");
  }
  painter.setRenderHint(QPainter::Antialiasing, false);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(theme_.colours().line);
  painter.drawRect(rect().adjusted(0, 0, -1, -1));
}

void StepSketch::paintGrid(QPainter& painter) const {
  painter.setRenderHint(QPainter::Antialiasing, false);
  QColor faint = theme_.colours().line;
  faint.setAlphaF(0.6);
  painter.setPen(faint);
  const double half_x = width() / 2.0 / pixels_a_metre_, half_y = height() / 2.0 / pixels_a_metre_;
  const auto lines = [this](double from, double to, const auto& draw) {
    // No more than can be told apart, however far the step.
    if ((to - from) / grid_m_ > 400.0) return;
    for (double k = std::ceil(from / grid_m_); k * grid_m_ <= to; k += 1.0) draw(k * grid_m_);
  };
  lines(middle_m_.x() - half_x, middle_m_.x() + half_x, [&](double x) {
    const double at = placeOf({x, 0.0}).x();
    painter.drawLine(QPointF(at, 0.0), QPointF(at, height()));
  });
  lines(middle_m_.y() - half_y, middle_m_.y() + half_y, [&](double y) {
    const double at = placeOf({0.0, y}).y();
    painter.drawLine(QPointF(0.0, at), QPointF(width(), at));
  });
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(theme_.colours().muted);
  painter.drawText(QRectF(rect()).adjusted(6, 2, -6, -3), Qt::AlignRight | Qt::AlignBottom,
                   "grid " + qt(shortestReal(grid_m_)) + " m");
}

void StepSketch::paintStop(QPainter& painter, const Eigen::Vector2d& place_m, double heading_rad, bool is_new,
                           const QString& name) const {
  const QPointF at = placeOf(place_m);
  const QPointF along(-std::sin(heading_rad), -std::cos(heading_rad)), across(-along.y(), along.x());
  const QColor colour = is_new ? theme_.colours().accent : palette().color(QPalette::Text);
  painter.setPen(QPen(colour, 2.0));
  painter.setBrush(is_new ? QBrush(colour) : QBrush(palette().color(QPalette::Base)));
  const QPointF tip = at + kArrow_px * along;
  painter.drawLine(at, tip - 5.0 * along);
  painter.drawEllipse(at, kStop_px, kStop_px);
  painter.setBrush(colour);
  painter.drawPolygon(QPolygonF({tip, tip - 7.0 * along + 4.0 * across, tip - 7.0 * along - 4.0 * across}));
  // Behind the stop, where the arrow is not, and at the side away from the line between the two.
  const QFontMetricsF metrics(painter.font());
  const QPointF away = at - 17.0 * along;
  const QSizeF size(metrics.horizontalAdvance(name) + 4.0, metrics.height());
  QRectF label(QPointF(away.x() - size.width() / 2.0, away.y() - size.height() / 2.0), size);
  label.moveLeft(is_new ? at.x() + 10.0 : at.x() - 10.0 - size.width());
  label.moveTop(std::clamp(label.top(), 2.0, std::max(2.0, height() - size.height() - 2.0)));
  label.moveLeft(std::clamp(label.left(), 2.0, std::max(2.0, width() - size.width() - 2.0)));
  painter.drawText(label, Qt::AlignCenter, name);
}

}  // namespace tiltmap::ui
