#include "core/products/top_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/products/top_view_marks.h"

namespace tiltmap {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSmallestSide_m = 4.0;

struct Span {
  double low = 0.0;
  double high = 0.0;
};

// The middle `share` of the values, and nothing for none.
Span middleOf(std::vector<double>& values, double share) {
  if (values.empty()) return {};
  const double cut = 0.5 * (1.0 - share);
  return {quantileOf(values, cut), quantileOf(values, 1.0 - cut)};
}

template <class Use>
void forPoints(const TopViewInput& input, const Use& use) {
  for (const TopViewCloud& cloud : input.clouds)
    for (const Vector3d& p : cloud.points)
      if (p.allFinite()) use(cloud.scan, p);
}

TopViewFrame frameFor(const TopViewInput& input, const TopViewSettings& settings) {
  std::vector<double> values;
  Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
  Vector2d high = -low;
  for (int axis = 0; axis < 2; ++axis) {
    values.clear();
    forPoints(input, [&](std::size_t, const Vector3d& p) { values.push_back(p(axis)); });
    if (!values.empty()) {
      const Span span = middleOf(values, settings.shown_share);
      low(axis) = span.low;
      high(axis) = span.high;
    }
  }
  for (const Pose& pose : input.world_from_scan) {
    low = low.cwiseMin(pose.translation().head<2>());
    high = high.cwiseMax(pose.translation().head<2>());
  }
  Vector2d size = (1.08 * (high - low)).cwiseMax(kSmallestSide_m);
  // Neither a ribbon nor a tower.
  size.x() = std::max(size.x(), size.y() / 1.25);
  size.y() = std::max(size.y(), 0.45 * size.x());
  TopViewFrame frame;
  frame.map_width_px = settings.width_px;
  frame.px_per_m = settings.width_px / size.x();
  frame.map_height_px = static_cast<int>(std::lround(size.y() * frame.px_per_m));
  frame.low_m = 0.5 * (low + high) - 0.5 * size;
  return frame;
}

// What the points leave in each pixel of the map.
struct Layers {
  std::vector<double> fullness;        // 1 at the middle of a single point
  std::vector<Eigen::Vector3f> light;  // sum of colour by fullness
  std::vector<double> top_m;           // the highest point
  std::size_t points = 0;
  double point_px = 1.0;
};

// Small where points are many, so that they do not run together; large where they are few and would be lost.
double pointRadius(const TopViewInput& input, const TopViewSettings& settings, const TopViewFrame& frame) {
  if (settings.point_px > 0.0) return settings.point_px;
  std::size_t points = 0;
  for (const TopViewCloud& cloud : input.clouds) points += cloud.points.size();
  const double a_pixel =
      std::max(1.0, static_cast<double>(points)) / frame.map_width_px / frame.map_height_px;
  return std::clamp(1.15 * std::pow(a_pixel, -0.2), 1.2, 2.4);
}

Layers layersOf(const TopViewInput& input, const TopViewSettings& settings, const TopViewFrame& frame) {
  const std::size_t count =
      static_cast<std::size_t>(frame.map_width_px) * static_cast<std::size_t>(frame.map_height_px);
  Layers layers{std::vector<double>(count, 0.0),
                {},
                std::vector<double>(count, -std::numeric_limits<double>::infinity()),
                0};
  const bool by_scan = settings.colouring == TopViewColouring::Scan;
  if (by_scan) layers.light.assign(count, Eigen::Vector3f::Zero());
  const double radius = pointRadius(input, settings, frame);
  layers.point_px = radius;
  for (const TopViewCloud& cloud : input.clouds) {
    const Vector3d colour = linearOf(topViewScanColour(cloud.scan, input.colours, settings.background));
    for (const Vector3d& p : cloud.points) {
      if (!p.allFinite()) continue;
      const Vector2d at = frame.pixelOf(p.head<2>());
      if (at.x() < 0.0 || at.y() < 0.0 || at.x() >= frame.map_width_px || at.y() >= frame.map_height_px)
        continue;
      ++layers.points;
      const int x_end = std::min(frame.map_width_px - 1, static_cast<int>(at.x() + radius));
      const int y_end = std::min(frame.map_height_px - 1, static_cast<int>(at.y() + radius));
      for (int y = std::max(0, static_cast<int>(at.y() - radius)); y <= y_end; ++y)
        for (int x = std::max(0, static_cast<int>(at.x() - radius)); x <= x_end; ++x) {
          const double share = 1.0 - std::hypot(x + 0.5 - at.x(), y + 0.5 - at.y()) / radius;
          if (share <= 0.0) continue;
          const std::size_t k = static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.map_width_px) +
                                static_cast<std::size_t>(x);
          layers.fullness[k] += share;
          layers.top_m[k] = std::max(layers.top_m[k], p.z());
          if (by_scan) layers.light[k] += (share * colour).cast<float>();
        }
    }
  }
  return layers;
}

