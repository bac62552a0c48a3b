#include "ui/panels/polar_view.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/products/depth_image.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

constexpr double kRings_m[] = {5.0, 10.0, 20.0, 40.0, 80.0};
constexpr double kMargin_px = 12.0;
constexpr double kShareInside = 0.98;
constexpr double kRoomLeft = 0.9;  // of a smaller ring, before it is chosen
constexpr double kPoint_px = 3.2;

double ringFor(double farthest_m) {
  for (const double ring : kRings_m)
    if (farthest_m <= ring) return ring;
  return std::end(kRings_m)[-1];
}

}  // namespace

BeamKind beamKind(CellCode code) {
  if (cell_code::hasPoint(code)) return BeamKind::Echo;
  if (code == cell_code::kNoReturn || code == cell_code::kLmsFirst || code == cell_code::kLmsNoSignal)
    return BeamKind::NoEcho;
  return code > cell_code::kLmsFirst && code <= cell_code::kLmsLast ? BeamKind::Trouble : BeamKind::Left;
}

PolarView::PolarView(const Theme& theme, QWidget* parent) : QWidget(parent), theme_(theme) {
  describe(
      this, "polar-view", "Current line",
      "The line that the scanner has just measured, seen from above with forward up. Point at a beam, or "
      "press the left and right arrow keys, to read it.");
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  connect(&theme, &Theme::changed, this, qOverload<>(&QWidget::update));
}

void PolarView::setLine(std::span<const float> ranges_m, std::span<const double> azimuths_rad,
                        std::span<const CellCode> codes) {
  if (ranges_m.size() != azimuths_rad.size() || ranges_m.size() != codes.size())
    throw std::invalid_argument("a line has as many ranges as azimuths and codes");
  ranges_.assign(ranges_m.begin(), ranges_m.end());
  codes_.assign(codes.begin(), codes.end());
  if (!std::ranges::equal(azimuths_, azimuths_rad)) {
    azimuths_.assign(azimuths_rad.begin(), azimuths_rad.end());
    directions_.clear();
    for (const double a : azimuths_) directions_.emplace_back(std::cos(a), -std::sin(a));
  }
  if (marked_ && *marked_ >= static_cast<int>(ranges_.size())) marked_.reset();
  chooseRing(farthest());
  update();
}

void PolarView::clear() {
  ranges_.clear();
  codes_.clear();
  azimuths_.clear();
  directions_.clear();
  marked_.reset();
  outer_m_ = 0.0;
  fitting_lines_ = 0;
  update();
}

double PolarView::farthest() const {
  std::vector<float> points;
  for (std::size_t k = 0; k < ranges_.size(); ++k)
    if (beamKind(codes_[k]) == BeamKind::Echo && std::isfinite(ranges_[k])) points.push_back(ranges_[k]);
  if (points.empty()) return 0.0;
  return static_cast<double>(quantileOf(points, kShareInside));
}

void PolarView::chooseRing(double farthest_m) {
  const double needed = ringFor(farthest_m);
  if (needed > outer_m_ || outer_m_ == 0.0) {
    outer_m_ = needed;
    fitting_lines_ = 0;
    return;
  }
  // The next smaller one has to be enough for a while, with room left: else the picture would jump with
  // every line that just reaches over it.
  const auto next = std::ranges::find(kRings_m, outer_m_);
  const bool fits = next != std::begin(kRings_m) && farthest_m <= kRoomLeft * *std::prev(next);
  fitting_lines_ = fits ? fitting_lines_ + 1 : 0;
  if (fitting_lines_ < kSteadyLines) return;
  outer_m_ = *std::prev(next);
  fitting_lines_ = 0;
}

double PolarView::lowest() const {
  double low = 0.0;
  for (const QPointF& d : directions_) low = std::max(low, d.y());
  return low < 0.02 ? 0.0 : low;
}

int PolarView::readoutLines() const {
  // By the width alone: the picture must not jump with the words.
  return width() < 56.0 * QFontMetricsF(font()).averageCharWidth() ? 2 : 1;
}

QRectF PolarView::room() const {
  const double line = QFontMetricsF(font()).height();
  return QRectF(rect()).adjusted(kMargin_px, kMargin_px, -kMargin_px, -(1.0 + readoutLines()) * line - 6.0);
}

QPointF PolarView::centre() const {
  const QRectF inside = room();
  const double radius = scale() * outer_m_;
  const double high = radius * (1.0 + lowest());
  return {inside.center().x(), inside.center().y() + high / 2.0 - radius * lowest()};
}

