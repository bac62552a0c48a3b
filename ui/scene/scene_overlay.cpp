#include "ui/scene/scene_overlay.h"

#include <cmath>
#include <numbers>
#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include "core/base/text.h"
#include "core/products/top_view_marks.h"

namespace tiltmap::ui {

using Eigen::Vector2d;

namespace {

constexpr double kMargin = 16.0;
constexpr Rgb kAxisColours[] = {{235, 95, 85}, {110, 190, 95}, {90, 150, 240}};

}  // namespace

struct SceneOverlay::Shapes {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines, quads;
  vtkNew<vtkUnsignedCharArray> line_colours, quad_colours;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPolyDataMapper2D> mapper;
  vtkNew<vtkActor2D> actor;
};

SceneOverlay::SceneOverlay(vtkRenderer& renderer) : renderer_(renderer), shapes_(std::make_unique<Shapes>()) {
  shapes_->mapper->SetInputData(shapes_->data);
  shapes_->actor->SetMapper(shapes_->mapper);
  renderer_.AddViewProp(shapes_->actor);
}

SceneOverlay::~SceneOverlay() = default;

void SceneOverlay::begin() {
  shapes_->points->Reset();
  shapes_->lines->Reset();
  shapes_->quads->Reset();
  for (auto* colours : {shapes_->line_colours.Get(), shapes_->quad_colours.Get()}) {
    colours->Reset();
    colours->SetNumberOfComponents(3);
  }
  texts_used_ = 0;
}

void SceneOverlay::line(const Vector2d& from, const Vector2d& to, Rgb colour) {
  vtkIdType ids[2];
  ids[0] = shapes_->points->InsertNextPoint(from.x(), from.y(), 0.0);
  ids[1] = shapes_->points->InsertNextPoint(to.x(), to.y(), 0.0);
  shapes_->lines->InsertNextCell(2, ids);
  const unsigned char rgb[3] = {colour.r, colour.g, colour.b};
  shapes_->line_colours->InsertNextTypedTuple(rgb);
}

void SceneOverlay::box(const Vector2d& low, const Vector2d& high, Rgb colour) {
  const vtkIdType ids[4] = {shapes_->points->InsertNextPoint(low.x(), low.y(), 0.0),
                            shapes_->points->InsertNextPoint(high.x(), low.y(), 0.0),
                            shapes_->points->InsertNextPoint(high.x(), high.y(), 0.0),
                            shapes_->points->InsertNextPoint(low.x(), high.y(), 0.0)};
  shapes_->quads->InsertNextCell(4, ids);
  const unsigned char rgb[3] = {colour.r, colour.g, colour.b};
  shapes_->quad_colours->InsertNextTypedTuple(rgb);
}

void SceneOverlay::write(const std::string& text, const Vector2d& at, int anchor, Rgb colour,
                         double size_px) {
  if (texts_used_ == texts_.size()) {
    texts_.push_back(vtkSmartPointer<vtkTextActor>::New());
    texts_.back()->GetTextProperty()->SetFontFamilyToArial();
    renderer_.AddViewProp(texts_.back());
  }
  vtkTextActor& actor = *texts_[texts_used_++];
  actor.SetInput(text.c_str());
  vtkTextProperty& style = *actor.GetTextProperty();
  style.SetFontSize(static_cast<int>(std::lround(size_px)));
  style.SetColor(colour.r / 255.0, colour.g / 255.0, colour.b / 255.0);
  style.SetJustification(anchor < 0 ? VTK_TEXT_LEFT : anchor == 0 ? VTK_TEXT_CENTERED : VTK_TEXT_RIGHT);
  style.SetVerticalJustificationToCentered();
  style.SetBackgroundColor(ground_.r / 255.0, ground_.g / 255.0, ground_.b / 255.0);
  style.SetBackgroundOpacity(0.6);
  actor.SetPosition(at.x(), at.y());
  actor.SetVisibility(true);
}

void SceneOverlay::finish(double line_px) {
  // Cell data of a poly data: lines before polygons.
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  for (auto* part : {shapes_->line_colours.Get(), shapes_->quad_colours.Get()})
    for (vtkIdType i = 0; i < part->GetNumberOfTuples(); ++i)
      colours->InsertNextTypedTuple(part->GetPointer(3 * i));
  vtkNew<vtkPoints> points;
  points->DeepCopy(shapes_->points);
  vtkNew<vtkCellArray> lines, quads;
  lines->DeepCopy(shapes_->lines);
  quads->DeepCopy(shapes_->quads);
  shapes_->data->SetPoints(points);
  shapes_->data->SetLines(lines);
  shapes_->data->SetPolys(quads);
  shapes_->data->GetCellData()->SetScalars(colours);
  shapes_->data->Modified();
  shapes_->actor->GetProperty()->SetLineWidth(static_cast<float>(line_px));
  for (std::size_t i = texts_used_; i < texts_.size(); ++i) texts_[i]->SetVisibility(false);
}

void SceneOverlay::show(const OverlayContents& contents) {
  begin();
  ground_ = contents.ground;
  if (contents.width > 0 && contents.height > 0) {
    if (contents.axes) drawTriad(contents);
    if (contents.scale_m_per_px > 0.0) drawScale(contents);
    if (!contents.bar_title.empty()) drawBar(contents);
    if (!contents.grid.empty())
      write(contents.grid,
            Vector2d(contents.width - kMargin * contents.pixel_ratio,
                     (contents.scale_m_per_px > 0.0 ? 56.0 : 18.0) * contents.pixel_ratio),
            1, contents.text, 12.0 * contents.pixel_ratio);
    if (contents.divider) drawDivider(contents);
    if (!contents.corner.empty())
      write(contents.corner,
            Vector2d(contents.width - kMargin * contents.pixel_ratio,
                     contents.height - 18.0 * contents.pixel_ratio),
            1, contents.text, 13.0 * contents.pixel_ratio);
    for (const OverlayLine& tie : contents.lines) line(tie.from, tie.to, tie.colour);
    for (const OverlayMark& mark : contents.marks) drawMark(mark, contents.pixel_ratio);
    drawLegend(contents);
    drawHandles(contents);
    for (const OverlayLabel& label : contents.labels)
      write(label.text, label.pixel, 0, label.colour, 13.0 * contents.pixel_ratio);
  }
  finish(2.0 * contents.pixel_ratio);
}

// Convex.
void SceneOverlay::polygon(const std::vector<Vector2d>& corners, Rgb colour, bool full) {
  if (!full) {
    for (std::size_t k = 0; k < corners.size(); ++k)
      line(corners[k], corners[(k + 1) % corners.size()], colour);
    return;
  }
  std::vector<vtkIdType> ids;
  for (const Vector2d& corner : corners)
    ids.push_back(shapes_->points->InsertNextPoint(corner.x(), corner.y(), 0.0));
  shapes_->quads->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  const unsigned char rgb[3] = {colour.r, colour.g, colour.b};
  shapes_->quad_colours->InsertNextTypedTuple(rgb);
}

void SceneOverlay::drawMark(const OverlayMark& mark, double scale) {
  const auto around = [&](double radius, int corners, double first_rad) {
    std::vector<Vector2d> places;
    for (int k = 0; k < corners; ++k) {
      const double angle = first_rad + 2.0 * std::numbers::pi * k / corners;
      places.emplace_back(mark.pixel + radius * scale * Vector2d(std::cos(angle), std::sin(angle)));
    }
    return places;
  };
  const auto shape = mark.square ? around(mark.radius_px * std::numbers::sqrt2, 4, std::numbers::pi / 4)
                                 : around(mark.radius_px, 20, 0.0);
  if (mark.full) polygon(shape, mark.fill, true);
  polygon(shape, mark.ring, false);
  for (int k = 0; k < mark.rings; ++k)
    polygon(around(mark.radius_px + 3.5 + 4.0 * k, 28, 0.0), mark.ring, false);
}

void SceneOverlay::drawLegend(const OverlayContents& contents) {
  const double k = contents.pixel_ratio;
  double y = contents.height - (contents.corner.empty() ? 20.0 : 42.0) * k;
  for (const auto& [mark, text] : contents.legend) {
    OverlayMark placed = mark;
    placed.pixel = Vector2d(contents.width - (kMargin + 4.0) * k, y);
    placed.radius_px = 4.0;
    drawMark(placed, 0.8 * k);
    write(text, placed.pixel - Vector2d(18.0 * k, 0.0), 1, contents.text, 13.0 * k);
    y -= 22.0 * k;
  }
}

void SceneOverlay::drawTriad(const OverlayContents& contents) {
  const double k = contents.pixel_ratio;
  const Vector2d corner(52.0 * k, 52.0 * k);
  const char* names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const Vector2d direction(contents.right[axis], contents.up[axis]);
    // An axis towards the eye has no direction in the picture.
    if (direction.norm() < 0.12) continue;
    line(corner, corner + 30.0 * k * direction, kAxisColours[axis]);
    write(names[axis], corner + (30.0 * k + 9.0 * k / direction.norm()) * direction, 0, contents.text,
          13.0 * k);
  }
}

