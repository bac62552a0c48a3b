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
#include <vtkCullerCollection.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextProperty.h>

#include <Eigen/Geometry>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "core/products/scan_colours.h"
#include "core/products/top_view_marks.h"
#include "ui/scene/point_layer.h"
#include "ui/scene/scene.h"
#include "ui/scene/scene_camera.h"
#include "ui/scene/scene_overlay.h"
#include "ui/scene/scene_shapes.h"

namespace tiltmap::ui {

inline constexpr Rgb kHoverColour{255, 170, 40};
inline constexpr Rgb kPickColour{255, 90, 200};

inline void paint(vtkActor& actor, Rgb colour) {
  actor.GetProperty()->SetColor(colour.r / 255.0, colour.g / 255.0, colour.b / 255.0);
}

struct SceneCloud {
  ScanPoints points;
  std::size_t index = 0;
  PointBatch batch;
  // A ball around the points, scan frame.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double radius_m = 0.0;

  SceneCloud() { batch.points = &points; }
  SceneCloud(const SceneCloud&) = delete;
  SceneCloud& operator=(const SceneCloud&) = delete;
  void encircle();
  const Pose& pose(int side = 0) const { return batch.world_from_scan[static_cast<std::size_t>(side)]; }
  Eigen::Vector3d at(std::size_t i, int side = 0) const {
    return pose(side) * Eigen::Vector3d(points.xyz[3 * i], points.xyz[3 * i + 1], points.xyz[3 * i + 2]);
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
  unsigned long on_current = 0;  // observes the window

  SnapshotPtr snapshot;
  Stage stage = Stage::Odometry;
  SceneSettings settings;
  SceneColours colours;
  double pixel_ratio = 1.0;
  bool moving = false;
  bool reads_itself = true;
  std::size_t budget = kMovingPoints;
  std::uint64_t content = 0;  // counts what the pictures of the points depend on
  std::function<bool(ScanId)> is_visible;
  std::array<ScanResiduals, 2> residuals;
  std::vector<std::unique_ptr<SceneCloud>> clouds;  // in the survey's order; none for scans without points
  std::array<std::vector<Pose>, 2> stops;           // by side: as shown, and what it is compared with
  ColourRange range;
  double grid_m = 0.0;
  vtkNew<PointLayer> layer;

  SceneCompare compare = SceneCompare::Off;
  Stage before = Stage::Odometry;
  double divider = 0.5;
  bool shows_before = false;  // blinking
  std::optional<PointBox> slice;
  std::vector<Eigen::Vector3d> measured;
  SceneRoles roles;
  std::map<ScanId, Pose> ghosts;
  std::map<Stage, std::string> stage_words;

  std::array<SceneLines, 2> paths;
  SceneLines grid, hovered, picked, box, measure;
  std::vector<Eigen::Vector3d> extra_extent;  // eight corners, or none
  std::optional<CellPlace> hovered_cell, picked_cell;
  std::vector<std::pair<std::size_t, vtkSmartPointer<vtkBillboardTextActor3D>>> numbers;  // stop, its number
  double number_height_m = 0.0;

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
  double middleLightness() const { return lightGround() ? 0.74 : 0.86; }
  Rgb inkOf(const SceneCloud& cloud) const {
    const Rgb colour = snapshot && cloud.index < snapshot->scans().size()
                           ? scanColour(snapshot->scans()[cloud.index], cloud.index)
                           : scanColour(cloud.index);
    const Rgb ink = lightGround() ? mixed(colour, {0, 0, 0}, 0.25) : colour;
    return isPale(cloud.points.scan) ? mixed(ink, colours.no_data, 0.8) : ink;
  }
  bool isPale(ScanId scan) const {
    const auto role = roles.of.find(scan);
    return role != roles.of.end() && role->second == RelaxationRole::Waiting;
  }

  SceneCloud* cloudOf(ScanId scan) const {
    for (const auto& cloud : clouds)
      if (cloud->points.scan == scan) return cloud.get();
    return nullptr;
  }
  // Which side's poses a place of the picture shows.
  int sideAt(double pixel_x) const {
    if (compare == SceneCompare::Wipe) return pixel_x < divider * size().x() ? 1 : 0;
    return compare == SceneCompare::Blink && shows_before ? 1 : 0;
  }
  bool wantsNormals() const { return settings.colouring == SceneColouring::Normal; }
  PointsWanted wanted(std::size_t index) const {
    return {snapshot->scans()[index], settings.reduced, wantsNormals()};
  }
  bool has(std::size_t index) const;  // its points as they are wanted
  std::vector<std::string> readMissing();
  void takeIn(std::vector<ScanPoints> points);
  void showClouds();
  std::vector<Eigen::Vector3d> extentPoints(const std::vector<ScanId>& scans, const PointBox* within) const;
  void colourAll();
  void colour(SceneCloud& cloud, int side, const std::vector<float>& values);
  std::vector<float> valuesOf(const SceneCloud& cloud, int side, std::optional<double> first_time_s) const;
  void placeClouds();
  void placeBox();
  std::optional<Eigen::Vector3d> pointOf(const CellPlace& cell, int side) const;
  std::vector<Eigen::Vector3d> handles() const;
  void lookAtPoints();
  void writeOver(OverlayContents& contents, const Scene& scene) const;
  void writeRoles(OverlayContents& contents, const Scene& scene) const;
  std::string wordsOf(Stage stage) const;
  void placeLines();
  void placeNumbers(double length_m);
  void thinNumbers(const Scene& scene);
  void showActors();
  void applyCamera();
  void fitNow();
  void mark(SceneLines& lines, const std::optional<CellPlace>& cell, Rgb colour);
  Eigen::Matrix4d clipFromWorld() const;
};

}  // namespace tiltmap::ui
