// Lines, boxes, patches and the gizmo of the registration layer, and what a drag of the gizmo means. For the
// layer's own files only.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>
#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include "core/registration/surface_elements.h"
#include "ui/scene/registration_layer.h"

namespace tiltmap::ui {

// The points of one scan in one colour.
struct PointDrawing {
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;

  PointDrawing() {
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
};

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