void SceneOverlay::drawScale(const OverlayContents& contents) {
  const double k = contents.pixel_ratio;
  const double length_m = roundLength(std::min(180.0 * k, 0.3 * contents.width) * contents.scale_m_per_px);
  const double length_px = length_m / contents.scale_m_per_px;
  const Vector2d right(contents.width - kMargin * k, 16.0 * k);
  const Vector2d left = right - Vector2d(length_px, 0.0), tick(0.0, 7.0 * k);
  line(left + tick, left, contents.text);
  line(left, right, contents.text);
  line(right, right + tick, contents.text);
  write(shortestReal(length_m) + " m", 0.5 * (left + right) + Vector2d(0.0, 15.0 * k), 0, contents.text,
        13.0 * k);
}

void SceneOverlay::drawBar(const OverlayContents& contents) {
  const double k = contents.pixel_ratio;
  const double width = 12.0 * k, height = std::min(200.0 * k, 0.45 * contents.height);
  const Vector2d low(kMargin * k, contents.height - 36.0 * k - height);
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i)
    box(low + Vector2d(0.0, height * i / kSteps), low + Vector2d(width, height * (i + 1) / kSteps),
        contents.bar_is_signed
            ? signedColour(2.0 * (i + 0.5) / kSteps - 1.0, contents.middle_lightness)
            : evenColour((i + 0.5) / kSteps, contents.low_lightness, contents.high_lightness));
  write(contents.bar_title, Vector2d(kMargin * k, contents.height - 18.0 * k), -1, contents.text, 13.0 * k);
  write(contents.bar_low, low + Vector2d(width + 8.0 * k, 5.0 * k), -1, contents.text, 12.0 * k);
  write(contents.bar_high, low + Vector2d(width + 8.0 * k, height - 5.0 * k), -1, contents.text, 12.0 * k);
}

