#include "ui/scene/registration_layer.h"

#include <cmath>
#include <vtkBillboardTextActor3D.h>
#include <vtkCellData.h>
#include <vtkTextProperty.h>

#include "ui/scene/registration_shapes.h"
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

RegistrationColours RegistrationColours::of(bool dark) {
  RegistrationColours c;
  if (dark) {
    c.fixed = {158, 170, 180};
    c.moving = {255, 168, 60};
    c.ghost = {120, 220, 255};
    c.picked = {255, 110, 220};
    c.tree = {96, 112, 124};
    c.visited = {250, 230, 120};
    c.fate = {Rgb{64, 220, 160},  Rgb{140, 150, 158}, Rgb{140, 150, 158},
              Rgb{255, 120, 100}, Rgb{190, 150, 255}, Rgb{245, 225, 90}};
    c.ground = {30, 35, 39};
  } else {
    c.fixed = {110, 120, 128};
    c.moving = {205, 105, 0};
    c.ghost = {0, 110, 170};
    c.picked = {190, 0, 140};
    c.tree = {150, 160, 168};
    c.visited = {150, 110, 0};
    c.fate = {Rgb{0, 130, 84},  Rgb{110, 118, 124}, Rgb{110, 118, 124},
              Rgb{200, 40, 24}, Rgb{112, 60, 200},  Rgb{150, 112, 0}};
    c.ground = {240, 243, 245};
  }
  return c;
}

std::vector<std::pair<double, double>> fateDashes(RejectReason reason) {
  switch (reason) {
    case RejectReason::None:
      return {{0.0, 1.0}};
    case RejectReason::TooFar:
      return {{0.0, 0.24}, {0.38, 0.62}, {0.76, 1.0}};
    case RejectReason::NormalDisagrees:
      return {{0.0, 0.08}, {0.184, 0.264}, {0.368, 0.448}, {0.552, 0.632}, {0.736, 0.816}, {0.92, 1.0}};
    case RejectReason::Statistics:
      return {{0.0, 0.38}, {0.46, 0.54}, {0.62, 1.0}};
    case RejectReason::NoNormal:
      return {{0.0, 0.3}, {0.7, 1.0}};
    case RejectReason::NoPartner:
      return {};
  }
  return {};
}

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
  std::vector<std::pair<Vector3d, int>> fixed_marks, moving_marks;
  bool gizmo_shown = false;
  GizmoHandle active = GizmoHandle::None;

  explicit Parts(Scene& in) : scene(in) {}

  std::vector<PointDrawing*> clouds() { return {&fixed, &moving, &ghost}; }
  std::vector<LineDrawing*> drawings() {
    return {&lines, &patches, &picked, &tree, &visited, &gizmo, &marks};
  }

  void repaint() {
    paint(*fixed.actor, colours.fixed);
    paint(*moving.actor, colours.moving);
    paint(*ghost.actor, colours.ghost);
    for (PointDrawing* cloud : clouds())
      cloud->actor->GetProperty()->SetPointSize(static_cast<float>(point_px * pixel_ratio));
    fixed.actor->SetVisibility(points_shown && !fixed_xyz.empty());
    moving.actor->SetVisibility(points_shown && !moving_xyz.empty());
    ghost.actor->SetVisibility(ghost_pose.has_value() && !moving_xyz.empty());
    // A ghost shines through.
    ghost.actor->GetProperty()->SetOpacity(0.55);
    drawPairs();
    drawPicked();
    drawMarks();
    drawGizmo();
  }
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

