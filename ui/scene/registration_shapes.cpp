#include "ui/scene/registration_shapes.h"

#include <cmath>
#include <numbers>
#include <vtkCellData.h>
#include <vtkProperty.h>

#include <Eigen/LU>

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kRing = 0.7;          // radius of the ring against the arrows' length
constexpr double kPlane = 0.32;        // where the square lies
constexpr double kUniformEdge = 1.73;  // a uniform patch ends at 3^(1/2) deviations
constexpr int kRingParts = 48;

void insert(vtkUnsignedCharArray& colours, Rgb c) {
  const unsigned char rgb[3] = {c.r, c.g, c.b};
  colours.InsertNextTypedTuple(rgb);
}

}  // namespace

LineShape::LineShape() {
  dot_colours_->SetNumberOfComponents(3);
  line_colours_->SetNumberOfComponents(3);
}

void LineShape::add(const Vector3d& from, const Vector3d& to, Rgb colour) {
  const vtkIdType ids[2] = {points_->InsertNextPoint(from.data()), points_->InsertNextPoint(to.data())};
  lines_->InsertNextCell(2, ids);
  insert(*line_colours_, colour);
}

void LineShape::addDot(const Vector3d& at, Rgb colour) {
  const vtkIdType id = points_->InsertNextPoint(at.data());
  dots_->InsertNextCell(1, &id);
  insert(*dot_colours_, colour);
}

vtkPolyData& LineShape::data() {
  // Cell data of a poly data: dots before lines.
  for (vtkIdType i = 0; i < line_colours_->GetNumberOfTuples(); ++i)
    dot_colours_->InsertNextTypedTuple(line_colours_->GetPointer(3 * i));
  data_->SetPoints(points_);
  data_->SetVerts(dots_);
  data_->SetLines(lines_);
  data_->GetCellData()->SetScalars(dot_colours_);
  return *data_;
}

LineDrawing::LineDrawing() {
  mapper->SetColorModeToDirectScalars();
  mapper->SetScalarModeToUseCellData();
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->PickableOff();
  actor->VisibilityOff();
}

void LineDrawing::set(LineShape& shape, double line_px, double dot_px) {
  vtkPolyData& data = shape.data();
  mapper->SetInputData(&data);
  actor->GetProperty()->SetLineWidth(static_cast<float>(line_px));
  actor->GetProperty()->SetPointSize(static_cast<float>(dot_px));
  actor->SetVisibility(data.GetNumberOfCells() > 0);
}

void addPatch(LineShape& shape, const SurfaceElements& elements, std::size_t index, const Pose& pose,
              Rgb colour) {
  const PatchShape& patch = elements.shape[index];
  const Vector3d u = kUniformEdge * patch.extent_u_m * patch.u, v = kUniformEdge * patch.extent_v_m * patch.v;
  const Vector3d c = elements.position[index];
  const Vector3d corners[4] = {pose * (c + u + v), pose * (c - u + v), pose * (c - u - v),
                               pose * (c + u - v)};
  for (int k = 0; k < 4; ++k) shape.add(corners[k], corners[(k + 1) % 4], colour);
}

