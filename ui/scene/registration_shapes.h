// Lines, boxes, patches and the gizmo of the registration layer, and what a drag of the gizmo means. For the
// layer's own files only.
#pragma once

#include <functional>
#include <vector>
#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkUnsignedCharArray.h>

#include "core/registration/surface_elements.h"
#include "ui/scene/registration_layer.h"

namespace tiltmap::ui {

// Line segments and dots, each of its own colour.
class LineShape {
 public:
  LineShape();
  void add(const Eigen::Vector3d& from, const Eigen::Vector3d& to, Rgb colour);
  void addDot(const Eigen::Vector3d& at, Rgb colour);
  vtkPolyData& data();  // complete

 private:
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> dots_, lines_;
  vtkNew<vtkUnsignedCharArray> dot_colours_, line_colours_;
};

struct LineDrawing {
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;
  LineDrawing();
  void set(LineShape& shape, double line_px, double dot_px);
};

// The outline of a patch: where a uniform one of these deviations would end.
void addPatch(LineShape& shape, const SurfaceElements& elements, std::size_t index, const Pose& pose,
              Rgb colour);
void addBox(LineShape& shape, const Eigen::Vector3d& low, const Eigen::Vector3d& high, Rgb colour);

// Where each handle of the gizmo can be taken; the ring in many places.
Eigen::Vector3d gizmoPlace(GizmoHandle handle, const Pose& pose, double length_m);
std::vector<Eigen::Vector3d> ringPlaces(const Pose& pose, double length_m);
void addGizmo(LineShape& shape, const Pose& pose, double length_m, GizmoHandle active,
              const RegistrationColours& colours);
// `pixels` projects the fixed frame. A handle that points at the eye does not move.
RegistrationLayer::Drag dragOf(GizmoHandle handle, const Eigen::Vector3d& at, const Eigen::Vector2d& from_px,
                               const Eigen::Vector2d& to_px,
                               const std::function<Eigen::Vector2d(const Eigen::Vector3d&)>& pixels);

}  // namespace tiltmap::ui
