#include "core/products/top_view_marks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/products/scan_colours.h"

namespace tiltmap {

namespace {

using Eigen::Vector2d;

constexpr int kMargin = 28;
constexpr double kDisc_px = 6.0;
constexpr double kArrow_px = 27.0;
constexpr double kLabel_px = 13.0;

struct Box {
  Vector2d low, high;
  bool overlaps(const Box& other) const {
    return low.x() < other.high.x() && other.low.x() < high.x() && low.y() < other.high.y() &&
           other.low.y() < high.y();
  }
};

Box boxAround(const Vector2d& centre, double half_width, double half_height) {
  const Vector2d half(half_width, half_height);
  return {centre - half, centre + half};
}

// The heading seen from above, in pixels (y down); zero for a heading that points straight up.
Vector2d headingInPicture(const Pose& pose) {
  const Eigen::Vector3d heading = pose.heading();
  const Vector2d flat(heading.x(), -heading.y());
  return flat.norm() > 1e-6 ? Vector2d(flat.normalized()) : Vector2d::Zero();
}

void drawArrow(RgbImage& image, const Vector2d& from, const Vector2d& direction, double length, double width,
               Ink ink) {
  if (direction.isZero()) return;
  const Vector2d side(-direction.y(), direction.x());
  const Vector2d tip = from + length * direction;
  const Vector2d base = tip - 3.4 * width * direction;
  drawPolyline(image, {from, base}, width, ink);
  drawTriangle(image, tip, base + 1.9 * width * side, base - 1.9 * width * side, ink);
}

// Places the numbers one after another, the ends of the path first, each at the free spot nearest to its
// stop.
class LabelPlacer {
 public:
  explicit LabelPlacer(const TopViewFrame& frame) : frame_(frame) {}

  void occupy(const Box& box) { taken_.push_back(box); }
  // The middle of the label, or false where no spot is free.
  bool place(const Vector2d& stop, double width, double height, Vector2d& middle) {
    for (const double distance : {18.0, 24.0, 32.0, 42.0})
      for (int k = 0; k < 16; ++k) {
        // From the upper right, then alternating to both sides.
        const double turn = (k % 2 == 0 ? 1.0 : -1.0) * ((k + 1) / 2) * 0.3926990817;
        const double angle = -0.7853981634 + turn;
        const Vector2d direction(std::cos(angle), std::sin(angle));
        middle = stop + direction.cwiseProduct(Vector2d(distance + 0.5 * width - 4.0, distance));
        const Box box = boxAround(middle, 0.5 * width + 2.0, 0.5 * height + 2.0);
        if (box.low.x() < 2.0 || box.low.y() < 2.0 || box.high.x() > frame_.map_width_px - 2.0 ||
            box.high.y() > frame_.map_height_px - 2.0)
          continue;
        if (std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return other.overlaps(box); }))
          continue;
        taken_.push_back(box);
        return true;
      }
    return false;
  }

 private:
  const TopViewFrame& frame_;
  std::vector<Box> taken_;
};

std::vector<std::size_t> labelOrder(std::size_t stops) {
  std::vector<std::size_t> order{0};
  if (stops > 1) order.push_back(stops - 1);
  // Tens and fives before the rest: what is left out of a crowd is what a reader misses least.
  for (const std::size_t step : {10U, 5U, 1U})
    for (std::size_t i = step; i + 1 < stops; i += step)
      if (std::find(order.begin(), order.end(), i) == order.end()) order.push_back(i);
  return order;
}

void drawLabels(RgbImage& image, const TopViewFrame& frame, const std::vector<Vector2d>& stops,
                const std::vector<Vector2d>& headings, const TopViewInks& inks) {
  LabelPlacer placer(frame);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    placer.occupy(boxAround(stops[i], kDisc_px + 1.0, kDisc_px + 1.0));
    placer.occupy(boxAround(stops[i] + 19.0 * headings[i], 8.0, 8.0));
  }
  for (const std::size_t i : labelOrder(stops.size())) {
    const std::string text = std::to_string(i);
    const double width = textWidth(text, kLabel_px);
    Vector2d middle;
    if (!placer.place(stops[i], width, kLabel_px, middle)) continue;
    drawText(image, text, middle + Vector2d(0.0, 0.5 * kLabel_px), TextAnchor::Middle,
             {kLabel_px, inks.text, 0.15, 2.5, inks.paper});
  }
}

void drawColourBar(RgbImage& image, int left, int top, int width, const TopViewLegend& legend,
                   const TopViewInks& inks) {
  constexpr int kHeight = 12;
  for (int x = 0; x < width; ++x)
    fillRectangle(image, left + x, top, 1, kHeight,
                  {evenColour(x / (width - 1.0), inks.low_lightness, inks.high_lightness), 1.0});
  const TextStyle style{10.0, inks.dim_text, 0.13, 0.0, {}};
  drawText(image, legend.low_label, {static_cast<double>(left), top + kHeight + 18.0}, TextAnchor::Left,
           style);
  drawText(image, legend.high_label, {static_cast<double>(left + width), top + kHeight + 18.0},
           TextAnchor::Right, style);
}

