// Points, colours, lines and marks of the scene.
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

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

void Scene::Parts::colour(SceneCloud& cloud, const std::vector<float>& values) {
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
  for (PointDrawing* drawing : {&cloud.all, &cloud.few}) paint(*drawing->actor, inkOfScan(cloud.index));
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
    SceneCloud& cloud = *clouds[k];
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
    for (PointDrawing* drawing : {&cloud->all, &cloud->few})
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

void Scene::Parts::mark(SceneLines& lines, const std::optional<CellPlace>& cell, Rgb colour_of_mark) {
  lines.actor->VisibilityOff();
  if (!cell) return;
  const SceneCloud* cloud = cloudOf(cell->scan);
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

}  // namespace tiltmap::ui