double PolarView::scale() const {
  if (outer_m_ == 0.0) return 1.0;
  const QRectF inside = room();
  return std::max(1.0, std::min(inside.width() / 2.0, inside.height() / (1.0 + lowest()))) / outer_m_;
}

QPointF PolarView::direction(int beam) const {
  return directions_[static_cast<std::size_t>(beam)];
}

bool PolarView::isBeyond(int beam) const {
  const auto k = static_cast<std::size_t>(beam);
  return beamKind(codes_[k]) == BeamKind::Echo && static_cast<double>(ranges_[k]) > outer_m_;
}

QPointF PolarView::placeOf(int beam) const {
  const auto k = static_cast<std::size_t>(beam);
  const bool inside = beamKind(codes_[k]) == BeamKind::Echo && !isBeyond(beam);
  return centre() + direction(beam) * scale() * (inside ? static_cast<double>(ranges_[k]) : outer_m_);
}

QString PolarView::readout() const {
  if (ranges_.empty()) return {};
  if (marked_) {
    const auto k = static_cast<std::size_t>(*marked_);
    const QString azimuth = qt(fixedReal(azimuths_[k] / kDegree, 1));
    const bool echo = beamKind(codes_[k]) == BeamKind::Echo;
    return QString("Azimuth %1°: %2%3")
        .arg(azimuth, echo ? qt(fixedReal(static_cast<double>(ranges_[k]), 2)) + " m, " : QString(),
             qt(cellCodeText(codes_[k])));
  }
  std::array<int, 4> counts{};
  for (const CellCode code : codes_) ++counts[static_cast<std::size_t>(beamKind(code))];
  QString text = QString("%1 of %2 echoes").arg(counts[0]).arg(codes_.size());
  if (counts[1] > 0) text += QString(" · %1 none\u00a0(|)").arg(counts[1]);
  if (counts[2] > 0) text += QString(" · %1 dazzled\u00a0(×)").arg(counts[2]);
  if (counts[3] > 0) text += QString(" · %1 left out").arg(counts[3]);
  return text;
}

void PolarView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  if (ranges_.empty()) {
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap,
                     "No line yet. Once the scanner is connected, the line it measures is drawn here.");
  } else {
    painter.setRenderHint(QPainter::Antialiasing);
    paintRings(painter);
    paintBeams(painter);
    paintMark(painter);
    paintReadout(painter);
  }
  if (hasFocus()) {
    painter.setRenderHint(QPainter::Antialiasing, false);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(theme_.colours().accent);
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
}

void PolarView::paintRings(QPainter& painter) const {
  const QPointF middle = centre();
  const double radius = scale() * outer_m_;
  const bool half = lowest() == 0.0;
  const ThemeColours& colours = theme_.colours();
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(colours.line, 1.0));
  // Forward, right and left.
  painter.drawLine(middle, middle - QPointF(0.0, radius));
  painter.drawLine(middle - QPointF(radius, 0.0), middle + QPointF(radius, 0.0));
  const int rings = outer_m_ <= 10.0 ? 5 : 4;  // 1, 2, 5, 10 or 20 m apart
  const double ring_m = outer_m_ / rings;
  for (int k = 1; k <= rings; ++k) {
    const double r = k * ring_m * scale();
    const QRectF box(middle.x() - r, middle.y() - r, 2.0 * r, 2.0 * r);
    if (half)
      painter.drawArc(box, 0, 180 * 16);
    else
      painter.drawEllipse(box);
  }
  // Numbers along the right axis, below it where nothing is drawn.
  const QFontMetricsF metrics(painter.font());
  painter.setPen(colours.muted);
  const double y = half ? middle.y() + 2.0 : middle.y() + 1.0;
  const bool every = ring_m * scale() > metrics.horizontalAdvance("00") + 10.0;
  for (int k = 1; k <= rings; ++k) {
    if (!every && k != rings) continue;
    // The last one with its unit reaches to the left.
    const double free =
        ring_m * scale() - metrics.horizontalAdvance("00 m") - metrics.horizontalAdvance("00") / 2.0;
    if (k == rings - 1 && free < 0.0) continue;
    const double x = middle.x() + k * ring_m * scale();
    const QString text = qt(shortestReal(k * ring_m)) + (k == rings ? " m" : "");
    const bool last = k == rings;
    painter.drawText(
        QRectF(x - (last ? 80.0 : 40.0), y, last ? 80.0 + (half ? 8.0 : -3.0) : 80.0, metrics.height()),
        (last ? Qt::AlignRight : Qt::AlignHCenter) | Qt::AlignTop, text);
  }
}

