// Smooth lines, discs and letters on a picture. Pixel coordinates: x right, y down, (0,0) the corner of the
// top left pixel, whose middle is (0.5, 0.5).
#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/products/rgb_image.h"

namespace tiltmap {

struct Ink {
  Rgb colour;
  double opacity = 1.0;
};

// All are clipped at the picture's borders. Round caps and joints; a polyline over itself does not get
// darker.
void drawPolyline(RgbImage& image, const std::vector<Eigen::Vector2d>& points, double width_px, Ink ink);
void drawDisc(RgbImage& image, const Eigen::Vector2d& centre, double radius_px, Ink ink);
void drawTriangle(RgbImage& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                  const Eigen::Vector2d& c, Ink ink);
void fillRectangle(RgbImage& image, int left, int top, int width, int height, Ink ink);

// A stroke font of our own: nothing to install, the same on every machine. Latin letters with the usual
// accents, digits and signs; what it lacks is drawn as a box. `height_px` is that of a capital letter.
struct TextStyle {
  double height_px = 12.0;
  Rgb colour{230, 230, 230};
  double weight = 0.13;  // stroke width against height
  double halo_px = 0.0;  // a rim of `halo` around the strokes, for text over points
  Rgb halo{};
};
enum class TextAnchor { Left, Middle, Right };

double textWidth(std::string_view utf8, double height_px);
// `position`: the base line at the anchor.
void drawText(RgbImage& image, std::string_view utf8, const Eigen::Vector2d& position, TextAnchor anchor,
              const TextStyle& style);

}  // namespace tiltmap
