#include "core/products/drawing.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/text.h"
#include "core/products/stroke_font.h"

namespace tiltmap {

namespace {

using Eigen::Vector2d;

// How much of each pixel of a part of the picture is covered, 0 to 1.
class Coverage {
 public:
  Coverage(const RgbImage& image, const Vector2d& low, const Vector2d& high)
      : left_(clamped(std::floor(low.x()), image.width)),
        top_(clamped(std::floor(low.y()), image.height)),
        right_(clamped(std::ceil(high.x()), image.width)),
        bottom_(clamped(std::ceil(high.y()), image.height)),
        share_(static_cast<std::size_t>(std::max(0, right_ - left_)) *
               static_cast<std::size_t>(std::max(0, bottom_ - top_))) {}

  // The union with everything within `radius` of the segment from a to b.
  void addSegment(const Vector2d& a, const Vector2d& b, double radius) {
    const Vector2d along = b - a;
    const double square = along.squaredNorm();
    forPixels(a.cwiseMin(b), a.cwiseMax(b), radius + 1.0, [&](const Vector2d& p) {
      const double t = square > 0.0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
      return radius + 0.5 - (p - a - t * along).norm();
    });
  }
  void addTriangle(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    const double turn = cross(b - a, c - a) < 0.0 ? -1.0 : 1.0;
    const auto inside = [turn](const Vector2d& p, const Vector2d& from, const Vector2d& to) {
      const double length = (to - from).norm();
      return length > 0.0 ? turn * cross(to - from, p - from) / length : 0.0;
    };
    forPixels(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), 1.0, [&](const Vector2d& p) {
      return 0.5 + std::min({inside(p, a, b), inside(p, b, c), inside(p, c, a)});
    });
  }
  void paint(RgbImage& image, Ink ink) const {
    std::size_t k = 0;
    for (int y = top_; y < bottom_; ++y)
      for (int x = left_; x < right_; ++x, ++k)
        if (share_[k] > 0.0) image.at(x, y) = mixed(image.at(x, y), ink.colour, ink.opacity * share_[k]);
  }

 private:
  // Also for coordinates far beyond what an int holds.
  static int clamped(double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  }
  static double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
  template <class Share>
  void forPixels(const Vector2d& low, const Vector2d& high, double rim, const Share& share) {
    const int x_end = std::min(right_, clamped(std::ceil(high.x() + rim), right_));
    const int y_end = std::min(bottom_, clamped(std::ceil(high.y() + rim), bottom_));
    for (int y = std::max(top_, clamped(std::floor(low.y() - rim), bottom_)); y < y_end; ++y)
      for (int x = std::max(left_, clamped(std::floor(low.x() - rim), right_)); x < x_end; ++x) {
        double& kept = share_[static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(right_ - left_) +
                              static_cast<std::size_t>(x - left_)];
        kept = std::max(kept, std::clamp(share(Vector2d(x + 0.5, y + 0.5)), 0.0, 1.0));
      }
  }

  int left_, top_, right_, bottom_;
  std::vector<double> share_;
};

using Strokes = std::vector<std::vector<Vector2d>>;

void drawStrokes(RgbImage& image, const Strokes& strokes, double width_px, Ink ink) {
  Vector2d low(1e9, 1e9);
  Vector2d high(-1e9, -1e9);
  for (const auto& stroke : strokes)
    for (const Vector2d& point : stroke) {
      if (!point.allFinite()) throw std::invalid_argument("drawing: a coordinate is not finite");
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  if (low.x() > high.x()) return;
  const double radius = 0.5 * width_px;
  const Vector2d rim(radius + 2.0, radius + 2.0);
  Coverage coverage(image, low - rim, high + rim);
  for (const auto& stroke : strokes) {
    if (stroke.size() == 1) coverage.addSegment(stroke[0], stroke[0], radius);
    for (std::size_t k = 1; k < stroke.size(); ++k) coverage.addSegment(stroke[k - 1], stroke[k], radius);
  }
  coverage.paint(image, ink);
}

}  // namespace

void drawPolyline(RgbImage& image, const std::vector<Vector2d>& points, double width_px, Ink ink) {
  drawStrokes(image, {points}, width_px, ink);
}

void drawDisc(RgbImage& image, const Vector2d& centre, double radius_px, Ink ink) {
  drawStrokes(image, {{centre}}, 2.0 * radius_px, ink);
}

void drawTriangle(RgbImage& image, const Vector2d& a, const Vector2d& b, const Vector2d& c, Ink ink) {
  const Vector2d rim(2.0, 2.0);
  Coverage coverage(image, a.cwiseMin(b).cwiseMin(c) - rim, a.cwiseMax(b).cwiseMax(c) + rim);
  coverage.addTriangle(a, b, c);
  coverage.paint(image, ink);
}

void fillRectangle(RgbImage& image, int left, int top, int width, int height, Ink ink) {
  for (int y = std::max(0, top); y < std::min(image.height, top + height); ++y)
    for (int x = std::max(0, left); x < std::min(image.width, left + width); ++x)
      image.at(x, y) = mixed(image.at(x, y), ink.colour, ink.opacity);
}

double textWidth(std::string_view utf8, double height_px) {
  double advance = 0.0;
  for (const char32_t letter : codePointsOf(utf8)) advance += glyphOf(letter).advance;
  return std::max(0.0, advance - kLetterGap) * height_px / 10.0;
}

void drawText(RgbImage& image, std::string_view utf8, const Vector2d& position, TextAnchor anchor,
              const TextStyle& style) {
  const double unit = style.height_px / 10.0;
  const double width = textWidth(utf8, style.height_px);
  double x = position.x() - (anchor == TextAnchor::Left     ? 0.0
                             : anchor == TextAnchor::Middle ? 0.5
                                                            : 1.0) *
                                width;
  Strokes strokes;
  for (const char32_t letter : codePointsOf(utf8)) {
    const Glyph& glyph = glyphOf(letter);
    for (auto stroke : glyph.strokes) {
      for (Vector2d& p : stroke) p = Vector2d(x + p.x() * unit, position.y() - p.y() * unit);
      strokes.push_back(std::move(stroke));
    }
    x += glyph.advance * unit;
  }
  const double stroke_px = std::max(1.0, style.weight * style.height_px);
  if (style.halo_px > 0.0) drawStrokes(image, strokes, stroke_px + 2.0 * style.halo_px, {style.halo, 1.0});
  drawStrokes(image, strokes, stroke_px, {style.colour, 1.0});
}

}  // namespace tiltmap
