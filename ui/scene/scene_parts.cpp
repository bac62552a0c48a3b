// Points, colours, lines and marks of the scene.
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The eight corners of a box around most points, and the stops.
std::vector<Vector3d> Scene::Parts::extentPoints(const std::vector<ScanId>& scans,
                                                 const PointBox* within) const {
  // Of many scans fewer points each: this is asked for whenever some have been read.
  constexpr std::size_t kPoints = 400'000, kOfOneScan = 2000;
  const std::size_t of_one = std::min(kOfOneScan, kPoints / std::max<std::size_t>(clouds.size(), 1) + 1);
  std::array<std::vector<double>, 3> along;
  for (const auto& cloud : clouds) {
    if (scans.empty() ? !cloud->batch.visible
                      : std::find(scans.begin(), scans.end(), cloud->points.scan) == scans.end())
      continue;
    for (const std::uint32_t i : evenlyStrided(cloud->points.size(), of_one)) {
      const Vector3d p = cloud->at(i);
      if (within && !within->contains(p)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(p[static_cast<int>(axis)]);
    }
  }
  // Stops of scans whose points are still to come, too.
  for (std::size_t i = 0; !within && i < stops[0].size(); ++i) {
    const ScanId scan = snapshot->scans()[i].id;
    if (scans.empty() ? is_visible && !is_visible(scan)
                      : std::find(scans.begin(), scans.end(), scan) == scans.end())
      continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      along[axis].push_back(stops[0][i].translation()[static_cast<int>(axis)]);
  }
  if (along[0].empty()) return extra_extent;
  Vector3d low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& values = along[axis];
    // What one beam in fifty hit far away must not make everything else small.
    const std::size_t cut = values.size() / 50;
    const auto ranked = [&values](std::size_t rank) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    low[static_cast<int>(axis)] = ranked(cut);
    high[static_cast<int>(axis)] = ranked(values.size() - 1 - cut);
  }
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.emplace_back((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
  return corners;
}

bool Scene::Parts::has(std::size_t index) const {
  const PointsKey key = keyOf(wanted(index));
  const SceneCloud* cloud = cloudOf(key.scan);
  return cloud && cloud->points.matrix == key.matrix && cloud->points.lines == key.lines &&
         cloud->points.geometry == key.geometry && cloud->points.reduced == key.reduced &&
         (!key.normals || cloud->points.with_normals);
}

// At once, on all cores. Scans that cannot be read are not drawn.
std::vector<std::string> Scene::Parts::readMissing() {
  const std::size_t count = snapshot->scans().size();
  std::vector<std::optional<Result<ScanPoints>>> read(count);
  parallelFor(count, 0, [&](std::size_t i) {
    if (!has(i)) read[i] = readPoints(wanted(i), {});
  });
  std::vector<ScanPoints> points;
  std::vector<std::string> troubles;
  for (std::size_t i = 0; i < count; ++i) {
    if (!read[i]) continue;
    const ScanEntry& scan = snapshot->scans()[i];
    if (*read[i])
      points.push_back(std::move(**read[i]));
    else
      troubles.push_back(scan.name + ": " + read[i]->error().what);
    std::erase_if(clouds, [&](const auto& cloud) { return cloud->points.scan == scan.id; });
  }
  takeIn(std::move(points));
  return troubles;
}

void Scene::Parts::takeIn(std::vector<ScanPoints> points) {
  for (ScanPoints& scan : points) {
    const auto index = snapshot ? snapshot->indexOf(scan.scan) : std::nullopt;
    if (!index) continue;
    auto cloud = std::make_unique<SceneCloud>();
    cloud->points = std::move(scan);
    cloud->index = *index;
    cloud->encircle();
    const auto place = std::lower_bound(clouds.begin(), clouds.end(), *index,
                                        [](const auto& other, std::size_t i) { return other->index < i; });
    if (place != clouds.end() && (*place)->index == *index)
      *place = std::move(cloud);
    else
      clouds.insert(place, std::move(cloud));
  }
}

void Scene::Parts::showClouds() {
  for (const auto& cloud : clouds) cloud->batch.visible = !is_visible || is_visible(cloud->points.scan);
  placeClouds();
  colourAll();
  placeLines();
  showActors();
  fitNow();
  mark(hovered, hovered_cell, kHoverColour);
  mark(picked, picked_cell, kPickColour);
}

void SceneCloud::encircle() {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < points.size(); ++i)
    box.extend(Eigen::Map<const Eigen::Vector3f>(points.xyz.data() + 3 * i));
  if (box.isEmpty()) return;
  middle = box.center().cast<double>();
  radius_m = 0.5 * static_cast<double>(box.diagonal().norm());
}

// Where each stage puts the scans.
void Scene::Parts::placeClouds() {
  const bool both = compare != SceneCompare::Off;
  stops[0] = snapshot ? snapshot->filledPoses(stage) : std::vector<Pose>();
  stops[1] = both && snapshot ? snapshot->filledPoses(before) : std::vector<Pose>();
  std::vector<PointBatch*> batches;
  for (const auto& cloud : clouds) {
    cloud->batch.world_from_scan[0] = stops[0][cloud->index];
    cloud->batch.world_from_scan[1] = stops[both ? 1 : 0][cloud->index];
    cloud->batch.ink = inkOf(*cloud);
    batches.push_back(&cloud->batch);
  }
  layer->setBatches(std::move(batches));
  ++content;
}

std::vector<float> Scene::Parts::valuesOf(const SceneCloud& cloud, int side,
                                          std::optional<double> first_time_s) const {
  if (settings.colouring != SceneColouring::Residual)
    return colourValues(cloud.points, settings.colouring, cloud.pose(side), cloud.index, first_time_s);
  const auto& known = residuals[static_cast<std::size_t>(side)];
  const auto found = known.find(cloud.points.scan);
  std::vector<float> values;
  if (found == known.end() || !found->second) return values;
  values.reserve(cloud.points.size());
  for (const std::uint32_t cell : cloud.points.cell)
    values.push_back(cell < found->second->size() ? (*found->second)[cell]
                                                  : std::numeric_limits<float>::quiet_NaN());
  return values;
}

void Scene::Parts::colour(SceneCloud& cloud, int side, const std::vector<float>& values) {
  std::vector<Rgb>& result = cloud.batch.colours[static_cast<std::size_t>(side)];
  result.clear();
  if (settings.colouring == SceneColouring::Normal) {
    const Eigen::Matrix3d rotation = cloud.pose(side).rotation();
    result.reserve(cloud.points.size());
    if (cloud.points.normal.empty()) result.assign(cloud.points.size(), colours.no_data);  // still to come
    for (std::size_t i = 0; i < cloud.points.normal.size() / 3; ++i) {
      const Vector3d n = rotation * Vector3d(cloud.points.normal[3 * i], cloud.points.normal[3 * i + 1],
                                             cloud.points.normal[3 * i + 2]);
      const Vector3d c = 127.5 * (n.array() + 1.0);
      result.push_back(n.isZero() ? colours.no_data
                                  : Rgb{static_cast<std::uint8_t>(std::lround(c.x())),
                                        static_cast<std::uint8_t>(std::lround(c.y())),
                                        static_cast<std::uint8_t>(std::lround(c.z()))});
    }
  } else if (settings.colouring != SceneColouring::Scan) {
    // A table: a colour through OKLab a point would take a second for a large project.
    std::array<Rgb, 256> table;
    for (std::size_t k = 0; k < table.size(); ++k) {
      const double t = static_cast<double>(k) / 255.0;
      table[k] = settings.colouring == SceneColouring::Residual
                     ? signedColour(2.0 * t - 1.0, middleLightness())
                     : evenColour(t, lowLightness(), highLightness());
    }
    const double per_value = 255.0 / (range.high - range.low);
    result.assign(cloud.points.size(), colours.no_data);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i]))
        result[i] =
            table[static_cast<std::size_t>(std::clamp((values[i] - range.low) * per_value, 0.0, 255.0))];
  } else {
    std::vector<Rgb>().swap(result);
  }
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
  // What depends on the poses has a colour of its own on either side of a comparison.
  const bool by_pose = settings.colouring == SceneColouring::Height ||
                       settings.colouring == SceneColouring::Normal ||
                       settings.colouring == SceneColouring::Residual;
  const int sides = compare != SceneCompare::Off && by_pose ? 2 : 1;
  std::vector<std::array<std::vector<float>, 2>> values(clouds.size());
  if (wantsNormals() && reads_itself)
    parallelFor(clouds.size(), 0,
                [&](std::size_t k) { addNormals(clouds[k]->points, snapshot->scans()[clouds[k]->index]); });
  parallelFor(clouds.size(), 0, [&](std::size_t k) {
    for (int side = 0; side < sides; ++side)
      values[k][static_cast<std::size_t>(side)] = valuesOf(*clouds[k], side, first_time);
  });
  std::vector<float> sample;
  for (std::size_t k = 0; k < clouds.size(); ++k) {
    if (!clouds[k]->batch.visible) continue;
    for (const auto& side : values[k])
      for (const std::uint32_t i : evenlyStrided(side.size(), 20000)) sample.push_back(side[i]);
  }
  range = colourRangeOf(std::move(sample), settings.colouring);
  parallelFor(clouds.size(), 0, [&](std::size_t k) {
    SceneCloud& cloud = *clouds[k];
    cloud.batch.ink = inkOf(cloud);
    ++cloud.batch.colours_changed;
    cloud.batch.colours[1] = {};
    for (int side = 0; side < sides; ++side) colour(cloud, side, values[k][static_cast<std::size_t>(side)]);
  });
  ++content;
}

