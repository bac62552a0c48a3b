#include "ui/scene/registration_layer.h"

#include "ui/scene/registration_parts.h"

namespace tiltmap::ui {

using Eigen::Vector3d;

namespace {

void setPlace(vtkActor& actor, const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = pose.matrix();
  vtkNew<vtkMatrix4x4> placed;
  placed->DeepCopy(matrix.data());
  actor.SetUserMatrix(placed);
}

// Eight corners of a box around most of the points, as the camera frames them.
void addMost(const std::vector<float>& xyz, const Pose& pose, std::array<std::vector<double>, 3>& along) {
  for (const std::uint32_t i : evenlyStrided(xyz.size() / 3, 3000)) {
    const Vector3d p = pose * Vector3d(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis].push_back(p[static_cast<int>(axis)]);
  }
}

std::vector<Vector3d> cornersOf(std::array<std::vector<double>, 3> along) {
  if (along[0].empty()) return {};
  Vector3d low, high;
  for (int axis = 0; axis < 3; ++axis) {
    auto& values = along[static_cast<std::size_t>(axis)];
    std::sort(values.begin(), values.end());
    const std::size_t cut = values.size() / 50;
    low[axis] = values[cut];
    high[axis] = values[values.size() - 1 - cut];
  }
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.emplace_back((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
  return corners;
}

}  // namespace

RegistrationLayer::RegistrationLayer(Scene& scene) : parts_(std::make_unique<Parts>(scene)) {
  for (PointDrawing* cloud : parts_->clouds()) scene.renderer().AddActor(cloud->actor);
  for (LineDrawing* drawing : parts_->drawings()) scene.renderer().AddActor(drawing->actor);
  parts_->repaint();
}

RegistrationLayer::~RegistrationLayer() {
  vtkRenderer& renderer = parts_->scene.renderer();
  for (PointDrawing* cloud : parts_->clouds()) renderer.RemoveActor(cloud->actor);
  for (LineDrawing* drawing : parts_->drawings()) renderer.RemoveActor(drawing->actor);
  for (auto& number : parts_->numbers) renderer.RemoveViewProp(number);
}

void RegistrationLayer::setColours(const RegistrationColours& colours) {
  parts_->colours = colours;
  parts_->repaint();
}

void RegistrationLayer::setPixelRatio(double ratio) {
  if (ratio == parts_->pixel_ratio) return;
  parts_->pixel_ratio = ratio;
  parts_->repaint();
}

void RegistrationLayer::setPointSize(double logical_px) {
  parts_->point_px = logical_px;
  parts_->repaint();
}

void RegistrationLayer::setScans(std::vector<float> fixed_xyz, std::vector<float> moving_xyz,
                                 const Pose& fixed_from_moving) {
  Parts& p = *parts_;
  p.fixed_xyz = std::move(fixed_xyz);
  p.moving_xyz = std::move(moving_xyz);
  p.fixed.setPoints(p.fixed_xyz, true);
  p.moving.setPoints(p.moving_xyz, true);
  p.ghost.setPoints(p.moving_xyz, true);
  std::array<std::vector<double>, 3> along;
  addMost(p.fixed_xyz, Pose(), along);
  addMost(p.moving_xyz, fixed_from_moving, along);
  p.scene.setExtent(cornersOf(std::move(along)));
  setPairs(nullptr, {}, p.fates, p.patches_shown);
  place(fixed_from_moving);
  p.repaint();
}

void RegistrationLayer::clear() {
  setScans({}, {}, Pose());
  setGhost({});
  setTree({}, {}, Vector3d::Zero());
  setMarks({}, {});
  setGizmo(false);
}

void RegistrationLayer::place(const Pose& fixed_from_moving) {
  Parts& p = *parts_;
  p.pose = fixed_from_moving;
  setPlace(*p.moving.actor, p.pose);
  p.drawPairs();
  p.drawPicked();
  p.drawMarks();
  p.drawGizmo();
}

void RegistrationLayer::setPointsShown(bool shown) {
  parts_->points_shown = shown;
  parts_->repaint();
}

void RegistrationLayer::setGhost(const std::optional<Pose>& fixed_from_moving) {
  Parts& p = *parts_;
  p.ghost_pose = fixed_from_moving;
  if (p.ghost_pose) setPlace(*p.ghost.actor, *p.ghost_pose);
  p.ghost.actor->SetVisibility(p.ghost_pose.has_value() && !p.moving_xyz.empty());
}

void RegistrationLayer::setPairs(const TraceAttempt* attempt, std::vector<TracedPair> pairs,
                                 const std::set<RejectReason>& shown, bool patches) {
  Parts& p = *parts_;
  p.attempt = attempt;
  p.pairs = std::move(pairs);
  p.fates = shown;
  p.patches_shown = patches;
  p.picked_pair.reset();
  p.drawPairs();
  p.drawPicked();
}

void RegistrationLayer::setPicked(std::optional<std::size_t> pair) {
  if (pair && *pair >= parts_->pairs.size()) pair.reset();
  parts_->picked_pair = pair;
  parts_->drawPicked();
}

void RegistrationLayer::setTree(const std::vector<KdCell>& cells, const std::optional<KdVisit>& visit,
                                const Vector3d& query) {
  Parts& p = *parts_;
  LineShape all, looked;
  for (const KdCell& cell : cells) addBox(all, cell.low, cell.high, p.colours.tree);
  if (visit) {
    for (const KdCell& cell : visit->path)
      addBox(all, cell.low, cell.high, mixed(p.colours.tree, p.colours.visited, 0.35));
    for (std::size_t i = 0; i < visit->leaves.size(); ++i)
      addBox(looked, visit->leaves[i].low, visit->leaves[i].high,
             i == visit->holder ? p.colours.picked : p.colours.visited);
    looked.addDot(query, p.colours.picked);
  }
  p.tree.set(all, 1.0 * p.pixel_ratio, 1.0);
  p.visited.set(looked, 2.5 * p.pixel_ratio, 12.0 * p.pixel_ratio);
}

void RegistrationLayer::setMarks(const std::vector<std::pair<Vector3d, int>>& fixed,
                                 const std::vector<std::pair<Vector3d, int>>& moving) {
  parts_->fixed_marks = fixed;
  parts_->moving_marks = moving;
  parts_->drawMarks();
}

std::size_t RegistrationLayer::linesDrawn() const {
  return parts_->lines_drawn;
}

void RegistrationLayer::setGizmo(bool shown, GizmoHandle active) {
  parts_->gizmo_shown = shown;
  parts_->active = active;
  parts_->drawGizmo();
}

}  // namespace tiltmap::ui