// The fullness that only one filled pixel in a hundred exceeds.
double fullOf(const Layers& layers) {
  std::vector<double> filled;
  for (const double f : layers.fullness)
    if (f > 0.0) filled.push_back(f);
  if (filled.empty()) return 1.0;
  return std::max(1.0, quantileOf(filled, 0.99));
}

Span heightsOf(const TopViewInput& input) {
  std::vector<double> heights;
  forPoints(input, [&](std::size_t, const Vector3d& p) { heights.push_back(p.z()); });
  Span span = middleOf(heights, 0.96);
  if (span.high - span.low < 0.01) span = {span.low - 0.005, span.low + 0.005};
  return span;
}

void paintPoints(RgbImage& image, const TopViewFrame& frame, const Layers& layers,
                 const TopViewSettings& settings, const Span& heights, double full) {
  const TopViewInks& inks = topViewInks(settings.background);
  // A single point stays visible; a hundred times as many are brighter, not a hundred times as bright.
  constexpr double kSteepness = 6.0;
  const double floor = settings.background == TopViewBackground::Dark ? 0.36 : 0.50;
  const double contrast = settings.colouring == TopViewColouring::Density ? 1.0 : 1.6;  // walls before floors
  const double highest = std::log1p(kSteepness * full);
  for (int y = 0; y < frame.map_height_px; ++y)
    for (int x = 0; x < frame.map_width_px; ++x) {
      const std::size_t k = image.index(x, y);
      const double fullness = layers.fullness[k];
      if (fullness <= 0.0) continue;
      const double tone = std::pow(std::min(1.0, std::log1p(kSteepness * fullness) / highest), contrast);
      Rgb colour;
      switch (settings.colouring) {
        case TopViewColouring::Scan:
          colour = rgbOfLinear(layers.light[k].cast<double>() / fullness);
          break;
        case TopViewColouring::Height:
          colour = evenColour((layers.top_m[k] - heights.low) / (heights.high - heights.low),
                              inks.low_lightness, inks.high_lightness);
          break;
        case TopViewColouring::Density:
          colour = evenColour(tone, inks.low_lightness, inks.high_lightness);
          break;
      }
      // The rim of a lone point fades out instead of ending in steps.
      const double rim = std::min(1.0, 2.5 * fullness);
      image.at(x, y) = mixed(image.at(x, y), colour, rim * (floor + (1.0 - floor) * tone));
    }
}

