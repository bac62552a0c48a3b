#include "ui/panels/movement_plot.h"

#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QToolTip>
#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ui/look/theme.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/site_map_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr double kReach_px = 6.0;

QString millimetres(double metres) {
  const double mm = 1000.0 * metres;
  return qt(fixedReal(mm, mm < 10.0 ? 1 : 0)) + " mm";
}

// Tick distance for about four ticks.
double tickOf(double largest) {
  return roundLength(std::max(largest, 1e-6) / 3.0);
}

}  // namespace

MovementPlot::MovementPlot(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context) {
  setObjectName("relax-plot");
  setAccessibleName("Movement of each scan by step");
  setMinimumSize(160, 100);
  setMouseTracking(true);
  const auto again = qOverload<>(&QWidget::update);
  connect(&context.workspace.relaxation(), &RelaxationModel::changed, this, again);
  connect(&context.workspace.relaxation(), &RelaxationModel::reset, this, again);
  connect(&context.workspace.selection(), &Selection::scansChanged, this, again);
  connect(&context.theme, &Theme::changed, this, again);
}

QPointF MovementPlot::Axes::moved(double step, double metres) const {
  return {area.left() + area.width() * step / steps, area.bottom() - area.height() * metres / moved_m};
}
QPointF MovementPlot::Axes::rms(double step, double metres) const {
  return {area.left() + area.width() * step / steps, area.bottom() - area.height() * metres / rms_m};
}

MovementPlot::Axes MovementPlot::axes() const {
  Axes axes;
  const int side = fontMetrics().horizontalAdvance("1000 mm") + 10, line = fontMetrics().height();
  axes.area = QRectF(rect()).adjusted(side, line + 8, -side, -2 * line - 6);
  for (const RelaxationRecord& record : context_.workspace.relaxation().records()) {
    axes.steps = std::max(axes.steps, static_cast<double>(record.step));
    axes.rms_m = std::max(axes.rms_m, record.rms_m);
    for (const double moved : record.moved_m) axes.moved_m = std::max(axes.moved_m, moved);
  }
  axes.moved_m = std::max(1.1 * axes.moved_m, 1e-3);
  axes.rms_m = std::max(1.1 * axes.rms_m, 1e-3);
  return axes;
}

void MovementPlot::drawAxes(QPainter& painter, const Axes& axes) const {
  const ThemeColours& c = context_.theme.colours();
  const int line = painter.fontMetrics().height();
  const auto rows = [&](double largest, bool left) {
    const double tick = tickOf(largest);
    for (double value = 0.0; value <= largest; value += tick) {
      const double y = axes.area.bottom() - axes.area.height() * value / largest;
      if (left) {
        painter.setPen(QPen(c.line, 1.0));
        painter.drawLine(QPointF(axes.area.left(), y), QPointF(axes.area.right(), y));
      }
      painter.setPen(c.muted);
      const QRectF box =
          left ? QRectF(0, y - line / 2.0, axes.area.left() - 5, line)
               : QRectF(axes.area.right() + 5, y - line / 2.0, width() - axes.area.right() - 5, line);
      painter.drawText(box, (left ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter, millimetres(value));
    }
  };
  rows(axes.moved_m, true);
  rows(axes.rms_m, false);
  const double tick = std::max(1.0, roundLength(axes.steps / 4.0));
  for (double step = 0.0; step <= axes.steps; step += tick) {
    const double x = axes.moved(step, 0.0).x();
    painter.setPen(c.muted);
    painter.drawText(QRectF(x - 30, axes.area.bottom() + 2, 60, line), Qt::AlignCenter,
                     qt(shortestReal(step)));
  }
  painter.setPen(QPen(c.muted, 1.0));
  painter.drawLine(axes.area.bottomLeft(), axes.area.bottomRight());
  painter.setPen(palette().color(QPalette::Text));
  painter.drawText(QRectF(4, 2, width() / 2.0, line), Qt::AlignLeft, "Moved from the start");
  painter.drawText(QRectF(width() / 2.0, 2, width() / 2.0 - 4, line), Qt::AlignRight, "Residual (dashed)");
  painter.drawText(QRectF(0, axes.area.bottom() + line + 2, width(), line), Qt::AlignCenter, "step");
}

void MovementPlot::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  const RelaxationModel& relaxation = context_.workspace.relaxation();
  const auto& records = relaxation.records();
  if (records.empty()) {
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect().adjusted(16, 8, -16, -8), Qt::AlignCenter | Qt::TextWordWrap,
                     relaxation.isRunning() ? "The first step is not done yet."
                                            : "How far each scan moves, step by step, is drawn here while a "
                                              "relaxation runs.");
    return;
  }
  const Axes plot = axes();
  drawAxes(painter, plot);
  const auto& scans = relaxation.scans();
  const Selection& selection = context_.workspace.selection();
  const bool any = std::ranges::any_of(scans, [&](ScanId scan) { return selection.isSelected(scan); });
  for (const bool chosen : {false, true})
    for (std::size_t i = 0; i < scans.size(); ++i) {
      if (selection.isSelected(scans[i]) != chosen) continue;
      QPainterPath path(plot.moved(0, 0));
      for (const RelaxationRecord& record : records) path.lineTo(plot.moved(record.step, record.moved_m[i]));
      QColor colour = context_.workspace.display().colour(scans[i]);
      if (any && !chosen) colour.setAlphaF(0.35);
      painter.setPen(QPen(colour, chosen ? 3.0 : 1.5));
      painter.drawPath(path);
    }
  QPainterPath residual;
  bool begun = false;
  for (const RelaxationRecord& record : records) {
    if (record.rms_m <= 0.0) continue;
    const QPointF at = plot.rms(record.step, record.rms_m);
    begun ? residual.lineTo(at) : residual.moveTo(at);
    begun = true;
  }
  painter.setPen(QPen(palette().color(QPalette::Text), 1.5, Qt::DashLine));
  painter.drawPath(residual);
}

int MovementPlot::scanNear(const QPointF& at) const {
  const auto& records = context_.workspace.relaxation().records();
  if (records.empty()) return -1;
  const Axes plot = axes();
  int nearest = -1;
  double best = kReach_px;
  for (std::size_t i = 0; i < records.front().moved_m.size(); ++i) {
    QPointF before = plot.moved(0, 0);
    for (const RelaxationRecord& record : records) {
      const QPointF after = plot.moved(record.step, record.moved_m[i]);
      if (at.x() >= before.x() - 1 && at.x() <= after.x() + 1) {
        const double t = after.x() > before.x() ? (at.x() - before.x()) / (after.x() - before.x()) : 1.0;
        const double off = std::abs(before.y() + t * (after.y() - before.y()) - at.y());
        if (off < best) best = off, nearest = static_cast<int>(i);
      }
      before = after;
    }
  }
  return nearest;
}

void MovementPlot::mousePressEvent(QMouseEvent* event) {
  const int scan = scanNear(event->localPos());
  const auto& scans = context_.workspace.relaxation().scans();
  if (scan >= 0) context_.workspace.selection().setCurrentScan(scans[static_cast<std::size_t>(scan)]);
}

bool MovementPlot::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const int scan = scanNear(help->pos());
  if (scan < 0) {
    QToolTip::hideText();
    return true;
  }
  const auto& records = context_.workspace.relaxation().records();
  QToolTip::showText(help->globalPos(),
                     QString("Scan %1: %2 from its start")
                         .arg(scan)
                         .arg(millimetres(records.back().moved_m[static_cast<std::size_t>(scan)])),
                     this);
  return true;
}

}  // namespace tiltmap::ui
