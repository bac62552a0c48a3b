#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Rgb kHoverColour{255, 170, 40};
constexpr Rgb kPickColour{255, 90, 200};

}  // namespace

Scene::Scene() : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.front->SetLayer(1);
  p.front->InteractiveOff();
  p.front->SetActiveCamera(p.renderer->GetActiveCamera());
  p.overlay = std::make_unique<SceneOverlay>(*p.front);
  for (SceneLines* lines : {&p.grid, &p.path}) p.renderer->AddActor(lines->actor);
  for (SceneLines* lines : {&p.hovered, &p.picked}) p.front->AddActor(lines->actor);
  setColours(SceneColours::dark());
  setView(SceneView::Iso);
}

Scene::~Scene() {
  detach();
}

void Scene::attach(vtkRenderWindow& window) {
  detach();
  parts_->window = &window;
  window.SetMultiSamples(0);
  window.SetNumberOfLayers(2);
  window.AddRenderer(parts_->renderer);
  window.AddRenderer(parts_->front);
}

void Scene::detach() {
  if (!parts_->window) return;
  parts_->window->RemoveRenderer(parts_->renderer);
  parts_->window->RemoveRenderer(parts_->front);
  parts_->window = nullptr;
}

vtkRenderer& Scene::renderer() {
  return *parts_->renderer;
}

std::vector<std::string> Scene::show(const SnapshotPtr& snapshot, Stage stage) {
  Parts& p = *parts_;
  std::map<ScanId, std::unique_ptr<SceneCloud>> before;
  for (auto& cloud : p.clouds) {
    const ScanId id = cloud->points.scan;
    before[id] = std::move(cloud);
  }
  p.clouds.clear();
  p.snapshot = snapshot;
  p.stage = stage;
  std::vector<std::string> troubles;
  const std::size_t count = snapshot ? snapshot->scans().size() : 0;
  p.stops = snapshot ? snapshot->filledPoses(stage) : std::vector<Pose>();
  std::vector<std::unique_ptr<SceneCloud>> made(count);
  std::vector<std::string> trouble(count);
  parallelFor(count, 0, [&](std::size_t i) {
    const ScanEntry& scan = snapshot->scans()[i];
    const auto known = before.find(scan.id);
    if (known != before.end() && known->second->points.matrix == scan.matrix &&
        known->second->points.geometry == scan.geometry_id &&
        known->second->points.reduced == p.settings.reduced)
      return;
    auto points = scanPointsOf(scan, p.settings.reduced);
    if (!points) {
      trouble[i] = scan.name + ": " + points.error().what;
      return;
    }
    made[i] = std::make_unique<SceneCloud>();
    made[i]->points = std::move(*points);
  });
  for (std::size_t i = 0; i < count; ++i) {
    if (!trouble[i].empty()) {
      troubles.push_back(trouble[i]);
      continue;
    }
    const ScanEntry& scan = snapshot->scans()[i];
    if (!made[i]) {
      made[i] = std::move(before[scan.id]);
    } else {
      made[i]->all.setPoints(made[i]->points.xyz, true);
      p.renderer->AddActor(made[i]->all.actor);
      p.renderer->AddActor(made[i]->few.actor);
    }
    SceneCloud& cloud = *made[i];
    cloud.index = i;
    cloud.world_from_scan = p.stops[i];
    cloud.visible = !p.is_visible || p.is_visible(scan.id);
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = p.stops[i].matrix();
    vtkNew<vtkMatrix4x4> placed;
    placed->DeepCopy(matrix.data());
    for (PointDrawing* drawing : {&cloud.all, &cloud.few}) drawing->actor->SetUserMatrix(placed);
    p.clouds.push_back(std::move(made[i]));
  }
  for (auto& [id, cloud] : before)
    if (cloud) {
      p.renderer->RemoveActor(cloud->all.actor);
      p.renderer->RemoveActor(cloud->few.actor);
    }
  p.colourAll();
  p.placeLines();
  p.showActors();
  p.fitNow();
  markHovered(p.hovered_cell);
  markPicked(p.picked_cell);
  return troubles;
}

