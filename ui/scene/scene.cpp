#include "ui/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vtkActor.h>
#include <vtkBillboardTextActor3D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <Eigen/Geometry>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "core/products/scan_colours.h"
#include "core/products/top_view_marks.h"
#include "ui/scene/scene_camera.h"
#include "ui/scene/scene_overlay.h"
#include "ui/scene/scene_shapes.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Rgb kHoverColour{255, 170, 40};
constexpr Rgb kPickColour{255, 90, 200};

void paint(vtkActor& actor, Rgb colour) {
  actor.GetProperty()->SetColor(colour.r / 255.0, colour.g / 255.0, colour.b / 255.0);
}

// One drawing of some points: all of them, or the few while moving.
struct Drawing {
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;

  Drawing() {
    mapper->SetInputData(data);
    mapper->SetColorModeToDirectScalars();
    mapper->StaticOn();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->PickableOff();
  }
  // Three floats a point. `owner_stays`: the memory outlives this drawing and is not copied.
  void setPoints(const std::vector<float>& xyz, bool owner_stays) {
    vtkNew<vtkFloatArray> array;
    array->SetNumberOfComponents(3);
    const auto count = static_cast<vtkIdType>(xyz.size());
    if (owner_stays) {
      array->SetArray(const_cast<float*>(xyz.data()), count, 1);
    } else {
      array->SetNumberOfTuples(count / 3);
      std::copy(xyz.begin(), xyz.end(), array->GetPointer(0));
    }
    vtkNew<vtkPoints> points;
    points->SetData(array);
    vtkNew<vtkCellArray> cells;
    if (count > 0) {
      cells->InsertNextCell(static_cast<int>(count / 3));
      for (vtkIdType i = 0; i < count / 3; ++i) cells->InsertCellPoint(i);
    }
    data->Initialize();
    data->SetPoints(points);
    data->SetVerts(cells);
    mapper->Modified();
  }
  void setColours(const std::vector<Rgb>& colours) {
    mapper->SetScalarVisibility(!colours.empty());
    if (colours.empty()) {
      data->GetPointData()->SetScalars(nullptr);
    } else {
      vtkNew<vtkUnsignedCharArray> array;
      array->SetNumberOfComponents(3);
      array->SetNumberOfTuples(static_cast<vtkIdType>(colours.size()));
      for (std::size_t i = 0; i < colours.size(); ++i) {
        const unsigned char rgb[3] = {colours[i].r, colours[i].g, colours[i].b};
        array->SetTypedTuple(static_cast<vtkIdType>(i), rgb);
      }
      data->GetPointData()->SetScalars(array);
    }
    data->Modified();
    mapper->Modified();
  }
};

struct Cloud {
  ScanPoints points;
  Pose world_from_scan;
  std::size_t index = 0;
  bool visible = true;
  std::vector<Rgb> colours;  // empty: the scan's
  Drawing all;
  Drawing few;

  Vector3d at(std::size_t i) const {
    return world_from_scan * Vector3d(points.xyz[3 * i], points.xyz[3 * i + 1], points.xyz[3 * i + 2]);
  }
};

struct Lines {
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;
  Lines() {
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->PickableOff();
    actor->VisibilityOff();
  }
  void set(const vtkSmartPointer<vtkPolyData>& data, Rgb colour, double width_px) {
    mapper->SetInputData(data);
    actor->GetProperty()->SetLineWidth(static_cast<float>(width_px));
    paint(*actor, colour);
    actor->VisibilityOn();
  }
};

struct Direction {
  Vector3d forward, up;
};

