#include "ui/models/site_map_model.h"

#include <QImageReader>
#include <algorithm>
#include <cmath>

#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr double kClosest_px_per_m = 4000.0;
constexpr double kFurthest_px_per_m = 0.01;
constexpr int kLargestPicture_px = 8192;  // larger ones are shown reduced

QPointF planOf(const Pose& pose) {
  return {pose.translation().x(), pose.translation().y()};
}

double distance(const QPointF& a, const QPointF& b) {
  return std::hypot(a.x() - b.x(), a.y() - b.y());
}

double distanceToLine(const QPointF& p, const QPointF& a, const QPointF& b) {
  const QPointF along = b - a;
  const double square = QPointF::dotProduct(along, along);
  const double t = square > 0.0 ? std::clamp(QPointF::dotProduct(p - a, along) / square, 0.0, 1.0) : 0.0;
  return distance(p, a + t * along);
}

}  // namespace

QPointF MapWindow::pixelOf(const QPointF& world_m) const {
  const QPointF d = (world_m - centre_m) * px_per_m;
  return {size_px.width() / 2 + d.x(), size_px.height() / 2 - d.y()};
}

QPointF MapWindow::worldOf(const QPointF& pixel) const {
  return centre_m + QPointF(pixel.x() - size_px.width() / 2, size_px.height() / 2 - pixel.y()) / px_per_m;
}

void MapWindow::zoomAt(const QPointF& pixel, double factor) {
  const QPointF before = worldOf(pixel);
  px_per_m = std::clamp(px_per_m * factor, kFurthest_px_per_m, kClosest_px_per_m);
  centre_m += before - worldOf(pixel);
}

void MapWindow::panBy(const QPointF& pixels) {
  centre_m += QPointF(-pixels.x(), pixels.y()) / px_per_m;
}

void MapWindow::fit(const QRectF& world_m) {
  constexpr double kMargin_px = 36.0;
  const double width = std::max(size_px.width() - 2 * kMargin_px, 20.0);
  const double height = std::max(size_px.height() - 2 * kMargin_px, 20.0);
  centre_m = world_m.center();
  px_per_m =
      std::clamp(std::min(width / std::max(world_m.width(), 1e-3), height / std::max(world_m.height(), 1e-3)),
                 kFurthest_px_per_m, kClosest_px_per_m);
}

double roundLength(double at_most_m) {
  if (!(at_most_m > 0.0) || !std::isfinite(at_most_m)) return 0.0;
  const double power = std::pow(10.0, std::floor(std::log10(at_most_m)));
  for (const double step : {5.0, 2.0})
    if (step * power <= at_most_m) return step * power;
  return power;
}

SiteMapModel::SiteMapModel(Workspace& workspace, QObject* parent) : QObject(parent), workspace_(workspace) {
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &SiteMapModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &SiteMapModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::placedChanged, this, &SiteMapModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::rolesChanged, this, &SiteMapModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::whatIfChanged, this, &SiteMapModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::visibilityChanged, this, &SiteMapModel::readAgain);
  connect(&workspace.selection(), &Selection::scansChanged, this, &SiteMapModel::readAgain);
  connect(&workspace.selection(), &Selection::linksChanged, this, &SiteMapModel::readAgain);
  readAgain();
}

QString SiteMapModel::stageText() const {
  if (!snapshot_) return {};
  if (workspace_.relaxation().isRunning() && workspace_.display().isProposal()) return "relaxing";
  if (workspace_.relaxation().isProposal())
    return workspace_.relaxation().showsBefore() ? "before (proposal)" : "proposal";
  return qt(stageName(workspace_.display().placedStage()));
}

void SiteMapModel::readAgain() {
  snapshot_ = workspace_.snapshot();
  stops_.clear();
  links_.clear();
  std::vector<ScanId> scans;
  if (snapshot_) {
    const ScanDisplay& display = workspace_.display();
    const Selection& selection = workspace_.selection();
    const SnapshotPtr placed = display.placed();
    const std::vector<Pose> poses = placed->filledPoses(display.placedStage());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      MapStop stop;
      stop.scan = snapshot_->scans()[i].id;
      stop.index = static_cast<int>(i);
      stop.place_m = planOf(poses[i]);
      const Eigen::Vector3d heading = poses[i].heading();
      stop.heading = {heading.x(), heading.y()};
      stop.role = display.role(stop.scan);
      stop.pinned = i == 0 || snapshot_->isPinned(stop.scan);
      stop.visible = display.isVisible(stop.scan);
      stop.selected = selection.isSelected(stop.scan);
      if (const auto ghost = display.ghosts().find(stop.scan); ghost != display.ghosts().end())
        stop.ghost_m = planOf(ghost->second);
      scans.push_back(stop.scan);
      stops_.push_back(stop);
    }
    const auto judged = workspace_.linkOpinions().of(*placed, display.placedStage());
    for (std::size_t k = 0; k < judged.size(); ++k) {
      const Link& link = placed->links()[k];
      const auto fixed = snapshot_->indexOf(link.fixed), moving = snapshot_->indexOf(link.moving);
      if (!fixed || !moving) continue;
      MapLink line;
      line.link = link.id;
      line.from_m = stops_[*fixed].place_m;
      line.to_m = stops_[*moving].place_m;
      line.quality = judged[k].quality;
      line.left_out = std::ranges::find(display.leftOut(), link.id) != display.leftOut().end();
      line.selected = std::ranges::find(selection.links(), link.id) != selection.links().end();
      links_.push_back(line);
    }
    const RelaxationModel& relaxation = workspace_.relaxation();
    if (relaxation.isRunning() && relaxation.scans() == scans)
      for (const RelaxationLink& found : relaxation.links()) {
        if (!found.used) continue;
        MapLink line;
        line.live = true;
        line.from_m = stops_[static_cast<std::size_t>(found.fixed)].place_m;
        line.to_m = stops_[static_cast<std::size_t>(found.moving)].place_m;
        links_.push_back(line);
      }
  }
  readPicture();
  const bool others = scans != known_;
  known_ = std::move(scans);
  if (others) Q_EMIT placesChanged();
  Q_EMIT changed();
}

