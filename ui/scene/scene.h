// The scans of a project in 3D, in the world frame: points, path, ground grid, marks, camera. No widgets: the
// 3D panel, `tiltmap screenshot` and tests draw the same scene.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/products/colour.h"
#include "core/project/project_snapshot.h"
#include "ui/models/scan_display.h"
#include "ui/models/selection.h"
#include "ui/scene/point_box.h"
#include "ui/scene/scan_points.h"

class vtkRenderer;
class vtkRenderWindow;

namespace tiltmap::ui {

enum class SceneView { Top, Bottom, Front, Back, Left, Right, Iso, IsoBack };
Result<SceneView> parseSceneView(const std::string& name);  // "top", "front", "side", "iso"

// sRGB.
struct SceneColours {
  Rgb top{45, 51, 57}, bottom{20, 23, 26};
  Rgb text{221, 227, 231}, grid{75, 84, 92};
  Rgb no_data{110, 116, 122};
  Rgb active{122, 201, 118}, queued{53, 178, 196}, aligning{240, 180, 60};  // sets of a relaxation
  static SceneColours dark() { return {}; }
  static SceneColours white() {
    return {{255, 255, 255}, {255, 255, 255}, {28, 34, 39}, {190, 198, 204}, {150, 155, 160}};
  }
  bool operator==(const SceneColours&) const = default;
};

enum class SceneCompare { Off, Wipe, Blink };

// One a cell of the scan's matrix; NaN: none.
using ScanResiduals = std::map<ScanId, std::shared_ptr<const std::vector<float>>>;

struct SceneSettings {
  SceneColouring colouring = SceneColouring::Scan;
  double point_px = 2.0;  // logical pixels
  bool reduced = false;
  bool path = true;
  bool grid = true;
  bool axes = true;
  bool shaded = false;  // by depth: edges and hollows stand out
  bool operator==(const SceneSettings&) const = default;
};

// What a relaxation that runs makes of the stops, marked as on the site map: square where it never moves,
// hollow in the static set, ringed in the queue, with two rings while it is aligned.
struct SceneRoles {
  std::map<ScanId, RelaxationRole> of;
  std::vector<ScanId> onto;  // what the scan being aligned is registered onto: lines to it
  std::vector<std::pair<RelaxationRole, std::string>> legend;  // in words, from the top down
  bool operator==(const SceneRoles&) const = default;
};

// At least so many points are drawn while the camera moves, if there are as many.
inline constexpr std::size_t kMovingPoints = 52000;

// Where a box that cuts out a part of the scene can be taken hold of: the middle of a side.
struct SliceHandle {
  int axis = 0;
  bool high = false;
  bool operator==(const SliceHandle&) const = default;
};

// On one thread, that of the window it draws in.
class Scene {
 public:
  Scene();
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // Adds its layers to a window; they stay until the scene goes.
  void attach(vtkRenderWindow& window);
  void detach();
  vtkRenderer& renderer();

  // What is drawn. Scans that did not change keep their points. Returned: what could not be read. A scene
  // whose points come later (setReadsItself) draws those that it has; missing() tells what to give() it.
  std::vector<std::string> show(const SnapshotPtr& snapshot, Stage stage);
  std::vector<std::string> setSettings(const SceneSettings& settings);
  const SceneSettings& settings() const;
  void setReadsItself(bool itself);
  // Until a scan's new points are given, it is drawn with those that it had.
  std::vector<PointsWanted> missing() const;
  void give(std::vector<ScanPoints> points);
  void setColours(const SceneColours& colours);
  void setVisible(const std::function<bool(ScanId)>& visible);
  void setPixelRatio(double device_px_per_logical_px);
  double pixelRatio() const;
  // What the colouring Residual shows, for the stage and for the one it is compared with.
  void setResiduals(const ScanResiduals& now, const ScanResiduals& before = {});