Direction directionOf(SceneView view) {
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

struct Scene::Parts {
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkRenderer> front;  // marks, numbers, triad: over everything
  std::unique_ptr<SceneOverlay> overlay;
  vtkRenderWindow* window = nullptr;

  SnapshotPtr snapshot;
  Stage stage = Stage::Odometry;
  SceneSettings settings;
  SceneColours colours;
  double pixel_ratio = 1.0;
  bool moving = false;
  bool few_stale = true;
  std::function<bool(ScanId)> is_visible;
  std::vector<std::unique_ptr<Cloud>> clouds;  // in the survey's order; none for scans that cannot be read
  std::vector<Pose> stops;
  ColourRange range;
  double grid_m = 0.0;

  Lines path, grid, hovered, picked;
  std::optional<CellPlace> hovered_cell, picked_cell;
  std::vector<vtkSmartPointer<vtkBillboardTextActor3D>> numbers;

  SceneCamera camera;
  Vector3d pivot = Vector3d::Zero();
  std::optional<Direction> fitted;  // the camera follows the window's shape until it is moved by hand
  std::vector<ScanId> fitted_scans;
  Eigen::Vector2i fitted_size = Eigen::Vector2i::Zero();

  Eigen::Vector2i size() const {
    if (!window) return Eigen::Vector2i::Zero();
    const int* pixels = window->GetSize();
    return {pixels[0], pixels[1]};
  }
  double aspect() const {
    const Eigen::Vector2i pixels = size();
    return pixels.minCoeff() > 0 ? static_cast<double>(pixels.x()) / pixels.y() : 1.5;
  }
  bool lightGround() const { return colours.top.r + colours.top.g + colours.top.b > 384; }
  double lowLightness() const { return lightGround() ? 0.28 : 0.38; }
  double highLightness() const { return lightGround() ? 0.80 : 0.92; }
  Rgb inkOfScan(std::size_t index) const {
    const Rgb colour = scanColour(index);
    return lightGround() ? mixed(colour, {0, 0, 0}, 0.25) : colour;
  }

  Cloud* cloudOf(ScanId scan) const {
    for (const auto& cloud : clouds)
      if (cloud->points.scan == scan) return cloud.get();
    return nullptr;
  }
  std::vector<Vector3d> extentPoints(const std::vector<ScanId>& scans) const;
  void colourAll();
  void colour(Cloud& cloud, const std::vector<float>& values);
  void placeLines();
  void placeNumbers(double length_m);
  void thinNumbers(const Scene& scene);
  void showActors();
  void fillFew();
  void applyCamera();
  void fitNow();
  void mark(Lines& lines, const std::optional<CellPlace>& cell, Rgb colour);
  Eigen::Matrix4d clipFromWorld() const;
};

// The eight corners of a box around most points, and the stops.
std::vector<Vector3d> Scene::Parts::extentPoints(const std::vector<ScanId>& scans) const {
  std::array<std::vector<double>, 3> along;
  for (const auto& cloud : clouds) {
    if (scans.empty() ? !cloud->visible
                      : std::find(scans.begin(), scans.end(), cloud->points.scan) == scans.end())
      continue;
    for (const std::uint32_t i : evenlyStrided(cloud->points.size(), 2000)) {
      const Vector3d p = cloud->at(i);
      for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(p[static_cast<int>(axis)]);
    }
    const Vector3d stop = cloud->world_from_scan.translation();
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(stop[static_cast<int>(axis)]);
  }
  if (along[0].empty()) return {};
  Vector3d low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& values = along[axis];
    std::sort(values.begin(), values.end());
    // What one beam in fifty hit far away must not make everything else small.
    const std::size_t cut = values.size() / 50;
    low[static_cast<int>(axis)] = values[cut];
    high[static_cast<int>(axis)] = values[values.size() - 1 - cut];
  }
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.emplace_back((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
  return corners;
}

void Scene::Parts::colour(Cloud& cloud, const std::vector<float>& values) {
  cloud.colours.clear();
  if (settings.colouring == SceneColouring::Normal) {
    const Eigen::Matrix3d rotation = cloud.world_from_scan.rotation();
    cloud.colours.reserve(cloud.points.size());
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vector3d n = rotation * Vector3d(cloud.points.normal[3 * i], cloud.points.normal[3 * i + 1],
                                             cloud.points.normal[3 * i + 2]);
      const Vector3d c = 127.5 * (n.array() + 1.0);
      cloud.colours.push_back(n.isZero() ? colours.no_data
                                         : Rgb{static_cast<std::uint8_t>(std::lround(c.x())),
                                               static_cast<std::uint8_t>(std::lround(c.y())),
                                               static_cast<std::uint8_t>(std::lround(c.z()))});
    }
  } else if (settings.colouring != SceneColouring::Scan) {
    // A table: a colour through OKLab a point would take a second for a large project.
    std::array<Rgb, 256> table;
    for (std::size_t k = 0; k < table.size(); ++k)
      table[k] = evenColour(static_cast<double>(k) / 255.0, lowLightness(), highLightness());
    const double per_value = 255.0 / (range.high - range.low);
    cloud.colours.assign(cloud.points.size(), colours.no_data);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i]))
        cloud.colours[i] =
            table[static_cast<std::size_t>(std::clamp((values[i] - range.low) * per_value, 0.0, 255.0))];
  }
  cloud.all.setColours(cloud.colours);
  for (Drawing* drawing : {&cloud.all, &cloud.few}) paint(*drawing->actor, inkOfScan(cloud.index));
}

