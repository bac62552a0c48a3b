#include "ui/panels/site_map_view.h"

#include <QHelpEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "ui/look/theme.h"
#include "ui/models/edits.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr double kReach_px = 9.0;  // of a click
constexpr double kDrag_px = 4.0;
constexpr double kStep = 1.25;

}  // namespace

SiteMapView::SiteMapView(SiteMapModel& model, const PanelContext& context, QWidget* parent)
    : QWidget(parent), model_(model), context_(context) {
  setObjectName("sitemap-view");
  setAccessibleName("Site map");
  setAccessibleDescription(
      "Stops, headings and links in plan; arrows shift, plus and minus zoom, F shows all, "
      "page up and page down choose the stop before or after");
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setMinimumSize(160, 120);
  connect(&model, &SiteMapModel::changed, this, qOverload<>(&QWidget::update));
  connect(&model, &SiteMapModel::placesChanged, this, [this] {
    stopPlacing();
    fit();
  });
  connect(&context.theme, &Theme::changed, this, qOverload<>(&QWidget::update));
  fit();
}

void SiteMapView::fit() {
  fitted_ = true;
  seen_.size_px = size();
  seen_.fit(model_.bounds());
  update();
}

void SiteMapView::setPictureShown(bool shown) {
  picture_shown_ = shown;
  update();
}
void SiteMapView::setLegendShown(bool shown) {
  legend_shown_ = shown;
  update();
}

void SiteMapView::startPlacing() {
  if (!model_.placement()) return;
  placing_ = Placing();
  setPictureShown(true);
  seen_.fit(model_.bounds(true));
  setCursor(Qt::CrossCursor);
  setFocus();
  Q_EMIT placingChanged();
}

void SiteMapView::stopPlacing() {
  if (!placing_) return;
  placing_.reset();
  unsetCursor();
  update();
  Q_EMIT placingChanged();
}

QString SiteMapView::placingText() const {
  if (!placing_) return {};
  const std::size_t clicks = placing_->picture_px.size() + placing_->world_m.size();
  static const QStringList kTexts = {
      "1 of 4: click a point of the picture that you know, such as where a stop stood.",
      "2 of 4: click where that point belongs on the map; a stop near by catches it.",
      "3 of 4: click another point of the picture, far from the first.",
      "4 of 4: click where that one belongs."};
  return kTexts.value(static_cast<int>(clicks)) + " Esc ends it.";
}

void SiteMapView::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  seen_.size_px = size();
  if (fitted_) fit();
}

void SiteMapView::zoom(const QPointF& at, double factor) {
  fitted_ = false;
  seen_.zoomAt(at, factor);
  update();
}

void SiteMapView::wheelEvent(QWheelEvent* event) {
  zoom(event->position(), std::pow(kStep, event->angleDelta().y() / 120.0));
  event->accept();
}

void SiteMapView::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton && event->button() != Qt::MiddleButton) return;
  pressed_ = event->localPos();
  dragged_.reset();
}

void SiteMapView::mouseMoveEvent(QMouseEvent* event) {
  pointer_ = event->localPos();
  if (placing_) update();
  if (!pressed_) return;
  if (!dragged_ && (pointer_ - *pressed_).manhattanLength() < kDrag_px) return;
  fitted_ = false;
  seen_.panBy(pointer_ - dragged_.value_or(*pressed_));
  dragged_ = pointer_;
  update();
}

void SiteMapView::mouseReleaseEvent(QMouseEvent* event) {
  const bool clicked = pressed_ && !dragged_ && event->button() == Qt::LeftButton;
  pressed_.reset();
  dragged_.reset();
  if (clicked) placing_ ? placeClick(event->localPos()) : click(event->localPos(), event->modifiers());
}

void SiteMapView::mouseDoubleClickEvent(QMouseEvent*) {
  if (!placing_) fit();
}

void SiteMapView::click(const QPointF& at, Qt::KeyboardModifiers keys) {
  Selection& selection = context_.workspace.selection();
  const QPointF world = seen_.worldOf(at);
  const double reach = kReach_px / seen_.px_per_m;
  if (const auto stop = model_.stopAt(world, reach)) {
    std::vector<ScanId> scans = selection.scans();
    if (!(keys & Qt::ControlModifier)) return selection.setCurrentScan(*stop);
    if (selection.isSelected(*stop))
      std::erase(scans, *stop);
    else
      scans.push_back(*stop);
    return selection.setScans(std::move(scans), *stop);
  }
  if (const auto link = model_.linkAt(world, reach)) {
    std::vector<LinkId> links;
    if (keys & Qt::ControlModifier) links = selection.links();
    if (std::erase(links, *link) == 0) links.push_back(*link);
    return selection.setLinks(std::move(links));
  }
  if (!(keys & Qt::ControlModifier)) selection.clear();
}

