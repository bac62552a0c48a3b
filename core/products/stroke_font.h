// The letters of core/products/drawing.h as strokes.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace tiltmap {

inline constexpr double kLetterGap = 2.0;  // part of a letter's advance

// Units: a capital is 10 high; x right, y up, the base line at 0. A stroke of one point is a dot.
struct Glyph {
  std::vector<std::vector<Eigen::Vector2d>> strokes;
  double advance = 0.0;
};

// The box for letters that there are none of.
const Glyph& glyphOf(char32_t letter);

}  // namespace tiltmap
