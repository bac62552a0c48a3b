// The scene's camera, and which beam is under a pixel.
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

ViewDirection directionOf(SceneView view) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  switch (view) {
    case SceneView::Top:
      return {-z, y};
    case SceneView::Bottom:
      return {z, y};
    case SceneView::Front:
      return {y, z};
    case SceneView::Back:
      return {-y, z};
    case SceneView::Left:
      return {x, z};
    case SceneView::Right:
      return {-x, z};
    case SceneView::Iso:
      return {Vector3d(0.62, 0.62, -0.55), z};
    case SceneView::IsoBack:
      return {Vector3d(-0.62, -0.62, -0.55), z};
  }
  return {y, z};
}

}  // namespace

Result<SceneView> parseSceneView(const std::string& name) {
  if (name == "top") return SceneView::Top;
  if (name == "front") return SceneView::Front;
  if (name == "side") return SceneView::Right;
  if (name == "iso") return SceneView::Iso;
  return fail("there is no view called \"" + printable(name) + "\"", "--view",
              "there are top, front, side and iso");
}

void Scene::setView(SceneView view) {
  parts_->fitted = directionOf(view);
  parts_->fitted_scans.clear();
  parts_->fitNow();
}

void Scene::frame(const std::vector<ScanId>& scans) {
  parts_->fitted = ViewDirection{parts_->camera.forward(), parts_->camera.up};
  parts_->fitted_scans = scans;
  parts_->fitNow();
}

void Scene::setOrthographic(bool orthographic) {
  parts_->camera.orthographic = orthographic;
  parts_->fitNow();
}

bool Scene::isOrthographic() const {
  return parts_->camera.orthographic;
}

void Scene::setPivot(const Vector2d& pixel) {
  const auto cell = pick(pixel, 12.0 * parts_->pixel_ratio);
  const auto point = cell ? shownPoint(*cell, pixel) : std::nullopt;
  if (point) {
    parts_->pivot = *point;
    return;
  }
  // In the plane through the focus, below the pointer.
  const SceneCamera& camera = parts_->camera;
  const Vector2d middle = 0.5 * parts_->size().cast<double>();
  const Vector2d by = (pixel - middle) * metresPerPixel();
  parts_->pivot = camera.focus + by.x() * camera.right() + by.y() * camera.trueUp();
}

void Scene::turn(const Vector2d& by_px) {
  parts_->fitted.reset();
  const double per_px = 0.008 / parts_->pixel_ratio;
  parts_->camera.turn(parts_->pivot, -by_px.x() * per_px, by_px.y() * per_px);
}

void Scene::pan(const Vector2d& by_px) {
  parts_->fitted.reset();
  const SceneCamera& camera = parts_->camera;
  const double depth = camera.forward().dot(parts_->pivot - camera.position);
  const double nearer = camera.orthographic ? 1.0 : std::max(depth, 0.01) / camera.distance();
  const Vector2d by = by_px * metresPerPixel() * nearer;
  parts_->camera.shift(-by.x(), -by.y());
}

void Scene::zoom(double factor) {
  parts_->fitted.reset();
  parts_->camera.zoom(parts_->pivot, factor);
}

Vector2d Scene::pixelOf(const Vector3d& world) const {
  parts_->applyCamera();
  const Eigen::Vector4d clip = parts_->clipFromWorld() * world.homogeneous();
  const Vector2d size = parts_->size().cast<double>();
  return (0.5 * (clip.head<2>() / clip.w()).array() + 0.5).matrix().cwiseProduct(size);
}

double Scene::metresPerPixel() const {
  return 2.0 * parts_->camera.halfHeight() / std::max(1, parts_->size().y());
}

std::optional<CellPlace> Scene::pick(const Vector2d& pixel, double radius_px) const {
  parts_->applyCamera();
  const Eigen::Matrix4d clip_from_world = parts_->clipFromWorld();
  const Vector2d half = 0.5 * parts_->size().cast<double>();
  if (half.minCoeff() <= 0.0) return {};
  // Metres in front of the camera.
  const SceneCamera& camera = parts_->camera;
  Eigen::RowVector4d depth_row;
  depth_row << camera.forward().transpose(), -camera.forward().dot(camera.position);
  const int side = parts_->sideAt(pixel.x());
  struct Candidate {
    const SceneCloud* cloud;
    std::size_t point;
    double depth, away;
  };
  std::vector<Candidate> candidates;
  for (const auto& cloud : parts_->clouds) {
    if (!cloud->batch.visible) continue;
    const Pose& world_from_scan = cloud->pose(side);
    const Eigen::Matrix4d clip_from_scan = clip_from_world * world_from_scan.matrix();
    const Eigen::RowVector4d depth_from_scan = depth_row * world_from_scan.matrix();
    const std::vector<float>& xyz = cloud->points.xyz;
    for (std::size_t i = 0; i < cloud->points.size(); ++i) {
      const Eigen::Vector4d p(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2], 1.0);
      const double w = clip_from_scan.row(3) * p;
      if (!(w > 1e-9)) continue;
      const double x = (clip_from_scan.row(0) * p / w).value() * half.x() + half.x() - pixel.x();
      if (std::abs(x) > radius_px) continue;
      const double y = (clip_from_scan.row(1) * p / w).value() * half.y() + half.y() - pixel.y();
      const double away = std::hypot(x, y);
      if (away > radius_px || (parts_->slice && !parts_->slice->contains(cloud->at(i, side)))) continue;
      candidates.push_back({cloud.get(), i, depth_from_scan * p, away});
    }
  }
  if (candidates.empty()) return {};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Candidate& c : candidates) nearest = std::min(nearest, c.depth);
  // The surface in front may be slanted: as deep as the circle is wide, the pointer decides.
  const double shrink = camera.orthographic ? 1.0 : std::max(nearest, 0.0) / camera.distance();
  const double layer = nearest + 0.05 + 2.0 * radius_px * metresPerPixel() * shrink;
  const Candidate* best = nullptr;
  for (const Candidate& c : candidates)
    if (c.depth <= layer && (!best || c.away < best->away)) best = &c;
  const std::uint32_t cell = best->cloud->points.cell[best->point];
  const int columns = std::max(1, best->cloud->points.columns);
  return CellPlace{best->cloud->points.scan, static_cast<int>(cell) / columns,
                   static_cast<int>(cell) % columns};
}

std::optional<Vector3d> Scene::Parts::pointOf(const CellPlace& cell, int side) const {
  const SceneCloud* cloud = cloudOf(cell.scan);
  if (!cloud) return {};
  const auto wanted = static_cast<std::uint32_t>(cell.row * cloud->points.columns + cell.column);
  const auto& cells = cloud->points.cell;  // in no order
  const auto found = std::find(cells.begin(), cells.end(), wanted);
  if (found == cells.end()) return {};
  return cloud->at(static_cast<std::size_t>(found - cells.begin()), side);
}

std::optional<Vector3d> Scene::worldPoint(const CellPlace& cell) const {
  return parts_->pointOf(cell, 0);
}

std::optional<Vector3d> Scene::shownPoint(const CellPlace& cell, const Vector2d& pixel) const {
  return parts_->pointOf(cell, parts_->sideAt(pixel.x()));
}

}  // namespace tiltmap::ui