void SceneOverlay::drawDivider(const OverlayContents& contents) {
  const double k = contents.pixel_ratio;
  const double x = std::round(*contents.divider * contents.width), middle = 0.5 * contents.height;
  line({x, 0.0}, {x, contents.height * 1.0}, contents.divider_colour);
  // A grip, so that it is seen to be something to take hold of.
  box({x - 5.0 * k, middle - 16.0 * k}, {x + 5.0 * k, middle + 16.0 * k}, contents.divider_colour);
  for (const double at : {-1.5 * k, 1.5 * k})
    box({x + at - 0.5 * k, middle - 9.0 * k}, {x + at + 0.5 * k, middle + 9.0 * k}, ground_);
  const double y = contents.height - 18.0 * k;
  write(contents.left_of_divider, {x - 12.0 * k, y}, 1, contents.text, 13.0 * k);
  write(contents.right_of_divider, {x + 12.0 * k, y}, -1, contents.text, 13.0 * k);
}

void SceneOverlay::drawHandles(const OverlayContents& contents) {
  const double k = contents.pixel_ratio;
  for (const auto& [at, colour] : contents.handles) {
    box(at - Vector2d(6.0 * k, 6.0 * k), at + Vector2d(6.0 * k, 6.0 * k), ground_);
    box(at - Vector2d(4.5 * k, 4.5 * k), at + Vector2d(4.5 * k, 4.5 * k), colour);
  }
}

}  // namespace tiltmap::ui
