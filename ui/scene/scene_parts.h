// What a scene is made of. For the scene's own files only.
#pragma once

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
#include "ui/scene/scene.h"
#include "ui/scene/scene_camera.h"
#include "ui/scene/scene_overlay.h"
#include "ui/scene/scene_shapes.h"

namespace tiltmap::ui {

inline void paint(vtkActor& actor, Rgb colour) {
  actor.GetProperty()->SetColor(colour.r / 255.0, colour.g / 255.0, colour.b / 255.0);
}

// One drawing of some points: all of them, or the few while moving.
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

struct SceneCloud {
  ScanPoints points;
  Pose world_from_scan;
  std::size_t index = 0;
  bool visible = true;
  std::vector<Rgb> colours;  // empty: the scan's
  PointDrawing all;
  PointDrawing few;

  Eigen::Vector3d at(std::size_t i) const {
    return world_from_scan * Eigen::Vector3d(points.xyz[3 * i], points.xyz[3 * i + 1], points.xyz[3 * i + 2]);
  }
};

struct SceneLines {
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;
  SceneLines() {
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

struct ViewDirection {
  Eigen::Vector3d forward, up;
};

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
  std::vector<std::unique_ptr<SceneCloud>>
      clouds;  // in the survey's order; none for scans that cannot be read
  std::vector<Pose> stops;
  ColourRange range;
  double grid_m = 0.0;

  SceneLines path, grid, hovered, picked;
  std::optional<CellPlace> hovered_cell, picked_cell;
  std::vector<vtkSmartPointer<vtkBillboardTextActor3D>> numbers;

  SceneCamera camera;
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  std::optional<ViewDirection> fitted;  // the camera follows the window's shape until it is moved by hand
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
    const Rgb colour = snapshot && index < snapshot->scans().size()
                           ? scanColour(snapshot->scans()[index], index)
                           : scanColour(index);
    return lightGround() ? mixed(colour, {0, 0, 0}, 0.25) : colour;
  }

  SceneCloud* cloudOf(ScanId scan) const {
    for (const auto& cloud : clouds)
      if (cloud->points.scan == scan) return cloud.get();
    return nullptr;
  }
  std::vector<Eigen::Vector3d> extentPoints(const std::vector<ScanId>& scans) const;
  void colourAll();
  void colour(SceneCloud& cloud, const std::vector<float>& values);
  void placeLines();
  void placeNumbers(double length_m);
  void thinNumbers(const Scene& scene);
  void showActors();
  void fillFew();
  void applyCamera();
  void fitNow();
  void mark(SceneLines& lines, const std::optional<CellPlace>& cell, Rgb colour);
  Eigen::Matrix4d clipFromWorld() const;
};

}  // namespace tiltmap::ui