void Scene::Parts::colourAll() {
  std::optional<double> first_time;
  for (const auto& cloud : clouds) {
    if (cloud->points.line_time_s.empty()) {
      first_time.reset();
      break;
    }
    for (const double t : cloud->points.line_time_s)
      if (std::isfinite(t)) first_time = std::min(first_time.value_or(t), t);
  }
  std::vector<std::vector<float>> values(clouds.size());
  std::vector<float> sample;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    Cloud& cloud = *clouds[k];
    if (settings.colouring == SceneColouring::Normal)
      addNormals(cloud.points, snapshot->scans()[cloud.index]);
    values[k] =
        colourValues(cloud.points, settings.colouring, cloud.world_from_scan, cloud.index, first_time);
    if (!cloud.visible) continue;
    for (const std::uint32_t i : evenlyStrided(values[k].size(), 20000)) sample.push_back(values[k][i]);
  }
  range = colourRangeOf(std::move(sample), settings.colouring);
  for (std::size_t k = 0; k < clouds.size(); ++k) colour(*clouds[k], values[k]);
  few_stale = true;
}

void Scene::Parts::placeNumbers(double length_m) {
  for (auto& number : numbers) front->RemoveViewProp(number);
  numbers.clear();
  if (!settings.path || stops.empty()) return;
  // At most about forty: a crowd of numbers is no help.
  const std::size_t step = (stops.size() + 39) / 40;
  for (std::size_t i = 0; i < stops.size(); i += step) {
    auto number = vtkSmartPointer<vtkBillboardTextActor3D>::New();
    number->SetInput(std::to_string(i).c_str());
    Vector3d at = stops[i].translation() + Vector3d(0, 0, 0.4 * length_m);
    number->SetPosition(at.data());
    number->SetDisplayOffset(static_cast<int>(9 * pixel_ratio), static_cast<int>(7 * pixel_ratio));
    vtkTextProperty& style = *number->GetTextProperty();
    style.SetFontFamilyToArial();
    style.BoldOn();
    style.SetFontSize(static_cast<int>(std::lround(13 * pixel_ratio)));
    style.SetColor(colours.text.r / 255.0, colours.text.g / 255.0, colours.text.b / 255.0);
    style.SetBackgroundColor(colours.bottom.r / 255.0, colours.bottom.g / 255.0, colours.bottom.b / 255.0);
    style.SetBackgroundOpacity(0.6);  // legible over points of any colour
    front->AddViewProp(number);
    numbers.push_back(number);
  }
}

// Of numbers that would lie on one another the first stays.
void Scene::Parts::thinNumbers(const Scene& scene) {
  std::vector<Vector2d> taken;
  for (const auto& number : numbers) {
    const Vector2d place = scene.pixelOf(Vector3d(number->GetPosition()));
    const bool free = std::none_of(taken.begin(), taken.end(), [&](const Vector2d& other) {
      return std::abs(other.x() - place.x()) < 20.0 * pixel_ratio &&
             std::abs(other.y() - place.y()) < 15.0 * pixel_ratio;
    });
    number->SetVisibility(free);
    if (free) taken.push_back(place);
  }
}

