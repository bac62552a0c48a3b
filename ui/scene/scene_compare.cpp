// Two stages compared, a part cut out, distances measured.
#include "core/base/ranks.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Rgb kBoxColour{240, 200, 60};
constexpr Rgb kBoxOnLight{150, 95, 0};
constexpr Rgb kMeasureColour{120, 220, 255}, kMeasureOnLight{0, 80, 150};
constexpr double kThinnestSlice_m = 0.01;

std::string signedLength(double metres) {
  return (metres < 0.0 ? "−" : "") + fixedReal(std::abs(metres), 3);
}

}  // namespace

void Scene::setCompare(SceneCompare how, Stage before) {
  Parts& p = *parts_;
  if (p.compare == how && p.before == before) return;
  p.compare = how;
  p.before = before;
  p.shows_before = false;
  p.placeClouds();
  if (p.settings.colouring != SceneColouring::Scan) p.colourAll();
  p.placeLines();
}

SceneCompare Scene::compare() const {
  return parts_->compare;
}

Stage Scene::before() const {
  return parts_->before;
}

void Scene::setDivider(double share) {
  parts_->divider = std::clamp(share, 0.0, 1.0);
}

double Scene::divider() const {
  return parts_->divider;
}

void Scene::setShowsBefore(bool before) {
  parts_->shows_before = before;
}

bool Scene::showsBefore() const {
  return parts_->compare == SceneCompare::Blink && parts_->shows_before;
}

void Scene::setSlice(const std::optional<PointBox>& box) {
  Parts& p = *parts_;
  p.slice = box;
  if (p.slice)
    for (int axis = 0; axis < 3; ++axis)
      p.slice->high[axis] = std::max(p.slice->high[axis], p.slice->low[axis] + kThinnestSlice_m);
  p.placeBox();
}

const std::optional<PointBox>& Scene::slice() const {
  return parts_->slice;
}

std::optional<PointBox> Scene::extent() const {
  const std::vector<Vector3d> corners = parts_->extentPoints({}, nullptr);
  if (corners.empty()) return {};
  return PointBox{corners.front(), corners.back()};
}

double Scene::scannerHeight() const {
  std::vector<double> heights;
  for (const Pose& stop : parts_->stops[0]) heights.push_back(stop.translation().z());
  if (heights.empty()) return 0.0;
  return medianOf(std::move(heights));
}

std::vector<Vector3d> Scene::Parts::handles() const {
  std::vector<Vector3d> places;
  if (!slice) return places;
  const Vector3d middle = 0.5 * (slice->low + slice->high);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      places.push_back(middle);
      places.back()[axis] = (high ? slice->high : slice->low)[axis];
    }
  return places;
}

std::optional<Vector2d> Scene::pixelOf(const SliceHandle& handle) const {
  const std::vector<Vector3d> places = parts_->handles();
  if (places.empty()) return {};
  return pixelOf(places[static_cast<std::size_t>(2 * handle.axis + (handle.high ? 1 : 0))]);
}

std::optional<SliceHandle> Scene::sliceHandleAt(const Vector2d& pixel, double radius_px) const {
  std::optional<SliceHandle> best;
  double nearest = radius_px;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const SliceHandle handle{axis, high};
      const auto at = pixelOf(handle);
      // Of an axis that points at the eye nothing can be dragged.
      if (!at || std::abs(parts_->camera.forward()[axis]) > 0.97 || (*at - pixel).norm() > nearest) continue;
      nearest = (*at - pixel).norm();
      best = handle;
    }
  return best;
}

void Scene::dragSlice(const SliceHandle& handle, const Vector2d& by_px) {
  Parts& p = *parts_;
  if (!p.slice) return;
  const Vector3d place = p.handles()[static_cast<std::size_t>(2 * handle.axis + (handle.high ? 1 : 0))];
  const Vector3d along = Vector3d::Unit(handle.axis);
  // How the handle moves in the picture for a step along its axis.
  const double step_m = std::max(metresPerPixel(), 1e-6);
  const Vector2d moves = (pixelOf(Vector3d(place + step_m * along)) - pixelOf(place)) / step_m;
  if (moves.norm() < 1e-6) return;
  const double by_m = by_px.dot(moves) / moves.squaredNorm();
  PointBox box = *p.slice;
  if (handle.high)
    box.high[handle.axis] = std::max(box.high[handle.axis] + by_m, box.low[handle.axis] + kThinnestSlice_m);
  else
    box.low[handle.axis] = std::min(box.low[handle.axis] + by_m, box.high[handle.axis] - kThinnestSlice_m);
  setSlice(box);
}

void Scene::Parts::placeBox() {
  box.actor->VisibilityOff();
  if (slice)
    box.set(boxShape(slice->low, slice->high), lightGround() ? kBoxOnLight : kBoxColour, 1.0 * pixel_ratio);
}

void Scene::setMeasured(const std::vector<Vector3d>& places) {
  Parts& p = *parts_;
  p.measured = places;
  p.measure.actor->VisibilityOff();
  if (places.empty()) return;
  const Rgb ink = p.lightGround() ? kMeasureOnLight : kMeasureColour;
  p.measure.set(measureShape(places), ink, 2.0 * p.pixel_ratio);
  p.measure.actor->GetProperty()->SetPointSize(static_cast<float>(9.0 * p.pixel_ratio));
}

const std::vector<Vector3d>& Scene::measured() const {
  return parts_->measured;
}

void Scene::Parts::writeOver(OverlayContents& contents, const Scene& scene) const {
  const bool bar = settings.colouring != SceneColouring::Scan && settings.colouring != SceneColouring::Normal;
  if (bar && range.known) {
    contents.bar_title = sceneColouringTitle(settings.colouring);
    contents.bar_is_signed = settings.colouring == SceneColouring::Residual;
    contents.middle_lightness = middleLightness();
    const int places = contents.bar_is_signed ? 3 : range.high - range.low < 20.0 ? 1 : 0;
    contents.bar_low = fixedReal(range.low, places);
    contents.bar_high = (contents.bar_is_signed ? "+" : "") + fixedReal(range.high, places);
    contents.low_lightness = lowLightness();
    contents.high_lightness = highLightness();
  }
  if (compare == SceneCompare::Wipe) {
    contents.divider = divider;
    contents.divider_colour = colours.text;
    contents.left_of_divider = wordsOf(before);
    contents.right_of_divider = wordsOf(stage);
  }
  if (compare == SceneCompare::Blink) contents.corner = wordsOf(shows_before ? before : stage);
  const std::vector<Vector3d> places = handles();
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (std::abs(camera.forward()[static_cast<int>(k / 2)]) > 0.97) continue;
    contents.handles.emplace_back(scene.pixelOf(places[k]), lightGround() ? kBoxOnLight : kBoxColour);
  }
  writeRoles(contents, scene);
  if (measured.size() == 2) {
    const Vector3d by = measured[1] - measured[0];
    const Vector2d at = scene.pixelOf(Vector3d(0.5 * (measured[0] + measured[1])));
    const Rgb ink = colours.text;
    contents.labels.push_back({at + Vector2d(0.0, 24.0 * pixel_ratio), fixedReal(by.norm(), 3) + " m", ink});
    contents.labels.push_back(
        {at - Vector2d(0.0, 20.0 * pixel_ratio),
         "x " + signedLength(by.x()) + "  y " + signedLength(by.y()) + "  z " + signedLength(by.z()) + " m",
         ink});
  }
}

}  // namespace tiltmap::ui