// Swatches with numbers in rows of equal cells; the last says how many there was no room for.
void drawSwatches(RgbImage& image, int left, int top, int width, const TopViewLegend& legend,
                  TopViewBackground background) {
  const TopViewInks& inks = topViewInks(background);
  constexpr int kCell = 44;
  constexpr int kRow = 24;
  constexpr std::size_t kRows = 2;
  const std::size_t columns = static_cast<std::size_t>(std::max(1, width / kCell));
  const std::size_t used = std::min(columns, (legend.scans.size() + kRows - 1) / kRows);
  const std::size_t per_row =
      legend.scans.size() <= 8 && legend.scans.size() <= columns ? legend.scans.size() : used;
  if (per_row == 0) return;
  const std::size_t room = per_row * kRows;
  const bool all = legend.scans.size() <= room;
  const std::size_t shown = all ? legend.scans.size() : room - 1;
  const TextStyle style{10.0, inks.dim_text, 0.13, 0.0, {}};
  const auto cellAt = [&](std::size_t k) {
    return Vector2d(left + kCell * static_cast<double>(k % per_row),
                    top + kRow * static_cast<double>(k / per_row));
  };
  for (std::size_t k = 0; k < shown; ++k) {
    const Vector2d at = cellAt(k);
    drawDisc(image, at + Vector2d(6.0, 6.0), 6.0,
             {topViewScanColour(legend.scans[k], legend.colours, background), 1.0});
    drawText(image, std::to_string(legend.scans[k]), at + Vector2d(17.0, 11.0), TextAnchor::Left, style);
  }
  if (!all)
    drawText(image, "+" + std::to_string(legend.scans.size() - shown), cellAt(shown) + Vector2d(0.0, 11.0),
             TextAnchor::Left, style);
}

// The text, shortened to the width.
std::string fitted(const std::string& text, double height_px, double width_px) {
  if (textWidth(text, height_px) <= width_px) return text;
  std::string cut = text;
  while (!cut.empty() && textWidth(cut + "…", height_px) > width_px) {
    while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xc0U) == 0x80U) cut.pop_back();
    if (!cut.empty()) cut.pop_back();
  }
  return cut + "…";
}

}  // namespace

const TopViewInks& topViewInks(TopViewBackground background) {
  static const TopViewInks dark{
      {15, 18, 24}, {22, 26, 34}, {236, 239, 244}, {158, 167, 181}, {236, 239, 244}, 0.06, 0.42, 0.93};
  static const TopViewInks white{
      {255, 255, 255}, {246, 247, 249}, {24, 28, 36}, {92, 100, 114}, {24, 28, 36}, 0.06, 0.28, 0.80};
  return background == TopViewBackground::Dark ? dark : white;
}

Rgb topViewScanColour(std::size_t scan, const std::vector<Rgb>& colours, TopViewBackground background) {
  const Rgb colour = scan < colours.size() ? colours[scan] : scanColour(scan);
  // Light colours would vanish on paper.
  return background == TopViewBackground::Dark ? colour : mixed(colour, {0, 0, 0}, 0.30);
}

double roundLength(double limit_m) {
  const double power = std::pow(10.0, std::floor(std::log10(limit_m) + 1e-9));
  const double factor = limit_m / power * (1.0 + 1e-9);
  return (factor >= 5.0 ? 5.0 : factor >= 2.0 ? 2.0 : 1.0) * power;
}

void drawGrid(RgbImage& image, const TopViewFrame& frame, double spacing_m, const TopViewInks& inks) {
  const auto lines = [&](double low, double length, const auto& draw) {
    for (double k = std::ceil(low / spacing_m); k * spacing_m <= low + length; ++k) draw(k * spacing_m);
  };
  lines(frame.low_m.x(), frame.map_width_px / frame.px_per_m, [&](double x) {
    const int px = static_cast<int>(frame.pixelOf({x, 0.0}).x());
    fillRectangle(image, px, 0, 1, frame.map_height_px, {inks.text, inks.grid_opacity});
  });
  lines(frame.low_m.y(), frame.map_height_px / frame.px_per_m, [&](double y) {
    const int py = static_cast<int>(frame.pixelOf({0.0, y}).y());
    if (py < frame.map_height_px)
      fillRectangle(image, 0, py, frame.map_width_px, 1, {inks.text, inks.grid_opacity});
  });
}