TopViewLegend legendOf(const TopViewInput& input, const TopViewSettings& settings, const TopViewFrame& frame,
                       const Layers& layers, const Span& heights, double full, double grid_m) {
  TopViewLegend legend;
  legend.title = input.title;
  legend.colouring = settings.colouring;
  legend.colours = input.colours;
  const std::size_t stops = input.world_from_scan.size();
  legend.subtitle = std::to_string(stops) + (stops == 1 ? " stop, " : " stops, ") +
                    groupedInteger(static_cast<long long>(layers.points)) + " points, grid " +
                    shortestReal(grid_m) + " m";
  for (const TopViewCloud& cloud : input.clouds) legend.scans.push_back(cloud.scan);
  if (settings.colouring == TopViewColouring::Height) {
    legend.low_label = fixedReal(heights.low, 1) + " m";
    legend.high_label = fixedReal(heights.high, 1) + " m";
  } else if (settings.colouring == TopViewColouring::Density) {
    // A point spreads over a cone of volume pi r^2 / 3 pixels.
    const double pixels = std::max(1.0, layers.point_px * layers.point_px * std::numbers::pi / 3.0);
    legend.low_label = "few";
    legend.high_label =
        groupedInteger(static_cast<long long>(full / pixels * frame.px_per_m * frame.px_per_m)) +
        " points/m²";
  }
  return legend;
}

Status checkInput(const TopViewInput& input, const TopViewSettings& settings) {
  if (settings.width_px < 400 || settings.width_px > 4000)
    return fail("a picture " + std::to_string(settings.width_px) + " pixels wide cannot be drawn", "top view",
                "choose a width from 400 to 4000 pixels");
  for (std::size_t i = 0; i < input.world_from_scan.size(); ++i)
    if (!input.world_from_scan[i].isFinite())
      return fail("the pose of a stop is not a number", "top view, stop " + std::to_string(i),
                  "correct the pose of this stop");
  std::size_t points = 0;
  forPoints(input, [&](std::size_t, const Vector3d&) { ++points; });
  if (points == 0 && input.world_from_scan.empty())
    return fail("there is nothing to draw: no points and no stops", "top view",
                "add scans to the project first");
  return {};
}

}  // namespace

const ParameterTable<TopViewSettings>& topViewParameters() {
  static const ParameterTable<TopViewSettings> table = [] {
    ParameterTable<TopViewSettings> t("top-view");
    t.choice("colouring", &TopViewSettings::colouring,
             {{"scan", TopViewColouring::Scan},
              {"height", TopViewColouring::Height},
              {"density", TopViewColouring::Density}},
             "what the colour of a point tells", "ours");
    t.choice("background", &TopViewSettings::background,
             {{"dark", TopViewBackground::Dark}, {"white", TopViewBackground::White}},
             "dark for a screen, white for paper", "ours");
    t.integer("width", &TopViewSettings::width_px, "px", 400, 4000, "width of the picture", "ours");
    t.real("point-size", &TopViewSettings::point_px, "px", 0, 20,
           "radius of a point; 0 chooses by how many there are, large ones hide detail", "ours");
    t.real("shown-share", &TopViewSettings::shown_share, "", 0.5, 1,
           "share of the points that the picture is fitted to; 1 shrinks the map for a few far points",
           "ours");
    return t;
  }();
  return table;
}

Result<TopView> drawTopView(const TopViewInput& input, const TopViewSettings& settings) {
  if (const Status good = checkInput(input, settings); !good) return fail(good.error());
  const TopViewInks& inks = topViewInks(settings.background);
  TopView view;
  view.frame = frameFor(input, settings);
  view.image = RgbImage(view.frame.map_width_px, view.frame.map_height_px + kTopViewFooterPx, inks.paper);

  const double bar_m = roundLength(0.16 * settings.width_px / view.frame.px_per_m);
  drawGrid(view.image, view.frame, bar_m, inks);
  const Layers layers = layersOf(input, settings, view.frame);
  view.points_drawn = layers.points;
  const double full = fullOf(layers);
  const Span heights = heightsOf(input);
  paintPoints(view.image, view.frame, layers, settings, heights, full);
  drawStops(view.image, view.frame, input, settings.background);
  drawAxes(view.image, view.frame, inks);
  view.scale_bar =
      drawFooter(view.image, view.frame, bar_m,
                 legendOf(input, settings, view.frame, layers, heights, full, bar_m), settings.background);
  return view;
}

}  // namespace tiltmap
