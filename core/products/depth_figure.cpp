#include "core/products/depth_figure.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/products/drawing.h"
#include "core/products/top_view_marks.h"

namespace tiltmap {

namespace {

using Eigen::Vector2d;

constexpr double kLeft = 64.0, kRight = 28.0, kTop = 60.0, kBottom = 118.0;
constexpr double kText_px = 10.0;

struct Place {
  double left, top, width, height;
};

void drawMatrix(RgbImage& figure, const RgbImage& cells, const Place& place) {
  const int x0 = static_cast<int>(std::lround(place.left)), y0 = static_cast<int>(std::lround(place.top));
  const int x1 = static_cast<int>(std::lround(place.left + place.width));
  const int y1 = static_cast<int>(std::lround(place.top + place.height));
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const int cx = static_cast<int>((x + 0.5 - place.left) / place.width * cells.width);
      const int cy = static_cast<int>((y + 0.5 - place.top) / place.height * cells.height);
      if (figure.contains(x, y) && cells.contains(cx, cy)) figure.at(x, y) = cells.at(cx, cy);
    }
}

// The middle of a cell's pixel along one side of the picture.
double along(const DepthAxis& axis, double value, int cells, double start, double length, bool turned) {
  const double cell = axis.cellOf(value);
  const double pixel = turned ? cells - 0.5 - cell : cell + 0.5;
  return start + pixel / cells * length;
}

void drawFigureAxes(RgbImage& figure, const DepthImage& image, const Place& place, const TopViewInks& inks) {
  const TextStyle style{kText_px, inks.dim_text, 0.13, 0.0, {}};
  const double bottom = place.top + place.height;
  const auto ends = [](const DepthAxis& axis, int cells) {
    const double first = axis.at(0.0), last = axis.at(cells - 1.0);
    return std::pair(std::min(first, last), std::max(first, last));
  };
  const auto [low_x, high_x] = ends(image.azimuth, image.columns);
  for (const double value : axisTicks(low_x, high_x, std::max(2, static_cast<int>(place.width / 90.0)))) {
    const double x =
        along(image.azimuth, value, image.columns, place.left, place.width, image.columnsTurned());
    drawPolyline(figure, {{x, bottom + 1.0}, {x, bottom + 6.0}}, 1.2, {inks.dim_text, 1.0});
    drawText(figure, shortestReal(value), {x, bottom + 22.0}, TextAnchor::Middle, style);
  }
  const auto [low_y, high_y] = ends(image.tilt, image.rows);
  for (const double value : axisTicks(low_y, high_y, std::max(2, static_cast<int>(place.height / 50.0)))) {
    const double y = along(image.tilt, value, image.rows, place.top, place.height, image.rowsTurned());
    drawPolyline(figure, {{place.left - 6.0, y}, {place.left - 1.0, y}}, 1.2, {inks.dim_text, 1.0});
    drawText(figure, shortestReal(value), {place.left - 11.0, y + 0.5 * kText_px}, TextAnchor::Right, style);
  }
  drawText(figure, image.azimuth.title, {place.left + 0.5 * place.width, bottom + 42.0}, TextAnchor::Middle,
           style);
  drawText(figure, image.tilt.title, {12.0, place.top - 12.0}, TextAnchor::Left, style);
}

void drawBar(RgbImage& figure, const DepthImage& image, double low, double high, const Place& place,
             const TopViewInks& inks) {
  const double width = std::min(place.width, 420.0);
  const int left = static_cast<int>(place.left), top = static_cast<int>(place.top);
  for (int x = 0; x < static_cast<int>(width); ++x)
    fillRectangle(figure, left + x, top, 1, 12,
                  {depthColour(image, low + x / (width - 1.0) * (high - low), low, high), 1.0});
  const TextStyle style{kText_px, inks.dim_text, 0.13, 0.0, {}};
  for (const double value : axisTicks(low, high, 5)) {
    const double x = place.left + (value - low) / (high - low) * width;
    drawPolyline(figure, {{x, top + 12.0}, {x, top + 16.0}}, 1.2, {inks.dim_text, 1.0});
    drawText(figure, shortestReal(value), {x, top + 31.0}, TextAnchor::Middle, style);
  }
  const std::string unit = image.unit.empty() ? image.title : image.unit;
  drawText(figure, unit, {place.left + width + 14.0, top + 11.0}, TextAnchor::Left, style);
}

void drawLegend(RgbImage& figure, const DepthImage& image, const Place& place, const TopViewInks& inks) {
  const TextStyle style{kText_px, inks.dim_text, 0.13, 0.0, {}};
  double x = place.left, y = place.top;
  for (const auto& [text, colour] : image.legend) {
    const double width = 20.0 + textWidth(text, kText_px) + 22.0;
    if (x > place.left && x + width > place.left + place.width) x = place.left, y += 20.0;
    fillRectangle(figure, static_cast<int>(x), static_cast<int>(y), 12, 12, {colour, 1.0});
    drawText(figure, text, {x + 20.0, y + 11.0}, TextAnchor::Left, style);
    x += width;
  }
}

std::string subtitleOf(const DepthImage& image) {
  if (image.quantity == DepthQuantity::Residual)
    return image.title + (image.overlapping == 0
                              ? ": no cell overlaps another scan"
                              : ": median " + fixedReal(1e3 * image.median_residual_m, 1) + " mm over " +
                                    groupedInteger(static_cast<long long>(image.overlapping)) + " cells");
  if (image.quantity != DepthQuantity::Changed)
    return image.title + (image.unit.empty() ? "" : " (" + image.unit + ")");
  if (image.changed == 0) return image.title + ": no cells";
  return image.title + ": " + groupedInteger(static_cast<long long>(image.changed)) +
         (image.changed == 1 ? " cell" : " cells") + ", mean change " + fixedReal(image.mean_change_m, 2) +
         " m";
}

}  // namespace