void RegistrationLayer::Parts::drawPairs() {
  LineShape shape, outlines;
  lines_drawn = 0;
  for (const TracedPair& pair : pairs) {
    if (!shows(pair)) continue;
    const Rgb ink = inkOf(pair);
    const Vector3d from = pose * pair.moving_point;
    if (pair.pair.reason == RejectReason::NoPartner) {
      shape.addDot(pair.pair.from_fixed ? pair.fixed_point : from, ink);
    } else {
      for (const auto& [begin, end] : fateDashes(pair.pair.reason))
        shape.add(from + begin * (pair.fixed_point - from), from + end * (pair.fixed_point - from), ink);
      // Ends that lie on one another are still to be seen.
      shape.addDot(from, ink);
    }
    ++lines_drawn;
    if (!patches_shown || !attempt || !attempt->moving->elements.arePatches()) continue;
    const bool moves = !pair.pair.from_fixed;
    if (moves)
      addPatch(outlines, attempt->moving->elements, pair.pair.moving, pose, ink);
    else
      addPatch(outlines, attempt->fixed->elements, pair.pair.fixed, Pose(), ink);
  }
  lines.set(shape, 1.5 * pixel_ratio, 4.0 * pixel_ratio);
  patches.set(outlines, 1.0 * pixel_ratio, 1.0);
}