void Scene::Parts::placeLines() {
  const std::vector<Vector3d> corners = extentPoints({});
  grid_m = 0.0;
  path.actor->VisibilityOff();
  grid.actor->VisibilityOff();
  double length_m = 0.8;
  if (!corners.empty()) {
    const Vector3d low = corners.front(), high = corners.back();
    const double extent = (high - low).head<2>().maxCoeff();
    length_m = std::clamp(0.028 * extent, 0.3, 20.0);
    if (settings.grid && extent > 0.0) {
      grid_m = roundLength(std::max(extent / 8.0, 0.01));
      grid.set(gridShape(low, high, grid_m), colours.grid, 1.0 * pixel_ratio);
    }
  }
  if (settings.path && !stops.empty()) path.set(pathShape(stops, length_m), colours.text, 2.0 * pixel_ratio);
  placeNumbers(length_m);
}

void Scene::Parts::showActors() {
  for (const auto& cloud : clouds) {
    cloud->all.actor->SetVisibility(cloud->visible && !moving);
    cloud->few.actor->SetVisibility(cloud->visible && moving);
    for (Drawing* drawing : {&cloud->all, &cloud->few})
      drawing->actor->GetProperty()->SetPointSize(static_cast<float>(settings.point_px * pixel_ratio));
  }
}

void Scene::Parts::fillFew() {
  if (!few_stale) return;
  few_stale = false;
  std::size_t total = 0;
  for (const auto& cloud : clouds) total += cloud->visible ? cloud->points.size() : 0;
  for (const auto& cloud : clouds) {
    if (!cloud->visible || total == 0) continue;
    const std::size_t n = cloud->points.size();
    const std::size_t count = std::min(n, (n * kMovingPoints + total - 1) / total);
    std::vector<float> xyz;
    std::vector<Rgb> chosen;
    xyz.reserve(3 * count);
    for (const std::uint32_t i : evenlyStrided(n, count)) {
      for (std::size_t axis = 0; axis < 3; ++axis) xyz.push_back(cloud->points.xyz[3 * i + axis]);
      if (!cloud->colours.empty()) chosen.push_back(cloud->colours[i]);
    }
    cloud->few.setPoints(xyz, false);
    cloud->few.setColours(chosen);
  }
}

void Scene::Parts::applyCamera() {
  vtkCamera& to = *renderer->GetActiveCamera();
  to.SetViewAngle(2.0 * SceneCamera::kHalfAngle_rad / kDegree);
  to.SetParallelProjection(camera.orthographic);
  to.SetParallelScale(camera.halfHeight());
  to.SetPosition(camera.position.data());
  to.SetFocalPoint(camera.focus.data());
  to.SetViewUp(camera.up.data());
}

void Scene::Parts::fitNow() {
  if (!fitted) return;
  camera.fit(extentPoints(fitted_scans), fitted->forward, fitted->up, aspect());
  fitted_size = size();
  pivot = camera.focus;
}

void Scene::Parts::mark(Lines& lines, const std::optional<CellPlace>& cell, Rgb colour_of_mark) {
  lines.actor->VisibilityOff();
  if (!cell) return;
  const Cloud* cloud = cloudOf(cell->scan);
  const ScanEntry* scan = snapshot ? snapshot->find(cell->scan) : nullptr;
  if (!cloud || !scan) return;
  const auto image = scan->image();
  if (!image || cell->row < 0 || cell->column < 0 || cell->row >= (*image)->rows() ||
      cell->column >= (*image)->columns() || !(*image)->hasPoint(cell->row, cell->column))
    return;
  const Vector3d end = cloud->world_from_scan * cellPoint(**image, scan->geometry, cell->row, cell->column);
  lines.set(beamShape(cloud->world_from_scan.translation(), end), colour_of_mark, 1.5 * pixel_ratio);
  lines.actor->GetProperty()->SetPointSize(static_cast<float>(9.0 * pixel_ratio));
  lines.actor->GetProperty()->SetRenderPointsAsSpheres(true);
}