void PolarView::paintBeams(QPainter& painter) const {
  const QPointF middle = centre();
  const ThemeColours& colours = theme_.colours();
  // What the beams have passed through is free.
  QPolygonF free;
  free << middle;
  const int count = static_cast<int>(ranges_.size());
  std::vector<QPointF> points;
  for (int beam = 0; beam < count; ++beam) {
    const BeamKind kind = beamKind(codes_[static_cast<std::size_t>(beam)]);
    const QPointF place = placeOf(beam), along = direction(beam), across(-along.y(), along.x());
    free << (kind == BeamKind::Echo ? place : middle);
    switch (kind) {
      case BeamKind::Echo:
        if (!isBeyond(beam)) {
          points.push_back(place);
        } else {
          painter.setPen(Qt::NoPen);
          painter.setBrush(colours.accent);
          painter.drawPolygon(QPolygonF(
              {place + 5.0 * along, place - 1.0 * along + 3.0 * across, place - 1.0 * along - 3.0 * across}));
        }
        break;
      case BeamKind::NoEcho:
        painter.setPen(QPen(colours.muted, 1.2));
        painter.drawLine(place, place + 6.0 * along);
        break;
      case BeamKind::Trouble:
        painter.setPen(QPen(colours.error, 1.6));
        painter.drawLine(place - 3.0 * along - 3.0 * across, place + 3.0 * along + 3.0 * across);
        painter.drawLine(place - 3.0 * along + 3.0 * across, place + 3.0 * along - 3.0 * across);
        break;
      case BeamKind::Left:
        break;
    }
  }
  QColor ground = colours.accent;
  ground.setAlphaF(0.14);
  painter.setPen(Qt::NoPen);
  painter.setBrush(ground);
  painter.drawPolygon(free);
  painter.setPen(QPen(colours.accent, kPoint_px, Qt::SolidLine, Qt::RoundCap));
  painter.drawPoints(points.data(), static_cast<int>(points.size()));
  painter.setPen(Qt::NoPen);
  // The scanner: a triangle that looks forward.
  painter.setBrush(palette().color(QPalette::Text));
  painter.drawPolygon(
      QPolygonF({middle - QPointF(0.0, 9.0), middle + QPointF(5.0, 3.0), middle + QPointF(-5.0, 3.0)}));
}

void PolarView::paintMark(QPainter& painter) const {
  if (!marked_) return;
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(palette().color(QPalette::Text), 1.6));
  const QPointF place = placeOf(*marked_);
  painter.drawLine(centre(), place);
  painter.drawEllipse(place, 5.0, 5.0);
}

void PolarView::paintReadout(QPainter& painter) const {
  const double high = readoutLines() * QFontMetricsF(painter.font()).height();
  painter.setPen(palette().color(QPalette::Text));
  painter.drawText(QRectF(8.0, height() - high - 4.0, width() - 16.0, high),
                   Qt::AlignHCenter | Qt::AlignVCenter | Qt::TextWordWrap, readout());
}

void PolarView::mark(std::optional<int> beam) {
  if (beam == marked_) return;
  marked_ = beam;
  setAccessibleDescription(readout());
  update();
}

void PolarView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF from = event->localPos() - centre();
  const double distance = std::hypot(from.x(), from.y());
  std::optional<int> nearest;
  double best = 0.0;
  for (int beam = 0; beam < static_cast<int>(directions_.size()) && distance > 4.0; ++beam) {
    const double cosine = QPointF::dotProduct(direction(beam), from) / distance;
    if (cosine > best) best = cosine, nearest = beam;
  }
  // Nothing where no beam looks.
  mark(best > std::cos(2.0 * kDegree) ? nearest : std::nullopt);
}

void PolarView::leaveEvent(QEvent* event) {
  mark({});
  QWidget::leaveEvent(event);
}

void PolarView::keyPressEvent(QKeyEvent* event) {
  const int count = static_cast<int>(ranges_.size());
  const bool left = event->key() == Qt::Key_Left;
  if (event->key() == Qt::Key_Escape && marked_) {
    mark({});
  } else if (count > 0 && (left || event->key() == Qt::Key_Right)) {
    // To the left on the screen, wherever the first beam looks.
    const int to_left = directions_.back().x() < directions_.front().x() ? 1 : -1;
    const int step = left ? to_left : -to_left;
    mark(std::clamp(marked_.value_or(count / 2 - step) + step, 0, count - 1));
  } else {
    QWidget::keyPressEvent(event);
  }
}

}  // namespace tiltmap::ui
