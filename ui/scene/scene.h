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
#include "ui/models/selection.h"
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
  static SceneColours dark() { return {}; }
  static SceneColours white() {
    return {{255, 255, 255}, {255, 255, 255}, {28, 34, 39}, {190, 198, 204}, {150, 155, 160}};
  }
  bool operator==(const SceneColours&) const = default;
};

struct SceneSettings {
  SceneColouring colouring = SceneColouring::Scan;
  double point_px = 2.0;  // logical pixels
  bool reduced = false;
  bool path = true;
  bool grid = true;
  bool axes = true;
  bool operator==(const SceneSettings&) const = default;
};

// How many points are drawn while the camera moves.
inline constexpr std::size_t kMovingPoints = 52000;

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

  // What is drawn. Scans that did not change keep their points. Returned: what could not be read.
  std::vector<std::string> show(const SnapshotPtr& snapshot, Stage stage);
  std::vector<std::string> setSettings(const SceneSettings& settings);
  const SceneSettings& settings() const;
  void setColours(const SceneColours& colours);
  void setVisible(const std::function<bool(ScanId)>& visible);
  void setPixelRatio(double device_px_per_logical_px);

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
  // Few points while something moves.
  void setMoving(bool moving);
  std::size_t pointsDrawn() const;

  // The beam whose point is drawn nearest to the pixel, within radius_px; of several that overlap the
  // nearest to the camera.
  std::optional<CellPlace> pick(const Eigen::Vector2d& pixel, double radius_px) const;
  std::optional<Eigen::Vector3d> worldPoint(const CellPlace& cell) const;
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