Eigen::Matrix4d Scene::Parts::clipFromWorld() const {
  vtkMatrix4x4* matrix = renderer->GetActiveCamera()->GetCompositeProjectionTransformMatrix(aspect(), -1, 1);
  Eigen::Matrix4d result;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) result(r, c) = matrix->GetElement(r, c);
  return result;
}

Scene::Scene() : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.front->SetLayer(1);
  p.front->InteractiveOff();
  p.front->SetActiveCamera(p.renderer->GetActiveCamera());
  p.overlay = std::make_unique<SceneOverlay>(*p.front);
  for (Lines* lines : {&p.grid, &p.path}) p.renderer->AddActor(lines->actor);
  for (Lines* lines : {&p.hovered, &p.picked}) p.front->AddActor(lines->actor);
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
  std::map<ScanId, std::unique_ptr<Cloud>> before;
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
  std::vector<std::unique_ptr<Cloud>> made(count);
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
    made[i] = std::make_unique<Cloud>();
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
    Cloud& cloud = *made[i];
    cloud.index = i;
    cloud.world_from_scan = p.stops[i];
    cloud.visible = !p.is_visible || p.is_visible(scan.id);
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = p.stops[i].matrix();
    vtkNew<vtkMatrix4x4> placed;
    placed->DeepCopy(matrix.data());
    for (Drawing* drawing : {&cloud.all, &cloud.few}) drawing->actor->SetUserMatrix(placed);
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

void Scene::setView(SceneView view) {
  parts_->fitted = directionOf(view);
  parts_->fitted_scans.clear();
  parts_->fitNow();
}

void Scene::frame(const std::vector<ScanId>& scans) {
  parts_->fitted = Direction{parts_->camera.forward(), parts_->camera.up};
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
  const auto point = cell ? worldPoint(*cell) : std::nullopt;
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

std::optional<CellPlace> Scene::pick(const Vector2d& pixel, double radius_px) const {
  parts_->applyCamera();
  const Eigen::Matrix4d clip_from_world = parts_->clipFromWorld();
  const Vector2d half = 0.5 * parts_->size().cast<double>();
  if (half.minCoeff() <= 0.0) return {};
  // Metres in front of the camera.
  const SceneCamera& camera = parts_->camera;
  Eigen::RowVector4d depth_row;
  depth_row << camera.forward().transpose(), -camera.forward().dot(camera.position);
  struct Candidate {
    const Cloud* cloud;
    std::size_t point;
    double depth, away;
  };
  std::vector<Candidate> candidates;
  for (const auto& cloud : parts_->clouds) {
    if (!cloud->visible) continue;
    const Eigen::Matrix4d clip_from_scan = clip_from_world * cloud->world_from_scan.matrix();
    const Eigen::RowVector4d depth_from_scan = depth_row * cloud->world_from_scan.matrix();
    const std::vector<float>& xyz = cloud->points.xyz;
    for (std::size_t i = 0; i < cloud->points.size(); ++i) {
      const Eigen::Vector4d p(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2], 1.0);
      const double w = clip_from_scan.row(3) * p;
      if (!(w > 1e-9)) continue;
      const double x = (clip_from_scan.row(0) * p / w).value() * half.x() + half.x() - pixel.x();
      if (std::abs(x) > radius_px) continue;
      const double y = (clip_from_scan.row(1) * p / w).value() * half.y() + half.y() - pixel.y();
      const double away = std::hypot(x, y);
      if (away <= radius_px) candidates.push_back({cloud.get(), i, depth_from_scan * p, away});
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

std::optional<Vector3d> Scene::worldPoint(const CellPlace& cell) const {
  const Cloud* cloud = parts_->cloudOf(cell.scan);
  if (!cloud) return {};
  const auto wanted = static_cast<std::uint32_t>(cell.row * cloud->points.columns + cell.column);
  // Ascending, unless a grid has mixed them.
  const auto& cells = cloud->points.cell;
  const auto found = std::find(cells.begin(), cells.end(), wanted);
  if (found == cells.end()) return {};
  return cloud->at(static_cast<std::size_t>(found - cells.begin()));
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