void Scene::Parts::placeNumbers(double length_m) {
  for (auto& [stop, number] : numbers) front->RemoveViewProp(number);
  numbers.clear();
  if (!settings.path || stops[0].empty()) return;
  // At most about forty: a crowd of numbers is no help.
  const std::size_t step = (stops[0].size() + 39) / 40;
  number_height_m = 0.4 * length_m;
  for (std::size_t i = 0; i < stops[0].size(); i += step) {
    auto number = vtkSmartPointer<vtkBillboardTextActor3D>::New();
    number->SetInput(std::to_string(i).c_str());
    number->SetDisplayOffset(static_cast<int>(9 * pixel_ratio), static_cast<int>(7 * pixel_ratio));
    vtkTextProperty& style = *number->GetTextProperty();
    style.SetFontFamilyToArial();
    style.BoldOn();
    style.SetFontSize(static_cast<int>(std::lround(13 * pixel_ratio)));
    style.SetColor(colours.text.r / 255.0, colours.text.g / 255.0, colours.text.b / 255.0);
    style.SetBackgroundColor(colours.bottom.r / 255.0, colours.bottom.g / 255.0, colours.bottom.b / 255.0);
    style.SetBackgroundOpacity(0.6);  // legible over points of any colour
    front->AddViewProp(number);
    numbers.emplace_back(i, number);
  }
}

