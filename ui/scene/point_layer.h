// The points of all scans, drawn by OpenGL itself: few at once while the camera moves, all of them little by
// little when it rests. For the scene's own files only.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>
#include <vtkProp.h>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "core/products/colour.h"
#include "ui/scene/point_box.h"

class vtkActor;
class vtkOpenGLRenderWindow;
class vtkRenderer;

namespace tiltmap::ui {

struct ScanPoints;

// One scan. The points are in an order of which every beginning is spread evenly (see scanPointsOf).
struct PointBatch {
  static std::uint64_t nextId();
  std::uint64_t id = nextId();  // addresses come again
  const ScanPoints* points = nullptr;
  bool visible = true;
  Rgb ink;  // where there are no colours
  // Side 0 is what the view shows, side 1 what it is compared with.
  std::array<Pose, 2> world_from_scan;
  std::array<std::vector<Rgb>, 2> colours;  // one a point, or none; side 1 without any takes those of side 0
  std::uint64_t colours_changed = 0;        // counts
};

struct PointLook {
  Eigen::Matrix4d clip_from_world = Eigen::Matrix4d::Identity();
  double point_px = 2.0;  // device pixels
  std::optional<PointBox> box;
  std::uint64_t content = 0;  // counts: visibility, inks, poses
  bool operator==(const PointLook&) const = default;
};

// How the pictures of both sides make one.
struct PointMix {
  bool only_before = false;
  std::optional<double> divider;  // share of the width: side 1 left of it, side 0 right
  bool shaded = false;            // by depth
  double shade_radius_px = 1.0;
  // For the depth of a pixel in metres.
  double near_m = 0.1, far_m = 100.0;
  bool orthographic = false;
};

// The pictures of the points are kept, with their depth, until something about them changes: marks that move
// over them cost no drawing of points. Uses whatever OpenGL context its window has current.
class PointLayer : public vtkProp {
 public:
  static PointLayer* New();
  vtkTypeMacro(PointLayer, vtkProp);

  void setBatches(std::vector<PointBatch*> batches);
  void setLook(const PointLook& look) { look_ = look; }
  void setMix(const PointMix& mix) { mix_ = mix; }
  // Drawn over the points of one side only: the path at its stage.
  void setSideActors(std::array<vtkActor*, 2> actors) { side_actors_ = actors; }
  // While moving, no more than `budget` points are drawn; else those that are still missing are added, all in
  // one go, or, gradually, as many as fit into a moment each time.
  void setMoving(bool moving) { moving_ = moving; }
  void setGradual(bool gradual) { gradual_ = gradual; }
  void setBudget(std::size_t points) { budget_ = points; }

  // Nothing is missing in the last picture.
  bool isComplete() const;
  // What a picture shows while moving, by batch: beginnings of them, together about the budget within what
  // the camera sees.
  std::vector<std::size_t> fewOf(int side) const;
  std::size_t drawn(int side) const;  // in the last picture

  int RenderOpaqueGeometry(vtkViewport* viewport) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;
  double* GetBounds() override { return nullptr; }

 protected:
  PointLayer();
  ~PointLayer() override;

 private:
  struct Graphics;
  struct Picture;
  bool shows(int side) const;
  void drawSide(int side, vtkOpenGLRenderWindow& window, const Eigen::Vector2i& size);
  // Nothing but points, and those only for this frame.
  bool passes() const { return moving_ && !mix_.shaded && !mix_.divider; }
  bool beginPoints(vtkOpenGLRenderWindow& window, const Eigen::Vector2i& size);
  static void endPoints();
  void drawPassing(int side, vtkOpenGLRenderWindow& window, const Eigen::Vector2i& size);
  std::vector<std::size_t> nextEnds(const Picture& picture) const;
  void drawRange(const PointBatch& batch, int side, std::size_t from, std::size_t to);
  void compose(vtkOpenGLRenderWindow& window);
  void drawSideActors(vtkRenderer& renderer, const Eigen::Vector2i& size);

  std::vector<PointBatch*> batches_;
  PointLook look_;
  PointMix mix_;
  std::array<vtkActor*, 2> side_actors_{};
  bool moving_ = false, gradual_ = false;
  std::size_t budget_ = 0;
  std::unique_ptr<Graphics> graphics_;
};

}  // namespace tiltmap::ui
