// What stands on and below the points of a top view.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/products/drawing.h"
#include "core/products/top_view.h"

namespace tiltmap {

// Colours of everything but the points.
struct TopViewInks {
  Rgb paper;   // behind the map
  Rgb footer;  // behind the legend
  Rgb text;
  Rgb dim_text;
  Rgb path;
  double grid_opacity;
  double low_lightness;  // of evenColour
  double high_lightness;
};
const TopViewInks& topViewInks(TopViewBackground background);
Rgb topViewScanColour(std::size_t scan, const std::vector<Rgb>& colours, TopViewBackground background);

inline constexpr int kTopViewFooterPx = 92;

// 1, 2 or 5 times a power of ten, at most `limit_m`.
double roundLength(double limit_m);

void drawGrid(RgbImage& image, const TopViewFrame& frame, double spacing_m, const TopViewInks& inks);
// The path as a line, each stop as a disc in its scan's colour with an arrow along its heading, and its
// number where there is room; numbers of a crowd of stops are left out rather than piled up.
void drawStops(RgbImage& image, const TopViewFrame& frame, const TopViewInput& input,
               TopViewBackground background);
void drawAxes(RgbImage& image, const TopViewFrame& frame, const TopViewInks& inks);

struct TopViewLegend {
  std::string title;
  std::string subtitle;
  TopViewColouring colouring = TopViewColouring::Scan;
  std::vector<std::size_t> scans;     // for Scan
  std::vector<Rgb> colours;           // as in TopViewInput
  std::string low_label, high_label;  // for Height and Density
};
ScaleBar drawFooter(RgbImage& image, const TopViewFrame& frame, double bar_m, const TopViewLegend& legend,
                    TopViewBackground background);

}  // namespace tiltmap