void SiteMapModel::readPicture() {
  const auto& picture = sitePicture();
  if (!picture) {
    picture_ = {};
    picture_attachment_ = 0;
    placement_.reset();
    picture_trouble_.clear();
    return;
  }
  placement_ = SitePicturePlacement::make(picture->points)
                   .map([](const SitePicturePlacement& p) { return std::optional(p); })
                   .value_or(std::nullopt);
  if (picture->attachment == picture_attachment_ && snapshot_->projectId() == picture_project_) return;
  picture_attachment_ = picture->attachment;
  picture_project_ = snapshot_->projectId();
  picture_ = {};
  picture_trouble_.clear();
  const auto bytes = snapshot_->sitePictureBytes();
  if (!bytes) {
    picture_trouble_ = qt(bytes.error().what);
    return;
  }
  picture_ = QImage::fromData(bytes->data(), static_cast<int>(bytes->size()));
  if (picture_.isNull())
    picture_trouble_ = "This kind of picture cannot be shown here: " + qt(picture->media_type);
}

const std::optional<SitePicture>& SiteMapModel::sitePicture() const {
  static const std::optional<SitePicture> kNone;
  return snapshot_ ? snapshot_->sitePicture() : kNone;
}

QRectF SiteMapModel::bounds(bool with_picture) const {
  std::vector<QPointF> points;
  for (const MapStop& stop : stops_) {
    points.push_back(stop.place_m);
    if (stop.ghost_m) points.push_back(*stop.ghost_m);
  }
  if (with_picture && placement_ && !picture_.isNull())
    for (const double x : {0.0, static_cast<double>(picture_.width())})
      for (const double y : {0.0, static_cast<double>(picture_.height())}) {
        const Eigen::Vector2d world = placement_->worldOf({x, y});
        points.emplace_back(world.x(), world.y());
      }
  if (points.empty()) return {-5.0, -5.0, 10.0, 10.0};
  double left = points[0].x(), right = left, low = points[0].y(), high = low;
  for (const QPointF& p : points) {
    left = std::min(left, p.x());
    right = std::max(right, p.x());
    low = std::min(low, p.y());
    high = std::max(high, p.y());
  }
  const double more_x = std::max(0.0, 1.0 - (right - left)) / 2,
               more_y = std::max(0.0, 1.0 - (high - low)) / 2;
  return {QPointF(left - more_x, low - more_y), QPointF(right + more_x, high + more_y)};
}

std::optional<ScanId> SiteMapModel::stopAt(const QPointF& world_m, double within_m) const {
  std::optional<ScanId> nearest;
  double best = within_m;
  for (const MapStop& stop : stops_)
    if (const double d = distance(stop.place_m, world_m); d <= best) {
      best = d;
      nearest = stop.scan;
    }
  return nearest;
}

std::optional<LinkId> SiteMapModel::linkAt(const QPointF& world_m, double within_m) const {
  std::optional<LinkId> nearest;
  double best = within_m;
  for (const MapLink& link : links_) {
    if (link.live) continue;
    if (const double d = distanceToLine(world_m, link.from_m, link.to_m); d <= best) {
      best = d;
      nearest = link.link;
    }
  }
  return nearest;
}

Status SiteMapModel::addPicture(const QString& file) {
  QImageReader reader(file);
  const QSize size = reader.size();
  if (!reader.canRead() || !size.isValid())
    return fail("this picture cannot be shown: " + utf8(reader.errorString()), utf8(file),
                "give a PNG, JPEG or BMP file");
  if (std::max(size.width(), size.height()) > 4 * kLargestPicture_px)
    return fail("the picture is too large to be shown", utf8(file),
                "give one of at most 32,768 pixels a side");
  // Over the stops, a little larger, upright; the upper corners carry the place.
  QRectF over = bounds();
  const double metres_per_px = 1.2 * std::max(over.width() / size.width(), over.height() / size.height());
  const double width = metres_per_px * size.width(), height = metres_per_px * size.height();
  const QPointF centre = over.center();
  const double left = centre.x() - width / 2, top = centre.y() + height / 2;
  SitePicturePoints points;
  points[0] = {{0.0, 0.0}, {left, top}};
  points[1] = {{static_cast<double>(size.width()), 0.0}, {left + width, top}};
  const auto edit = sitePictureEdit(pathOf(file), points);
  if (!edit) return fail(edit.error());
  return workspace_.session().apply(*edit);
}

Status SiteMapModel::placePicture(const SitePicturePoints& points) {
  if (!snapshot_) return fail("no project is open", "", "open one first");
  const auto edit = placeSitePictureEdit(*snapshot_, points);
  if (!edit) return fail(edit.error());
  return workspace_.session().apply(*edit);
}

Status SiteMapModel::removePicture() {
  if (!snapshot_) return fail("no project is open", "", "open one first");
  const auto edit = removeSitePictureEdit(*snapshot_);
  if (!edit) return fail(edit.error());
  return workspace_.session().apply(*edit);
}

}  // namespace tiltmap::ui
