// The plan of the site as it is painted: picture, grid, links, stops, legend.
#include <QPainter>
#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ui/look/theme.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/marks.h"
#include "ui/panels/site_map_view.h"

namespace tiltmap::ui {

namespace {

constexpr double kStop_px = 5.5;
constexpr double kHeading_px = 17.0;

// Text that is legible over lines and pictures.
void drawLabel(QPainter& painter, const QPointF& at, const QString& text, const QColor& colour,
               const QColor& ground) {
  QRectF box = painter.fontMetrics().boundingRect(text);
  box.moveTopLeft(at);
  QColor faint = ground;
  faint.setAlphaF(0.7);
  painter.fillRect(box.adjusted(-2, 0, 2, 0), faint);
  painter.setPen(colour);
  painter.drawText(box, Qt::AlignCenter, text);
}

QString lengthName(double metres) {
  if (metres >= 1000.0) return qt(shortestReal(metres / 1000.0)) + " km";
  return metres >= 1.0 ? qt(shortestReal(metres)) + " m"
                       : qt(shortestReal(std::round(metres * 100.0))) + " cm";
}

}  // namespace

void SiteMapView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.fillRect(rect(), palette().color(QPalette::Base));
  if (picture_shown_) drawPicture(painter);
  drawGrid(painter);
  drawLinks(painter);
  drawStops(painter);
  if (placing_) drawPlacing(painter);
  drawScale(painter);
  drawNorth(painter);
  if (legend_shown_) drawLegend(painter);
}

void SiteMapView::drawPicture(QPainter& painter) const {
  if (!model_.placement() || model_.picture().isNull()) return;
  const SitePicturePlacement& placed = *model_.placement();
  const auto pixel = [&](double x, double y) {
    const Eigen::Vector2d world = placed.worldOf({x, y});
    return seen_.pixelOf({world.x(), world.y()});
  };
  const QPointF origin = pixel(0, 0), right = pixel(1, 0) - origin, down = pixel(0, 1) - origin;
  painter.save();
  painter.setTransform(QTransform(right.x(), right.y(), down.x(), down.y(), origin.x(), origin.y()), true);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.setOpacity(0.8);
  painter.drawImage(QPointF(0, 0), model_.picture());
  painter.restore();
}

void SiteMapView::drawGrid(QPainter& painter) const {
  const double step = roundLength(90.0 / seen_.px_per_m);
  if (step <= 0.0) return;
  const ThemeColours& c = context_.theme.colours();
  painter.setPen(QPen(c.line, 1.0));
  const QPointF low = seen_.worldOf({0.0, static_cast<double>(height())});
  const QPointF high = seen_.worldOf({static_cast<double>(width()), 0.0});
  for (double x = std::ceil(low.x() / step) * step; x <= high.x(); x += step) {
    const double px = std::round(seen_.pixelOf({x, 0.0}).x()) + 0.5;
    painter.drawLine(QPointF(px, 0), QPointF(px, height()));
  }
  for (double y = std::ceil(low.y() / step) * step; y <= high.y(); y += step) {
    const double px = std::round(seen_.pixelOf({0.0, y}).y()) + 0.5;
    painter.drawLine(QPointF(0, px), QPointF(width(), px));
  }
}

void SiteMapView::drawLinks(QPainter& painter) const {
  const ThemeColours& c = context_.theme.colours();
  // The worst on top, the chosen ones above all.
  std::vector<const MapLink*> order;
  for (const MapLink& link : model_.links()) order.push_back(&link);
  std::ranges::stable_sort(order, {}, [](const MapLink* link) {
    const int rank = link->quality == LinkQuality::Disabled    ? 0
                     : link->quality == LinkQuality::NotJudged ? 1
                                                               : 2 + static_cast<int>(link->quality);
    return link->selected || link->left_out ? 100 : link->live ? -1 : rank;
  });
  for (const MapLink* link : order) {
    const QPointF a = seen_.pixelOf(link->from_m), b = seen_.pixelOf(link->to_m);
    if (link->selected) {
      QColor halo = palette().color(QPalette::Highlight);
      halo.setAlphaF(0.55);
      painter.setPen(QPen(halo, 8.0, Qt::SolidLine, Qt::RoundCap));
      painter.drawLine(a, b);
    }
    if (link->live) {
      QColor faint = c.accent;
      faint.setAlphaF(0.45);
      painter.setPen(QPen(faint, 1.0));
    } else {
      painter.setPen(link->left_out ? QPen(c.muted, 2.0, Qt::DotLine) : qualityPen(link->quality, c));
    }
    painter.drawLine(a, b);
    if (link->quality != LinkQuality::Failed && !link->left_out) continue;
    const QPointF m = (a + b) / 2;
    painter.setPen(QPen(link->left_out ? c.muted : c.error, 2.0));
    painter.drawLine(m + QPointF(-4, -4), m + QPointF(4, 4));
    painter.drawLine(m + QPointF(-4, 4), m + QPointF(4, -4));
  }
}