  // The same scans as another stage places them: left of a divider, or in turn (setShowsBefore).
  void setCompare(SceneCompare how, Stage before);
  SceneCompare compare() const;
  Stage before() const;
  void setDivider(double share);  // of the width, 0 to 1
  double divider() const;
  void setShowsBefore(bool before);
  bool showsBefore() const;

  // Over the points; scans of the static set are drawn pale. Empty: none.
  void setRoles(SceneRoles roles);
  // Where stops would be without some links: rings tied to where they are.
  void setGhosts(std::map<ScanId, Pose> world_from_scan);
  // How a comparison names a stage, where not by its own name.
  void setStageWords(std::map<Stage, std::string> words);

  // Only points within are drawn, picked and framed. World frame, upright.
  void setSlice(const std::optional<PointBox>& box);
  const std::optional<PointBox>& slice() const;
  // Around most of the visible points; nothing where there are none.
  std::optional<PointBox> extent() const;
  double scannerHeight() const;  // median over the stops, world frame
  std::optional<SliceHandle> sliceHandleAt(const Eigen::Vector2d& pixel, double radius_px) const;
  std::optional<Eigen::Vector2d> pixelOf(const SliceHandle& handle) const;
  // Moves a side of the box with the pointer; sides never pass one another.
  void dragSlice(const SliceHandle& handle, const Eigen::Vector2d& by_px);

  // None, one or two places in the world; between two a line with its length.
  void setMeasured(const std::vector<Eigen::Vector3d>& places);
  const std::vector<Eigen::Vector3d>& measured() const;

  // Corners of what others draw in this scene: framed and gridded where no scan is shown.
  void setExtent(std::vector<Eigen::Vector3d> corners);

  // Camera. World frame: x right, y forward, z up; "front" looks along +y, "right" from +x.
  void setView(SceneView view);                  // of everything that is visible
  void frame(const std::vector<ScanId>& scans);  // the same direction, closer; empty: everything
  void setOrthographic(bool orthographic);
  bool isOrthographic() const;
  // Display pixels, origin at the lower left, as OpenGL has it.
  void setPivot(const Eigen::Vector2d& pixel);  // the point there, or what the camera looks at
  void turn(const Eigen::Vector2d& by_px);      // about the pivot, keeping z upright
  void pan(const Eigen::Vector2d& by_px);       // the pivot stays under the pointer
  void zoom(double factor);                     // above 1: closer to the pivot
  Eigen::Vector2d pixelOf(const Eigen::Vector3d& world) const;
  double metresPerPixel() const;  // at what the camera looks at
  // Few points while something moves, spread evenly over what is seen; never less than kMovingPoints.
  void setMoving(bool moving);
  bool isMoving() const;
  void setMovingPoints(std::size_t points);
  // How many the picture will have at last, or while moving has.
  std::size_t pointsDrawn() const;
  // Gradually: every render adds as many points as fit into some 40 ms, until isRefined(). Else all at once.
  void setGradual(bool gradual);
  bool isRefined() const;
  // World frame; what the picture shows while moving. For tests and measurements.
  std::vector<Eigen::Vector3d> movingPoints() const;

  // The beam whose point is drawn nearest to the pixel, within radius_px; of several that overlap the
  // nearest to the camera.
  std::optional<CellPlace> pick(const Eigen::Vector2d& pixel, double radius_px) const;
  std::optional<Eigen::Vector3d> worldPoint(const CellPlace& cell) const;
  // The same where this pixel shows it: in a comparison the stages place it differently.
  std::optional<Eigen::Vector3d> shownPoint(const CellPlace& cell, const Eigen::Vector2d& pixel) const;
  // A line from the scanner to the point, and a ring around it; nothing takes it away.
  void markHovered(const std::optional<CellPlace>& cell);
  void markPicked(const std::optional<CellPlace>& cell);

  // Before drawing: clipping planes, triad, scale bar, colour bar.
  void prepare();
  void render();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tiltmap::ui
