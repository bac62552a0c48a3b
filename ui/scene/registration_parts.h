// What the drawing of a registration is made of. For its own files only.
#pragma once

#include <vtkBillboardTextActor3D.h>

#include "ui/scene/registration_shapes.h"
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

struct RegistrationLayer::Parts {
  Scene& scene;
  RegistrationColours colours = RegistrationColours::of(true);
  double pixel_ratio = 1.0, point_px = 2.0;
  std::vector<float> fixed_xyz, moving_xyz;
  PointDrawing fixed, moving, ghost;
  LineDrawing lines, patches, picked, tree, visited, gizmo, marks;
  std::vector<vtkSmartPointer<vtkBillboardTextActor3D>> numbers;
  Pose pose;
  std::optional<Pose> ghost_pose;
  bool points_shown = true;

  const TraceAttempt* attempt = nullptr;
  std::vector<TracedPair> pairs;
  std::set<RejectReason> fates;
  bool patches_shown = false;
  std::optional<std::size_t> picked_pair;
  std::size_t lines_drawn = 0;
  std::vector<std::pair<Eigen::Vector3d, int>> fixed_marks, moving_marks;
  bool gizmo_shown = false;
  GizmoHandle active = GizmoHandle::None;

  explicit Parts(Scene& in) : scene(in) {}

  std::vector<PointDrawing*> clouds() { return {&fixed, &moving, &ghost}; }
  std::vector<LineDrawing*> drawings() {
    return {&lines, &patches, &picked, &tree, &visited, &gizmo, &marks};
  }

  void repaint();
  bool shows(const TracedPair& pair) const { return fates.contains(pair.pair.reason); }
  Rgb inkOf(const TracedPair& pair) const {
    const Rgb ink = colours.fate[static_cast<std::size_t>(pair.pair.reason)];
    return pair.pair.kept() ? mixed(ink, colours.ground, 0.8 * (1.0 - pair.weight)) : ink;
  }
  void drawPairs();
  void drawPicked();
  void drawMarks();
  void drawGizmo();
  double gizmoLength() const;
};

}  // namespace tiltmap::ui