void SiteMapView::drawStops(QPainter& painter) const {
  const ThemeColours& c = context_.theme.colours();
  const QColor text = palette().color(QPalette::Text);
  for (const MapStop& stop : model_.stops())
    if (stop.ghost_m) {
      const QPointF at = seen_.pixelOf(*stop.ghost_m);
      painter.setPen(QPen(c.accent, 1.5, Qt::DashLine));
      painter.drawLine(seen_.pixelOf(stop.place_m), at);
      painter.setBrush(Qt::NoBrush);
      painter.setPen(QPen(c.accent, 1.5));
      painter.drawEllipse(at, kStop_px, kStop_px);
    }
  for (const MapStop& stop : model_.stops()) {
    const QPointF at = seen_.pixelOf(stop.place_m);
    const QPointF towards(stop.heading.x() * kHeading_px, -stop.heading.y() * kHeading_px);
    QColor fill = context_.workspace.display().colour(stop.scan);
    if (!stop.visible) fill.setAlphaF(0.25);
    if (stop.selected) {
      painter.setPen(Qt::NoPen);
      QColor halo = palette().color(QPalette::Highlight);
      halo.setAlphaF(0.6);
      painter.setBrush(halo);
      painter.drawEllipse(at, kStop_px + 6, kStop_px + 6);
    }
    painter.setPen(QPen(stop.visible ? text : c.muted, 1.5));
    painter.drawLine(at, at + towards);
    if (const double length = std::hypot(towards.x(), towards.y()); length > 4.0) {
      const QPointF along = towards / length, aside(-along.y(), along.x());
      painter.drawLine(at + towards, at + towards - 5 * along + 3 * aside);
      painter.drawLine(at + towards, at + towards - 5 * along - 3 * aside);
    }
    const RelaxationRole role = stop.role != RelaxationRole::None ? stop.role
                                : stop.pinned                     ? RelaxationRole::Held
                                                                  : stop.role;
    drawStop(painter, at, kStop_px, role, fill, c);
  }
  drawNumbers(painter);
}

// Beside each stop where there is room; of numbers that would lie on one another the first stays, and the
// others are told by a tooltip.
void SiteMapView::drawNumbers(QPainter& painter) const {
  const ThemeColours& c = context_.theme.colours();
  const QColor text = palette().color(QPalette::Text), ground = palette().color(QPalette::Base);
  std::vector<QRectF> taken;
  for (const MapStop& stop : model_.stops()) {
    const QPointF at = seen_.pixelOf(stop.place_m);
    taken.emplace_back(at.x() - kStop_px, at.y() - kStop_px, 2 * kStop_px, 2 * kStop_px);
  }
  // Those that were chosen first.
  std::vector<const MapStop*> order;
  for (const MapStop& stop : model_.stops()) order.push_back(&stop);
  std::ranges::stable_sort(order, {}, [](const MapStop* stop) { return !stop->selected; });
  for (const MapStop* stop : order) {
    const QPointF at = seen_.pixelOf(stop->place_m);
    const QString number = QString::number(stop->index);
    const QRectF box = painter.fontMetrics().boundingRect(number);
    const double away = kStop_px + 4, w = box.width(), h = box.height();
    const QPointF corners[] = {{away, -kStop_px - 10},
                               {away, kStop_px - h / 2 + 3},
                               {-away - w, -kStop_px - 10},
                               {-away - w, kStop_px - h / 2 + 3},
                               {-w / 2, away},
                               {-w / 2, -away - h - 12}};
    for (const QPointF& corner : corners) {
      const QRectF place(at + corner, box.size());
      if (std::ranges::any_of(taken, [&](const QRectF& other) { return other.intersects(place); })) continue;
      taken.push_back(place);
      drawLabel(painter, place.topLeft(), number, stop->visible ? text : c.muted, ground);
      break;
    }
  }
}

void SiteMapView::drawPlacing(QPainter& painter) const {
  const ThemeColours& c = context_.theme.colours();
  const auto cross = [&](const QPointF& at) {
    painter.drawLine(at + QPointF(-8, 0), at + QPointF(8, 0));
    painter.drawLine(at + QPointF(0, -8), at + QPointF(0, 8));
  };
  for (std::size_t i = 0; i < placing_->picture_px.size(); ++i) {
    const QPointF px = placing_->picture_px[i];
    const Eigen::Vector2d world = model_.placement()->worldOf({px.x(), px.y()});
    const QPointF from = seen_.pixelOf({world.x(), world.y()});
    const QPointF to = i < placing_->world_m.size() ? seen_.pixelOf(placing_->world_m[i]) : pointer_;
    painter.setPen(QPen(c.accent, 2.0));
    cross(from);
    painter.drawLine(from, to);
    painter.drawEllipse(to, 5, 5);
  }
}

