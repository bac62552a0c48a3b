#include <vtkCallbackCommand.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtk_glew.h>

#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

// Making a context current may change its viewport (Qt's platform without a screen sets one pixel), and VTK
// makes it current in the middle of drawing without noticing that. What it believes is put back.
void keepViewport(vtkObject* caller, unsigned long, void*, void*) {
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(caller);
  if (!window) return;
  int viewport[4];
  window->GetState()->vtkglGetIntegerv(GL_VIEWPORT, viewport);
  glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
}

}  // namespace

Scene::Scene() : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.front->SetLayer(1);
  p.front->InteractiveOff();
  p.front->SetActiveCamera(p.renderer->GetActiveCamera());
  p.overlay = std::make_unique<SceneOverlay>(*p.front);
  p.renderer->GetCullers()->RemoveAllItems();  // these would ask the points for bounds, and gain nothing
  p.renderer->AddActor(p.grid.actor);
  p.renderer->AddViewProp(p.layer);
  p.layer->setSideActors({p.paths[0].actor, p.paths[1].actor});
  p.layer->setBudget(p.budget);
  for (SceneLines* lines : {&p.hovered, &p.picked, &p.box, &p.measure}) p.front->AddActor(lines->actor);
  setColours(SceneColours::dark());
  setView(SceneView::Iso);
}

Scene::~Scene() {
  detach();
  parts_->layer->setSideActors({});  // these go before the renderer does
  parts_->renderer->RemoveAllViewProps();
}

void Scene::attach(vtkRenderWindow& window) {
  detach();
  parts_->window = &window;
  vtkNew<vtkCallbackCommand> on_current;
  on_current->SetCallback(keepViewport);
  parts_->on_current = window.AddObserver(vtkCommand::WindowMakeCurrentEvent, on_current, -1.0F);
  window.SetMultiSamples(0);
  window.SetNumberOfLayers(2);
  window.AddRenderer(parts_->renderer);
  window.AddRenderer(parts_->front);
}

void Scene::detach() {
  if (!parts_->window) return;
  parts_->window->RemoveRenderer(parts_->renderer);
  parts_->window->RemoveRenderer(parts_->front);
  parts_->window->RemoveObserver(parts_->on_current);
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
  for (std::size_t i = 0; snapshot && i < snapshot->scans().size(); ++i) {
    const auto known = before.find(snapshot->scans()[i].id);
    if (known == before.end()) continue;
    known->second->index = i;
    p.clouds.push_back(std::move(known->second));
  }
  std::vector<std::string> troubles;
  if (snapshot && p.reads_itself) troubles = p.readMissing();
  p.showClouds();
  return troubles;
}

void Scene::setReadsItself(bool itself) {
  parts_->reads_itself = itself;
}

std::vector<PointsWanted> Scene::missing() const {
  const Parts& p = *parts_;
  std::vector<PointsWanted> wanted;
  for (std::size_t i = 0; p.snapshot && i < p.snapshot->scans().size(); ++i)
    if (!p.has(i)) wanted.push_back(p.wanted(i));
  return wanted;
}

void Scene::give(std::vector<ScanPoints> points) {
  parts_->takeIn(std::move(points));
  parts_->showClouds();
}

std::vector<std::string> Scene::setSettings(const SceneSettings& settings) {
  Parts& p = *parts_;
  const SceneSettings before = std::exchange(p.settings, settings);
  if (before.reduced != settings.reduced) return show(p.snapshot, p.stage);
  if (before.colouring != settings.colouring) p.colourAll();
  if (before.path != settings.path || before.grid != settings.grid) p.placeLines();
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
  p.placeBox();
  setMeasured(std::vector<Vector3d>(p.measured));
}

void Scene::setVisible(const std::function<bool(ScanId)>& visible) {
  Parts& p = *parts_;
  p.is_visible = visible;
  for (const auto& cloud : p.clouds) cloud->batch.visible = !visible || visible(cloud->points.scan);
  ++p.content;
  if (p.settings.colouring != SceneColouring::Scan) p.colourAll();
  p.showActors();
}

void Scene::setResiduals(const ScanResiduals& now, const ScanResiduals& before) {
  parts_->residuals = {now, before};
  if (parts_->settings.colouring == SceneColouring::Residual) parts_->colourAll();
}

void Scene::setExtent(std::vector<Vector3d> corners) {
  parts_->extra_extent = std::move(corners);
  parts_->placeLines();
  parts_->fitNow();
}

void Scene::setPixelRatio(double ratio) {
  if (ratio == parts_->pixel_ratio) return;
  parts_->pixel_ratio = ratio;
  parts_->placeLines();
  parts_->placeBox();
  parts_->showActors();
  markHovered(parts_->hovered_cell);
  markPicked(parts_->picked_cell);
  setMeasured(std::vector<Vector3d>(parts_->measured));
}

double Scene::pixelRatio() const {
  return parts_->pixel_ratio;
}

void Scene::setMoving(bool moving) {
  parts_->moving = moving;
  parts_->layer->setMoving(moving);
}

bool Scene::isMoving() const {
  return parts_->moving;
}

void Scene::setMovingPoints(std::size_t points) {
  parts_->budget = std::max(points, kMovingPoints);
  parts_->layer->setBudget(parts_->budget);
}

void Scene::setGradual(bool gradual) {
  parts_->layer->setGradual(gradual);
}

bool Scene::isRefined() const {
  return parts_->clouds.empty() || parts_->layer->isComplete();
}

std::size_t Scene::pointsDrawn() const {
  const Parts& p = *parts_;
  std::size_t count = 0;
  if (p.moving) {
    parts_->lookAtPoints();
    for (const std::size_t n : p.layer->fewOf(p.sideAt(p.size().x()))) count += n;
    return count;
  }
  for (const auto& cloud : p.clouds)
    if (cloud->batch.visible) count += cloud->points.size();
  return count;
}

std::vector<Vector3d> Scene::movingPoints() const {
  const Parts& p = *parts_;
  parts_->lookAtPoints();
  const int side = p.sideAt(p.size().x());
  const std::vector<std::size_t> counts = p.layer->fewOf(side);
  std::vector<Vector3d> points;
  for (std::size_t k = 0; k < counts.size(); ++k)
    for (std::size_t i = 0; i < counts[k]; ++i) {
      const Vector3d point = p.clouds[k]->at(i, side);
      if (!p.slice || p.slice->contains(point)) points.push_back(point);
    }
  return points;
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
  p.lookAtPoints();
  OverlayContents contents;
  contents.text = p.colours.text;
  contents.ground = p.colours.bottom;
  contents.pixel_ratio = p.pixel_ratio;
  contents.width = p.size().x();
  contents.height = p.size().y();
  contents.axes = p.settings.axes;
  contents.right = p.camera.right();
  contents.up = p.camera.trueUp();
  if (p.camera.orthographic && !(p.clouds.empty() && p.extra_extent.empty()))
    contents.scale_m_per_px = metresPerPixel();
  if (p.settings.grid && p.grid_m > 0.0) contents.grid = "Grid " + shortestReal(p.grid_m) + " m";
  p.writeOver(contents, *this);
  p.overlay->show(contents);
  p.thinNumbers(*this);
}

void Scene::render() {
  if (!parts_->window) return;
  prepare();
  parts_->window->Render();
}

}  // namespace tiltmap::ui