void addBox(LineShape& shape, const Vector3d& low, const Vector3d& high, Rgb colour) {
  const auto corner = [&](int k) {
    return Vector3d((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
  };
  for (int k = 0; k < 8; ++k)
    for (const int bit : {1, 2, 4})
      if (!(k & bit)) shape.add(corner(k), corner(k | bit), colour);
}

Vector3d gizmoPlace(GizmoHandle handle, const Pose& pose, double length_m) {
  const Vector3d at = pose.translation();
  switch (handle) {
    case GizmoHandle::X:
      return at + length_m * Vector3d::UnitX();
    case GizmoHandle::Y:
      return at + length_m * Vector3d::UnitY();
    case GizmoHandle::Z:
      return at + length_m * Vector3d::UnitZ();
    case GizmoHandle::Plane:
      return at + kPlane * length_m * Vector3d(1.0, 1.0, 0.0);
    case GizmoHandle::Turn:
      return at + kRing * length_m * Vector3d(-1.0, -1.0, 0.0).normalized();
    case GizmoHandle::None:
      break;
  }
  return at;
}

std::vector<Vector3d> ringPlaces(const Pose& pose, double length_m) {
  std::vector<Vector3d> places;
  for (int k = 0; k < kRingParts; ++k) {
    const double a = 2.0 * std::numbers::pi * k / kRingParts;
    places.push_back(pose.translation() + kRing * length_m * Vector3d(std::cos(a), std::sin(a), 0.0));
  }
  return places;
}

void addGizmo(LineShape& shape, const Pose& pose, double length_m, GizmoHandle active,
              const RegistrationColours& colours) {
  const Vector3d at = pose.translation();
  const auto ink = [&](GizmoHandle handle, Rgb own) { return handle == active ? colours.picked : own; };
  // The colours of the triad in the corner.
  const std::pair<GizmoHandle, Rgb> arrows[] = {
      {GizmoHandle::X, {228, 88, 76}}, {GizmoHandle::Y, {108, 178, 76}}, {GizmoHandle::Z, {86, 140, 236}}};
  for (const auto& [handle, own] : arrows) {
    const Vector3d tip = gizmoPlace(handle, pose, length_m);
    shape.add(at, tip, ink(handle, own));
    shape.addDot(tip, ink(handle, own));
  }
  const Rgb plane = ink(GizmoHandle::Plane, colours.moving);
  const double s = kPlane * length_m;
  const Vector3d corners[4] = {at + Vector3d(0.6 * s, 0.6 * s, 0), at + Vector3d(1.4 * s, 0.6 * s, 0),
                               at + Vector3d(1.4 * s, 1.4 * s, 0), at + Vector3d(0.6 * s, 1.4 * s, 0)};
  for (int k = 0; k < 4; ++k) shape.add(corners[k], corners[(k + 1) % 4], plane);
  shape.addDot(gizmoPlace(GizmoHandle::Plane, pose, length_m), plane);
  const Rgb ring = ink(GizmoHandle::Turn, colours.moving);
  const std::vector<Vector3d> places = ringPlaces(pose, length_m);
  for (std::size_t k = 0; k < places.size(); ++k) shape.add(places[k], places[(k + 1) % places.size()], ring);
  shape.addDot(gizmoPlace(GizmoHandle::Turn, pose, length_m), ring);
  // Where the moving scan looks.
  const Vector3d ahead = kRing * length_m * pose.heading();
  shape.add(at + 0.75 * ahead, at + ahead, ring);
}

namespace {

// The place in the level plane through `at` that is drawn at the pixel; Newton on the projection.
Vector3d inPlane(const Vector3d& at, const Vector2d& pixel,
                 const std::function<Vector2d(const Vector3d&)>& pixels) {
  Vector3d p = at;
  for (int k = 0; k < 12; ++k) {
    const Vector2d here = pixels(p);
    constexpr double kStep_m = 1e-3;
    Eigen::Matrix2d by;
    by.col(0) = (pixels(p + Vector3d(kStep_m, 0, 0)) - here) / kStep_m;
    by.col(1) = (pixels(p + Vector3d(0, kStep_m, 0)) - here) / kStep_m;
    if (std::abs(by.determinant()) < 1e-6) return at;  // seen from the side
    const Vector2d d = by.inverse() * (pixel - here);
    p += Vector3d(d.x(), d.y(), 0.0);
    if (!p.allFinite() || (p - at).norm() > 1e4) return at;
    if (d.norm() < 1e-6) break;
  }
  return p;
}

}  // namespace

RegistrationLayer::Drag dragOf(GizmoHandle handle, const Vector3d& at, const Vector2d& from_px,
                               const Vector2d& to_px,
                               const std::function<Vector2d(const Vector3d&)>& pixels) {
  RegistrationLayer::Drag drag;
  switch (handle) {
    case GizmoHandle::None:
      break;
    case GizmoHandle::X:
    case GizmoHandle::Y:
    case GizmoHandle::Z: {
      const Vector3d axis = Vector3d::Unit(static_cast<int>(handle) - static_cast<int>(GizmoHandle::X));
      const Vector2d per_metre = pixels(at + axis) - pixels(at);
      if (per_metre.norm() > 1.0)
        drag.shift_m = axis * (to_px - from_px).dot(per_metre) / per_metre.squaredNorm();
      break;
    }
    case GizmoHandle::Plane:
      drag.shift_m = inPlane(at, to_px, pixels) - inPlane(at, from_px, pixels);
      break;
    case GizmoHandle::Turn: {
      const Vector3d a = inPlane(at, from_px, pixels) - at, b = inPlane(at, to_px, pixels) - at;
      if (a.norm() > 1e-9 && b.norm() > 1e-9)
        drag.turn_rad =
            std::remainder(std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x()), 2.0 * std::numbers::pi);
      break;
    }
  }
  return drag;
}

}  // namespace tiltmap::ui