std::vector<double> axisTicks(double low, double high, int count) {
  std::vector<double> ticks;
  if (!(high > low) || count < 1) return ticks;
  const double least = (high - low) / count;
  double step = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (factor * step >= least * (1.0 - 1e-9)) {
      step *= factor;
      break;
    }
  // A thousandth of a step of tolerance: an end that is a multiple is meant to have its label.
  for (double k = std::ceil(low / step - 1e-3); k * step <= high + 1e-3 * step; ++k) {
    const double value = k * step;
    ticks.push_back(std::round(value * 1e9) / 1e9 + 0.0);
  }
  return ticks;
}

Result<DepthFigure> drawDepthFigure(const DepthImage& image, const DepthFigureSettings& settings) {
  const double wide = image.regular ? std::abs(image.azimuth.step) * image.columns : image.columns;
  const double high_deg = image.regular ? std::abs(image.tilt.step) * image.rows : image.rows;
  int height = settings.height_px;
  if (height == 0)
    height = static_cast<int>(
        std::clamp((settings.width_px - kLeft - kRight) * high_deg / wide + kTop + kBottom, 200.0, 16384.0));
  if (settings.width_px < 320 || settings.width_px > 16384 || height < 200 || height > 16384)
    return fail("a figure of " + std::to_string(settings.width_px) + " x " + std::to_string(height) +
                    " pixels cannot be drawn",
                "size", "choose 320 x 200 to 16384 x 16384");
  const TopViewInks& inks = topViewInks(settings.background);
  DepthFigure figure;
  figure.image = RgbImage(settings.width_px, height, inks.paper);
  Place place{kLeft, kTop, settings.width_px - kLeft - kRight, height - kTop - kBottom};
  const double scale = std::min(place.width / wide, place.height / high_deg);
  const Place room = place;
  place.width = wide * scale;
  place.height = high_deg * scale;
  place.left += std::round(0.5 * (room.width - place.width));
  place.top += std::round(0.5 * (room.height - place.height));

  const auto [low, high] = settings.range.value_or(std::pair(image.low, image.high));
  const Rgb no_data = settings.background == TopViewBackground::Dark ? Rgb{74, 79, 84} : Rgb{200, 204, 208};
  drawMatrix(figure.image, depthPicture(image, low, high, no_data), place);
  drawFigureAxes(figure.image, image, place, inks);
  const Place below{place.left, place.top + place.height + 62.0, place.width, 50.0};
  if (image.hasColourBar() && high > low)
    drawBar(figure.image, image, low, high, below, inks);
  else
    drawLegend(figure.image, image, below, inks);
  const std::string subtitle = settings.subtitle.empty() ? subtitleOf(image) : settings.subtitle;
  drawText(figure.image, settings.title, {place.left, place.top - 30.0}, TextAnchor::Left,
           {14.0, inks.text, 0.135, 0.0, {}});
  const double title_end =
      place.left + (settings.title.empty() ? 0.0 : textWidth(settings.title, 14.0) + 20.0);
  drawText(figure.image, subtitle, {std::max(title_end, place.left), place.top - 30.0}, TextAnchor::Left,
           {11.0, inks.dim_text, 0.13, 0.0, {}});
  figure.left = place.left, figure.top = place.top, figure.width = place.width, figure.height = place.height;
  return figure;
}

}  // namespace tiltmap
