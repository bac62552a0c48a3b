// Pairs by fate, the picked one, marks and gizmo as lines, in their colours.
#include <vtkTextProperty.h>

#include "ui/scene/registration_parts.h"

namespace tiltmap::ui {

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

void RegistrationLayer::Parts::repaint() {
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

}  // namespace tiltmap::ui