void SiteMapView::drawScale(QPainter& painter) const {
  const double length = roundLength(std::min(120.0, 0.35 * width()) / seen_.px_per_m);
  if (length <= 0.0) return;
  const double px = length * seen_.px_per_m;
  const QColor text = palette().color(QPalette::Text);
  const QPointF left(12.5, height() - 12.5);
  drawLabel(painter, left + QPointF(4, -20), lengthName(length), text, palette().color(QPalette::Base));
  painter.setPen(QPen(text, 2.0));
  painter.drawLine(left, left + QPointF(px, 0));
  painter.drawLine(left + QPointF(0, -4), left + QPointF(0, 4));
  painter.drawLine(left + QPointF(px, -4), left + QPointF(px, 4));
}

// Where the survey knows the frame it was imported from, its y axis is north; else the map's own axis is
// named.
void SiteMapView::drawNorth(QPainter& painter) const {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  if (!snapshot) return;
  QPointF up(0, -1);
  QString name = "y";
  if (const auto& site = snapshot->survey().site_from_world) {
    const Eigen::Vector3d north = site->inverse().rotation() * Eigen::Vector3d::UnitY();
    up = QPointF(north.x(), -north.y());
    name = "N";
  }
  const double length = std::hypot(up.x(), up.y());
  if (length < 1e-6) return;
  up /= length;
  // The letter stands at the arrow's foot, wherever that is, within the view.
  const QFontMetricsF metrics(painter.font());
  const double to_letter = 15.0 + 0.6 * metrics.height();
  const QPointF middle(width() - 24.5, height() - 4.5 - to_letter - 0.5 * metrics.height());
  const QPointF tip = middle + 15 * up, letter = middle - to_letter * up;
  const QPointF aside(-up.y(), up.x());
  const QColor text = palette().color(QPalette::Text);
  painter.setPen(QPen(text, 2.0));
  painter.drawLine(middle - 15 * up, tip);
  painter.setBrush(text);
  painter.drawPolygon(QPolygonF({tip, tip - 7 * up + 4 * aside, tip - 7 * up - 4 * aside}));
  drawLabel(painter, letter - QPointF(metrics.horizontalAdvance(name), metrics.height()) / 2, name, text,
            palette().color(QPalette::Base));
}

void SiteMapView::drawLegend(QPainter& painter) const {
  const ThemeColours& c = context_.theme.colours();
  struct Entry {
    QString text;
    std::optional<LinkQuality> quality;
    RelaxationRole role = RelaxationRole::None;
  };
  std::vector<Entry> entries;
  for (const LinkQuality quality : {LinkQuality::Good, LinkQuality::Doubtful, LinkQuality::Bad,
                                    LinkQuality::NotJudged, LinkQuality::Failed, LinkQuality::Disabled})
    if (std::ranges::any_of(model_.links(),
                            [&](const MapLink& link) { return !link.live && link.quality == quality; }))
      entries.push_back({qt(linkQualityName(quality)) + " link", quality});
  if (context_.workspace.display().hasRoles())
    for (const RelaxationRole role : {RelaxationRole::Aligning, RelaxationRole::Queued,
                                      RelaxationRole::Active, RelaxationRole::Waiting, RelaxationRole::Held})
      entries.push_back({relaxationRoleName(role), {}, role});
  else if (!model_.stops().empty())
    entries.push_back({"never moves", {}, RelaxationRole::Held});
  if (entries.empty()) return;
  const int line = painter.fontMetrics().height() + 3;
  int widest = 0;
  for (const Entry& entry : entries)
    widest = std::max(widest, painter.fontMetrics().horizontalAdvance(entry.text));
  QRectF box(width() - widest - 52.0, 8.0, widest + 44.0, line * static_cast<double>(entries.size()) + 8.0);
  // At the upper left where it would lie over fewer stops there.
  const auto hides = [&](const QRectF& place) {
    return std::ranges::count_if(
        model_.stops(), [&](const MapStop& stop) { return place.contains(seen_.pixelOf(stop.place_m)); });
  };
  if (const QRectF left = box.translated(8.0 - box.left(), 0.0); hides(left) < hides(box)) box = left;
  QColor ground = palette().color(QPalette::Window);
  ground.setAlphaF(0.85);
  painter.setPen(QPen(c.line, 1.0));
  painter.setBrush(ground);
  painter.drawRoundedRect(box, 3, 3);
  double y = box.top() + 4 + line / 2.0;
  for (const Entry& entry : entries) {
    if (entry.quality) {
      painter.setPen(qualityPen(*entry.quality, c));
      painter.drawLine(QPointF(box.left() + 6, y), QPointF(box.left() + 28, y));
    } else {
      painter.save();
      painter.translate(box.left() + 17, y);
      painter.scale(0.55, 0.55);
      drawStop(painter, {}, kStop_px, entry.role, c.muted, c);
      painter.restore();
    }
    painter.setPen(palette().color(QPalette::WindowText));
    painter.drawText(QRectF(box.left() + 36, y - line / 2.0, widest + 4, line), Qt::AlignVCenter, entry.text);
    y += line;
  }
}

}  // namespace tiltmap::ui