void drawStops(RgbImage& image, const TopViewFrame& frame, const TopViewInput& input,
               TopViewBackground background) {
  const std::vector<Pose>& world_from_scan = input.world_from_scan;
  if (world_from_scan.empty()) return;
  const TopViewInks& inks = topViewInks(background);
  std::vector<Vector2d> stops;
  std::vector<Vector2d> headings;
  for (const Pose& pose : world_from_scan) {
    stops.push_back(frame.pixelOf(pose.translation().head<2>()));
    headings.push_back(headingInPicture(pose));
  }
  drawPolyline(image, stops, 5.4, {inks.paper, 0.7});
  drawPolyline(image, stops, 2.2, {inks.path, 0.95});
  // Rims first, so that no stop's rim hides another's arrow; then backwards, so that the earlier of two stops
  // in one place lies on top.
  for (std::size_t i = 0; i < stops.size(); ++i) {
    drawArrow(image, stops[i], headings[i], kArrow_px + 2.5, 5.0, {inks.paper, 0.85});
    drawDisc(image, stops[i], kDisc_px + 2.8, {inks.paper, 0.85});
  }
  for (std::size_t i = stops.size(); i-- > 0;) {
    drawArrow(image, stops[i], headings[i], kArrow_px, 2.8, {inks.path, 1.0});
    drawDisc(image, stops[i], kDisc_px + 1.4, {inks.path, 1.0});
    drawDisc(image, stops[i], kDisc_px, {topViewScanColour(i, input.colours, background), 1.0});
  }
  drawLabels(image, frame, stops, headings, inks);
}

void drawAxes(RgbImage& image, const TopViewFrame& frame, const TopViewInks& inks) {
  const Vector2d corner(kMargin, frame.map_height_px - kMargin);
  const TextStyle style{10.0, inks.text, 0.14, 2.5, inks.paper};
  for (const Vector2d& direction : {Vector2d(1, 0), Vector2d(0, -1)}) {
    drawArrow(image, corner, direction, 50.0, 4.6, {inks.paper, 0.85});
    drawArrow(image, corner, direction, 48.0, 2.0, {inks.text, 0.95});
  }
  drawText(image, "x", corner + Vector2d(56.0, 4.0), TextAnchor::Left, style);
  drawText(image, "y", corner + Vector2d(0.0, -56.0), TextAnchor::Middle, style);
}

ScaleBar drawFooter(RgbImage& image, const TopViewFrame& frame, double bar_m, const TopViewLegend& legend,
                    TopViewBackground background) {
  const TopViewInks& inks = topViewInks(background);
  const int top = frame.map_height_px;
  const int width = frame.map_width_px;
  fillRectangle(image, 0, top, width, kTopViewFooterPx, {inks.footer, 1.0});
  fillRectangle(image, 0, top, width, 1, {inks.text, 0.12});

  ScaleBar bar;
  bar.length_m = bar_m;
  bar.right_px = Vector2d(width - kMargin, top + 56.0);
  bar.left_px = bar.right_px - Vector2d(bar_m * frame.px_per_m, 0.0);
  drawPolyline(image,
               {bar.left_px - Vector2d(0, 8), bar.left_px, bar.right_px, bar.right_px - Vector2d(0, 8)}, 2.0,
               {inks.text, 1.0});
  drawText(image, shortestReal(bar_m) + " m", {0.5 * (bar.left_px.x() + bar.right_px.x()), top + 44.0},
           TextAnchor::Middle, {12.0, inks.text, 0.13, 0.0, {}});

  const double text_room = 0.36 * width;
  drawText(image, fitted(legend.title, 15.0, text_room), {static_cast<double>(kMargin), top + 43.0},
           TextAnchor::Left, {15.0, inks.text, 0.135, 0.0, {}});
  drawText(image, fitted(legend.subtitle, 10.0, text_room), {static_cast<double>(kMargin), top + 67.0},
           TextAnchor::Left, {10.0, inks.dim_text, 0.13, 0.0, {}});

  const int legend_left = kMargin + static_cast<int>(text_room) + 32;
  const int legend_width = static_cast<int>(bar.left_px.x()) - 48 - legend_left;
  if (legend_width < 60) return bar;
  const TextStyle small{10.0, inks.text, 0.13, 0.0, {}};
  const std::array<const char*, 3> names = {"Scan", "Height", "Density"};
  drawText(image, names[static_cast<std::size_t>(legend.colouring)],
           {static_cast<double>(legend_left), top + 31.0}, TextAnchor::Left, small);
  if (legend.colouring == TopViewColouring::Scan)
    drawSwatches(image, legend_left, top + 42, legend_width, legend, background);
  else
    drawColourBar(image, legend_left, top + 42, std::min(legend_width, 320), legend, inks);
  return bar;
}

}  // namespace tiltmap
