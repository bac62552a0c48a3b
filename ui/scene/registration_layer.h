// Two scans on their way together: points in two colours, pairs by fate, patches, a ghost of where
// registering would end, the kD-tree's cells and a gizmo. Drawn in the fixed scan's frame.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/registration/registration_trace.h"
#include "core/scan/kd_tree_view.h"
#include "ui/scene/scene.h"

namespace tiltmap::ui {

// sRGB. Never the only sign: scans are named, fates have dashes of their own.
struct RegistrationColours {
  Rgb fixed, moving, ghost, picked, tree, visited;
  std::array<Rgb, kRejectReasons> fate;
  Rgb ground;  // what a pair without weight fades into
  static RegistrationColours of(bool dark);
};

// The dashes of a pair's line, from 0 (moving) to 1 (fixed); none for pairs that have no partner to draw to.
std::vector<std::pair<double, double>> fateDashes(RejectReason reason);

// The handles that a start is dragged by: arrows along the fixed scan's axes, a square in the ground plane
// and a ring about the moving scan's vertical.
enum class GizmoHandle { None, X, Y, Z, Plane, Turn };

class RegistrationLayer {
 public:
  explicit RegistrationLayer(Scene& scene);
  ~RegistrationLayer();
  RegistrationLayer(const RegistrationLayer&) = delete;
  RegistrationLayer& operator=(const RegistrationLayer&) = delete;

  void setColours(const RegistrationColours& colours);
  void setPixelRatio(double device_px_per_logical_px);
  void setPointSize(double logical_px);
  // Three floats a point, each in its own scan's frame, metres. Frames the camera anew.
  void setScans(std::vector<float> fixed_xyz, std::vector<float> moving_xyz, const Pose& fixed_from_moving);
  void clear();
  void place(const Pose& fixed_from_moving);
  void setPointsShown(bool shown);
  void setGhost(const std::optional<Pose>& fixed_from_moving);

  // The pairs of one step; the moving ends lie where place() put the scan. Only the fates named are drawn.
  void setPairs(const TraceAttempt* attempt, std::vector<TracedPair> pairs,
                const std::set<RejectReason>& shown, bool patches);
  void setPicked(std::optional<std::size_t> pair);
  // The cells (fixed frame), those looked into and the query; nothing takes them away.
  void setTree(const std::vector<KdCell>& cells, const std::optional<KdVisit>& visit,
               const Eigen::Vector3d& query);
  // Points picked for a start, by number; fixed ones in the fixed, moving ones in the moving scan's frame.
  void setMarks(const std::vector<std::pair<Eigen::Vector3d, int>>& fixed,
                const std::vector<std::pair<Eigen::Vector3d, int>>& moving);

  void setGizmo(bool shown, GizmoHandle active = GizmoHandle::None);
  GizmoHandle gizmoAt(const Eigen::Vector2d& pixel) const;
  // How a drag of a handle moves the scan: shift along the fixed axes, and turn (radians, left positive).
  struct Drag {
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    double turn_rad = 0.0;
  };
  Drag dragged(GizmoHandle handle, const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px) const;
  // Where a handle is drawn, for tests and hints.
  Eigen::Vector2d handlePixel(GizmoHandle handle) const;

  // The pair whose drawn line passes nearest to the pixel, within radius_px.
  std::optional<std::size_t> pickPair(const Eigen::Vector2d& pixel, double radius_px) const;
  // The nearest drawn point of one of the two scans, in that scan's own frame.
  std::optional<Eigen::Vector3d> pickPoint(bool of_fixed, const Eigen::Vector2d& pixel,
                                           double radius_px) const;
  std::size_t linesDrawn() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tiltmap::ui