void RegistrationLayer::Parts::drawPicked() {
  LineShape shape;
  if (picked_pair) {
    const TracedPair& pair = pairs[*picked_pair];
    const bool partner = pair.pair.reason != RejectReason::NoPartner;
    const Vector3d moving_end = pose * pair.moving_point;
    if (partner) shape.add(moving_end, pair.fixed_point, colours.picked);
    if (partner || !pair.pair.from_fixed) shape.addDot(moving_end, colours.picked);
    if (partner || pair.pair.from_fixed) shape.addDot(pair.fixed_point, colours.picked);
    if (attempt && attempt->moving->elements.arePatches()) {
      if (partner || !pair.pair.from_fixed)
        addPatch(shape, attempt->moving->elements, pair.pair.moving, pose, colours.picked);
      if (partner || pair.pair.from_fixed)
        addPatch(shape, attempt->fixed->elements, pair.pair.fixed, Pose(), colours.picked);
    }
  }
  picked.set(shape, 3.0 * pixel_ratio, 10.0 * pixel_ratio);
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

void RegistrationLayer::Parts::drawMarks() {
  for (auto& number : numbers) scene.renderer().RemoveViewProp(number);
  numbers.clear();
  LineShape shape;
  const auto mark = [&](const Vector3d& at, int number, const char* side, Rgb ink) {
    shape.addDot(at, ink);
    auto text = vtkSmartPointer<vtkBillboardTextActor3D>::New();
    text->SetInput((std::to_string(number) + " " + side).c_str());
    Vector3d place = at;
    text->SetPosition(place.data());
    text->SetDisplayOffset(static_cast<int>(8 * pixel_ratio), static_cast<int>(6 * pixel_ratio));
    vtkTextProperty& style = *text->GetTextProperty();
    style.SetFontFamilyToArial();
    style.BoldOn();
    style.SetFontSize(static_cast<int>(std::lround(13 * pixel_ratio)));
    style.SetColor(ink.r / 255.0, ink.g / 255.0, ink.b / 255.0);
    style.SetBackgroundColor(colours.ground.r / 255.0, colours.ground.g / 255.0, colours.ground.b / 255.0);
    style.SetBackgroundOpacity(0.7);
    scene.renderer().AddViewProp(text);
    numbers.push_back(text);
  };
  for (const auto& [at, number] : fixed_marks) mark(at, number, "fixed", colours.fixed);
  for (const auto& [at, number] : moving_marks) mark(pose * at, number, "moving", colours.moving);
  marks.set(shape, 2.0 * pixel_ratio, 11.0 * pixel_ratio);
}

std::size_t RegistrationLayer::linesDrawn() const {
  return parts_->lines_drawn;
}

// The gizmo keeps its size on the screen.
double RegistrationLayer::Parts::gizmoLength() const {
  const double px = 84.0 * pixel_ratio;
  const Vector3d at = pose.translation();
  double widest = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    widest = std::max(widest, (scene.pixelOf(at + Vector3d::Unit(axis)) - scene.pixelOf(at)).norm());
  return widest > 1e-6 ? px / widest : 1.0;
}

void RegistrationLayer::Parts::drawGizmo() {
  LineShape shape;
  if (gizmo_shown) addGizmo(shape, pose, gizmoLength(), active, colours);
  gizmo.set(shape, 3.0 * pixel_ratio, 12.0 * pixel_ratio);
}

void RegistrationLayer::setGizmo(bool shown, GizmoHandle active) {
  parts_->gizmo_shown = shown;
  parts_->active = active;
  parts_->drawGizmo();
}

Vector2d RegistrationLayer::handlePixel(GizmoHandle handle) const {
  const Parts& p = *parts_;
  return p.scene.pixelOf(gizmoPlace(handle, p.pose, p.gizmoLength()));
}

GizmoHandle RegistrationLayer::gizmoAt(const Vector2d& pixel) const {
  const Parts& p = *parts_;
  if (!p.gizmo_shown) return GizmoHandle::None;
  GizmoHandle best = GizmoHandle::None;
  double nearest = 12.0 * p.pixel_ratio;
  const double length = p.gizmoLength();
  const auto offer = [&](GizmoHandle handle, const Vector3d& place) {
    const double away = (p.scene.pixelOf(place) - pixel).norm();
    if (away < nearest) nearest = away, best = handle;
  };
  for (const GizmoHandle handle : {GizmoHandle::X, GizmoHandle::Y, GizmoHandle::Z, GizmoHandle::Plane})
    offer(handle, gizmoPlace(handle, p.pose, length));
  for (const Vector3d& place : ringPlaces(p.pose, length)) offer(GizmoHandle::Turn, place);
  return best;
}

RegistrationLayer::Drag RegistrationLayer::dragged(GizmoHandle handle, const Vector2d& from,
                                                   const Vector2d& to) const {
  const Parts& p = *parts_;
  const auto pixels = [&p](const Vector3d& world) { return p.scene.pixelOf(world); };
  return dragOf(handle, p.pose.translation(), from, to, pixels);
}

std::optional<std::size_t> RegistrationLayer::pickPair(const Vector2d& pixel, double radius_px) const {
  const Parts& p = *parts_;
  std::optional<std::size_t> best;
  double nearest = radius_px;
  for (std::size_t i = 0; i < p.pairs.size(); ++i) {
    const TracedPair& pair = p.pairs[i];
    if (!p.shows(pair)) continue;
    Vector2d a = p.scene.pixelOf(p.pose * pair.moving_point), b = p.scene.pixelOf(pair.fixed_point);
    if (pair.pair.reason == RejectReason::NoPartner)
      (pair.pair.from_fixed ? a : b) = pair.pair.from_fixed ? b : a;
    if (!a.allFinite() || !b.allFinite()) continue;
    const double square = (b - a).squaredNorm();
    const double along = square > 0.0 ? std::clamp((pixel - a).dot(b - a) / square, 0.0, 1.0) : 0.0;
    const double away = (a + along * (b - a) - pixel).norm();
    if (away < nearest) nearest = away, best = i;
  }
  return best;
}

std::optional<Vector3d> RegistrationLayer::pickPoint(bool of_fixed, const Vector2d& pixel,
                                                     double radius_px) const {
  const Parts& p = *parts_;
  const std::vector<float>& xyz = of_fixed ? p.fixed_xyz : p.moving_xyz;
  const Pose pose = of_fixed ? Pose() : p.pose;
  std::optional<Vector3d> best;
  double nearest = radius_px;
  for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) {
    const Vector3d own(xyz[i], xyz[i + 1], xyz[i + 2]);
    const double away = (p.scene.pixelOf(pose * own) - pixel).norm();
    if (away < nearest) nearest = away, best = own;
  }
  return best;
}

}  // namespace tiltmap::ui