// Each number at the stop of the stage that is seen there; of numbers that would lie on one another the first
// stays.
void Scene::Parts::thinNumbers(const Scene& scene) {
  std::vector<Vector2d> taken;
  const Vector3d above(0, 0, number_height_m);
  for (const auto& [stop, number] : numbers) {
    bool shown = false;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      if (stops[side].size() <= stop) continue;
      const Vector3d at = stops[side][stop].translation() + above;
      const Vector2d place = scene.pixelOf(at);
      if (sideAt(place.x()) != static_cast<int>(side)) continue;
      shown = std::none_of(taken.begin(), taken.end(), [&](const Vector2d& other) {
        return std::abs(other.x() - place.x()) < 20.0 * pixel_ratio &&
               std::abs(other.y() - place.y()) < 15.0 * pixel_ratio;
      });
      if (!shown) continue;
      taken.push_back(place);
      Vector3d position = at;
      number->SetPosition(position.data());
      break;
    }
    number->SetVisibility(shown);
  }
}

void Scene::Parts::placeLines() {
  const std::vector<Vector3d> corners = extentPoints({}, nullptr);
  grid_m = 0.0;
  for (SceneLines& path : paths) path.actor->VisibilityOff();
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
  for (std::size_t side = 0; side < 2; ++side)
    if (settings.path && !stops[side].empty())
      paths[side].set(pathShape(stops[side], length_m), colours.text, 2.0 * pixel_ratio);
  placeNumbers(length_m);
}

void Scene::Parts::showActors() {
  ++content;
}

// What the points' pictures depend on, and how they are mixed. The depth of the picture comes from the points
// and not from marks over them, so that a mark that moves does not change it.
void Scene::Parts::lookAtPoints() {
  applyCamera();
  double near_m = std::numeric_limits<double>::infinity(), far_m = 0.0;
  const auto include = [&](const Vector3d& centre, double radius) {
    const double depth = camera.forward().dot(centre - camera.position);
    near_m = std::min(near_m, depth - radius);
    far_m = std::max(far_m, depth + radius);
  };
  for (const auto& cloud : clouds)
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      if (cloud->batch.visible && (side == 0 || compare != SceneCompare::Off))
        include(cloud->batch.world_from_scan[side] * cloud->middle, cloud->radius_m + 1.0);
  for (const auto& side : stops)
    for (const Pose& stop : side) include(stop.translation(), 25.0);  // its arrow
  // What others draw among the points; marks over everything are in the front renderer and change nothing
  // here.
  double bounds[6];
  renderer->ComputeVisiblePropBounds(bounds);
  if (bounds[0] <= bounds[1])
    for (int k = 0; k < 8; ++k)
      include({bounds[k & 1], bounds[2 + (k >> 1 & 1)], bounds[4 + (k >> 2 & 1)]}, 0.1);
  if (!std::isfinite(near_m)) include(camera.focus, camera.distance());
  far_m = std::max(far_m, 1.0);
  near_m = std::max(near_m, 0.001 * far_m);
  renderer->GetActiveCamera()->SetClippingRange(near_m, far_m);

  PointLook look;
  look.clip_from_world = clipFromWorld();
  look.point_px = settings.point_px * pixel_ratio;
  look.box = slice;
  look.content = content;
  layer->setLook(look);
  PointMix mix;
  mix.only_before = compare == SceneCompare::Blink && shows_before;
  if (compare == SceneCompare::Wipe) mix.divider = divider;
  mix.shaded = settings.shaded;
  mix.shade_radius_px = pixel_ratio;
  mix.near_m = near_m;
  mix.far_m = far_m;
  mix.orthographic = camera.orthographic;
  layer->setMix(mix);
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
  std::vector<Vector3d> seen = extentPoints(fitted_scans, slice ? &*slice : nullptr);
  if (seen.empty()) seen = extentPoints(fitted_scans, nullptr);
  camera.fit(seen, fitted->forward, fitted->up, aspect());
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
  const int side = compare == SceneCompare::Blink && shows_before ? 1 : 0;
  const Vector3d end = cloud->pose(side) * cellPoint(**image, scan->geometry, cell->row, cell->column);
  lines.set(beamShape(cloud->pose(side).translation(), end), colour_of_mark, 1.5 * pixel_ratio);
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