QPointF SiteMapView::snapped(const QPointF& at) const {
  const QPointF world = seen_.worldOf(at);
  const auto stop = model_.stopAt(world, kReach_px / seen_.px_per_m);
  if (stop)
    for (const MapStop& s : model_.stops())
      if (s.scan == *stop) return s.place_m;
  return world;
}

void SiteMapView::placeClick(const QPointF& at) {
  if (!model_.placement()) return stopPlacing();
  if (placing_->picture_px.size() == placing_->world_m.size()) {
    const QPointF world = seen_.worldOf(at);
    const Eigen::Vector2d pixel = model_.placement()->pictureOf({world.x(), world.y()});
    placing_->picture_px.emplace_back(pixel.x(), pixel.y());
  } else {
    placing_->world_m.push_back(snapped(at));
  }
  if (placing_->world_m.size() < 2) {
    update();
    Q_EMIT placingChanged();
    return;
  }
  SitePicturePoints points;
  for (std::size_t i = 0; i < 2; ++i)
    points[i] = {{placing_->picture_px[i].x(), placing_->picture_px[i].y()},
                 {placing_->world_m[i].x(), placing_->world_m[i].y()}};
  stopPlacing();
  if (const Status placed = model_.placePicture(points); !placed)
    context_.workspace.messages().error(placed.error());
}

void SiteMapView::selectNext(int step) {
  const auto& stops = model_.stops();
  if (stops.empty()) return;
  const auto current = context_.workspace.selection().currentScan();
  const int count = static_cast<int>(stops.size());
  int index = step > 0 ? -1 : count;
  for (const MapStop& stop : stops)
    if (stop.scan == current) index = stop.index;
  index = std::clamp(index + step, 0, count - 1);
  context_.workspace.selection().setCurrentScan(stops[static_cast<std::size_t>(index)].scan);
}

void SiteMapView::keyPressEvent(QKeyEvent* event) {
  const QPointF middle = QRectF(rect()).center();
  const double step = 0.1 * std::min(width(), height());
  const auto pan = [&](double x, double y) {
    fitted_ = false;
    seen_.panBy({x, y});
    update();
  };
  switch (event->key()) {
    case Qt::Key_Left:
      return pan(step, 0);
    case Qt::Key_Right:
      return pan(-step, 0);
    case Qt::Key_Up:
      return pan(0, step);
    case Qt::Key_Down:
      return pan(0, -step);
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return zoom(middle, kStep);
    case Qt::Key_Minus:
      return zoom(middle, 1.0 / kStep);
    case Qt::Key_F:
    case Qt::Key_0:
      return fit();
    case Qt::Key_PageDown:
      return selectNext(1);
    case Qt::Key_PageUp:
      return selectNext(-1);
    case Qt::Key_Escape:
      if (placing_) return stopPlacing();
      break;
    default:
      break;
  }
  QWidget::keyPressEvent(event);
}

bool SiteMapView::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const QPointF world = seen_.worldOf(help->pos());
  const double reach = kReach_px / seen_.px_per_m;
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  QString tip;
  if (const auto scan = model_.stopAt(world, reach); scan && snapshot) {
    const ScanEntry* entry = snapshot->find(*scan);
    tip = QString("Stop %1: %2").arg(*snapshot->indexOf(*scan)).arg(qt(entry->name));
    if (const RelaxationRole role = context_.workspace.display().role(*scan); role != RelaxationRole::None)
      tip += "\n" + relaxationRoleName(role) + ": " + relaxationRoleTip(role);
  } else if (const auto link = model_.linkAt(world, reach); link && snapshot) {
    for (const LinkJudgement& judged :
         context_.workspace.linkOpinions().of(*snapshot, context_.workspace.display().stage()))
      if (judged.link == *link)
        tip = QString("Link %1 is %2")
                  .arg(qt(linkName(*snapshot, *snapshot->findLink(*link))), qt(linkText(judged)));
  }
  if (tip.isEmpty())
    QToolTip::hideText();
  else
    QToolTip::showText(help->globalPos(), tip, this);
  return true;
}

}  // namespace tiltmap::ui