std::vector<std::string> Scene::setSettings(const SceneSettings& settings) {
  Parts& p = *parts_;
  const SceneSettings before = std::exchange(p.settings, settings);
  if (before.reduced != settings.reduced) return show(p.snapshot, p.stage);
  if (before.colouring != settings.colouring) p.colourAll();
  p.placeLines();
  p.showActors();
  return {};
}

const SceneSettings& Scene::settings() const {
  return parts_->settings;
}

void Scene::setColours(const SceneColours& colours) {
  Parts& p = *parts_;
  p.colours = colours;
  p.renderer->GradientBackgroundOn();
  p.renderer->SetBackground2(colours.top.r / 255.0, colours.top.g / 255.0, colours.top.b / 255.0);
  p.renderer->SetBackground(colours.bottom.r / 255.0, colours.bottom.g / 255.0, colours.bottom.b / 255.0);
  p.colourAll();
  p.placeLines();
}

void Scene::setVisible(const std::function<bool(ScanId)>& visible) {
  Parts& p = *parts_;
  p.is_visible = visible;
  for (const auto& cloud : p.clouds) cloud->visible = !visible || visible(cloud->points.scan);
  p.few_stale = true;
  if (p.settings.colouring != SceneColouring::Scan) p.colourAll();
  p.showActors();
}

void Scene::setPixelRatio(double ratio) {
  if (ratio == parts_->pixel_ratio) return;
  parts_->pixel_ratio = ratio;
  parts_->placeLines();
  parts_->showActors();
  markHovered(parts_->hovered_cell);
  markPicked(parts_->picked_cell);
}

void Scene::setMoving(bool moving) {
  parts_->moving = moving;
  if (moving) parts_->fillFew();
  parts_->showActors();
}

std::size_t Scene::pointsDrawn() const {
  std::size_t count = 0;
  for (const auto& cloud : parts_->clouds)
    if (cloud->visible)
      count += static_cast<std::size_t>((parts_->moving ? cloud->few : cloud->all).data->GetNumberOfPoints());
  return count;
}

void Scene::markHovered(const std::optional<CellPlace>& cell) {
  parts_->hovered_cell = cell;
  parts_->mark(parts_->hovered, cell, kHoverColour);
}

void Scene::markPicked(const std::optional<CellPlace>& cell) {
  parts_->picked_cell = cell;
  parts_->mark(parts_->picked, cell, kPickColour);
}

void Scene::prepare() {
  Parts& p = *parts_;
  if (p.fitted && p.size() != p.fitted_size) p.fitNow();
  p.applyCamera();
  p.renderer->ResetCameraClippingRange();
  OverlayContents contents;
  contents.text = p.colours.text;
  contents.ground = p.colours.bottom;
  contents.pixel_ratio = p.pixel_ratio;
  contents.width = p.size().x();
  contents.height = p.size().y();
  contents.axes = p.settings.axes;
  contents.right = p.camera.right();
  contents.up = p.camera.trueUp();
  if (p.camera.orthographic && !p.clouds.empty()) contents.scale_m_per_px = metresPerPixel();
  if (p.settings.grid && p.grid_m > 0.0) contents.grid = "Grid " + shortestReal(p.grid_m) + " m";
  const bool bar =
      p.settings.colouring != SceneColouring::Scan && p.settings.colouring != SceneColouring::Normal;
  if (bar && p.range.known) {
    contents.bar_title = sceneColouringTitle(p.settings.colouring);
    const int places = p.range.high - p.range.low < 20.0 ? 1 : 0;
    contents.bar_low = fixedReal(p.range.low, places);
    contents.bar_high = fixedReal(p.range.high, places);
    contents.low_lightness = p.lowLightness();
    contents.high_lightness = p.highLightness();
  }
  p.overlay->show(contents);
  p.thinNumbers(*this);
}

void Scene::render() {
  if (!parts_->window) return;
  prepare();
  parts_->window->Render();
}

}  // namespace tiltmap::ui
