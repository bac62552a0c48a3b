// A depth image as a figure: axes in degrees, colour bar or legend, title.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "core/products/depth_image.h"
#include "core/products/top_view.h"

namespace tiltmap {

struct DepthFigureSettings {
  int width_px = 1200;
  int height_px = 0;  // 0: as high as the matrix asks for
  TopViewBackground background = TopViewBackground::Dark;
  std::string title;                               // "Scan 3: stop-03"
  std::string subtitle;                            // empty: what is shown, and for changed cells how many
  std::optional<std::pair<double, double>> range;  // of the colour bar; nothing: low and high of the image
};

// Where the matrix lies in the figure, in pixels from its top left corner.
struct DepthFigure {
  RgbImage image;
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
};

// A degree is as wide as high, unless the matrix has no regular grid. Error: a size out of 320 x 200 to
// 16384 x 16384.
Result<DepthFigure> drawDepthFigure(const DepthImage& image, const DepthFigureSettings& settings);

// Where labels stand between low and high: multiples of 1, 2 or 5 times a power of ten, about `count`.
std::vector<double> axisTicks(double low, double high, int count);

}  // namespace tiltmap
