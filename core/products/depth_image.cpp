#include "core/products/depth_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/products/residuals.h"
#include "core/scan/filters.h"
#include "core/scan/normals.h"

namespace tiltmap {

namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr Rgb kChangedColour{255, 140, 0};

const std::array<std::string, 9> kNames = {"range",     "median",    "planar-median", "changed", "normal",
                                           "incidence", "intensity", "code",          "residual"};

void fillRange(DepthImage& image, const RangeImage& source) {
  for (std::size_t cell = 0; cell < source.cells(); ++cell)
    if (source.hasPoint(cell)) image.value[cell] = source.range(cell);
}

void fillChanged(DepthImage& image, const RangeImagePtr& source) {
  image.mark.assign(source->cells(), 0);
  image.backdrop.assign(source->cells(), kNothing);
  for (std::size_t cell = 0; cell < source->cells(); ++cell)
    if (source->hasPoint(cell)) image.backdrop[cell] = source->range(cell);
  const FilteredImage filtered = medianFiltered(source, {});
  for (const CellChange& change : filtered.changes) {
    const std::size_t cell = image.index(change.row, change.column);
    image.mark[cell] = 1;
    image.value[cell] = static_cast<float>(std::abs(change.after_m - change.before_m));
  }
  image.legend = {{"changed", kChangedColour}};
  image.changed = filtered.changes.size();
  image.mean_change_m = filtered.meanChange();
}

void fillResiduals(DepthImage& image, const std::vector<float>& residuals) {
  image.value = residuals;
  const ResidualSummary summary = summaryOf(residuals);
  image.overlapping = summary.cells;
  image.median_residual_m = summary.median_m;
  image.low = -0.1, image.high = 0.1;  // where there are none
}

Rgb normalColour(const Eigen::Vector3d& normal) {
  const auto channel = [](double part) {
    return static_cast<std::uint8_t>(std::lround(127.5 * (std::clamp(part, -1.0, 1.0) + 1.0)));
  };
  return {channel(normal.x()), channel(normal.y()), channel(normal.z())};
}

void fillNormals(DepthImage& image, const RangeImage& source, const ScannerGeometry& geometry) {
  const auto points = cellPoints(source, geometry);
  const auto normals = matrixNormals(source, points);
  const bool incidence = image.quantity == DepthQuantity::Incidence;
  if (!incidence) image.colour.assign(source.cells(), Rgb{});
  for (std::size_t cell = 0; cell < source.cells(); ++cell) {
    if (normals[cell].isZero() || points[cell].isZero()) continue;
    const double cosine = std::clamp(-normals[cell].dot(points[cell].normalized()), -1.0, 1.0);
    image.value[cell] = static_cast<float>(incidence ? std::acos(cosine) / kDegree : normals[cell].z());
    if (!incidence) image.colour[cell] = normalColour(normals[cell]);
  }
  if (!incidence)
    image.legend = {{"right", normalColour({1, 0, 0})},   {"left", normalColour({-1, 0, 0})},
                    {"forward", normalColour({0, 1, 0})}, {"towards the scanner", normalColour({0, -1, 0})},
                    {"up", normalColour({0, 0, 1})},      {"down", normalColour({0, 0, -1})}};
}

Rgb codeColour(CellCode code) {
  switch (code) {
    case cell_code::kMeasured:
      return {86, 180, 233};
    case cell_code::kReplaced:
      return kChangedColour;
    case cell_code::kMissing:
      return {110, 110, 110};
    case cell_code::kOutOfBounds:
      return {204, 121, 167};
    case cell_code::kMasked:
      return {60, 60, 60};
    case cell_code::kNotScanned:
      return {160, 160, 160};
    case cell_code::kNoReturn:
    case cell_code::kLmsNoSignal:
      return {0, 70, 120};
    case cell_code::kLmsOverflow:
      return {0, 114, 178};
    case cell_code::kLmsDazzled:
      return {240, 228, 66};
    default:
      return {0, 158, 115};
  }
}

void fillCodes(DepthImage& image, const RangeImage& source) {
  image.colour.assign(source.cells(), Rgb{});
  std::map<CellCode, Rgb> present;
  for (std::size_t cell = 0; cell < source.cells(); ++cell) {
    const CellCode code = source.code(cell);
    image.value[cell] = static_cast<float>(code);
    image.colour[cell] = codeColour(code);
    present.emplace(code, codeColour(code));
  }
  for (const auto& [code, colour] : present) image.legend.emplace_back(cellCodeText(code), colour);
}

DepthImage emptyImage(const RangeImage& source, const ScannerGeometry& geometry, DepthQuantity quantity) {
  static const std::array<const char*, 9> titles = {"Range",
                                                    "Range, 3 × 3 median",
                                                    "Range, planar median",
                                                    "Changed by the 3 × 3 median",
                                                    "Normal",
                                                    "Angle of incidence",
                                                    "Intensity",
                                                    "Codes",
                                                    "Residual after registration"};
  static const std::array<const char*, 9> units = {"m", "m", "m", "m", "", "°", "", "", "m"};
  DepthImage image;
  image.quantity = quantity;
  image.rows = source.rows();
  image.columns = source.columns();
  image.value.assign(source.cells(), kNothing);
  image.title = titles[static_cast<std::size_t>(quantity)];
  image.unit = units[static_cast<std::size_t>(quantity)];
  if (source.isRegular()) {
    image.azimuth = {"Azimuth (°)", geometry.azimuth_start_rad / kDegree,
                     geometry.azimuth_step_rad / kDegree};
    image.tilt = {"Tilt (°)", geometry.tilt_start_rad / kDegree, geometry.tilt_step_rad / kDegree};
  } else {
    // No geometry describes the grid: cells by number, the first at the top left as files have it.
    image.azimuth = {"Column", 0.0, 1.0};
    image.tilt = {"Row", 0.0, 1.0};
    image.regular = false;
  }
  return image;
}

}  // namespace

const std::string& depthQuantityName(DepthQuantity quantity) {
  return kNames[static_cast<std::size_t>(quantity)];
}

Result<DepthQuantity> parseDepthQuantity(const std::string& name) {
  for (const DepthQuantity quantity : kDepthQuantities)
    if (depthQuantityName(quantity) == name) return quantity;
  const std::vector<std::string> names(kNames.begin(), kNames.end());
  const auto nearest = nearestName(name, names);
  return fail(
      "there is nothing called \"" + printable(name) + "\" to show in a depth image", "quantity",
      (nearest ? "did you mean " + *nearest + "? " : std::string()) + "there are " + joined(names, ", "));
}

Result<DepthImage> depthImageOf(const RangeImagePtr& source, const ScannerGeometry& geometry,
                                DepthQuantity quantity, const std::vector<float>& residuals) {
  if (!source->isMatrix())
    return fail("the scan is an unordered cloud and has no matrix to draw", "depth image",
                "look at it in 3D, or import it from a file that keeps the scanner's grid");
  if (quantity == DepthQuantity::Intensity && !source->hasIntensity())
    return fail("the scan has no intensity", "depth image", "choose another quantity");
  if (quantity == DepthQuantity::Residual && residuals.size() != source->cells())
    return fail("the residuals of the scan are not known", "depth image",
                "register the scan, so that there are others to measure it against");
  DepthImage image = emptyImage(*source, geometry, quantity);
  switch (quantity) {
    case DepthQuantity::Range:
      fillRange(image, *source);
      break;
    case DepthQuantity::Median:
      fillRange(image, *medianFiltered(source, {}).image);
      break;
    case DepthQuantity::PlanarMedian:
      fillRange(image, *medianFiltered(source, {.window = MedianWindow::Line}).image);
      break;
    case DepthQuantity::Changed:
      fillChanged(image, source);
      break;
    case DepthQuantity::Normal:
    case DepthQuantity::Incidence:
      fillNormals(image, *source, geometry);
      break;
    case DepthQuantity::Intensity:
      for (std::size_t cell = 0; cell < source->cells(); ++cell)
        if (source->hasPoint(cell)) image.value[cell] = source->intensity(cell);
      break;
    case DepthQuantity::Code:
      fillCodes(image, *source);
      break;
    case DepthQuantity::Residual:
      fillResiduals(image, residuals);
      break;
  }
  chooseDepthEnds(image);
  if (quantity == DepthQuantity::Incidence) image.low = 0.0, image.high = 90.0;
  return image;
}

// Between these lie all but a fiftieth of the values at either end; a little apart where all are alike.
void chooseDepthEnds(DepthImage& image) {
  std::vector<float> values;
  for (const float v : image.value)
    if (std::isfinite(v)) values.push_back(v);
  if (values.empty()) return;
  image.low = static_cast<double>(quantileOf(values, 0.02));
  image.high = static_cast<double>(quantileOf(values, 0.98));
  if (image.isSigned()) {
    image.high = largestShownResidual(image.median_residual_m);
    image.low = -image.high;
  }
  if (!(image.high - image.low > 1e-6)) image.high = image.low + 1.0;
}

Rgb depthColour(double value, double low, double high) {
  return evenColour(high > low ? (value - low) / (high - low) : 0.0, 0.30, 0.92);
}

Rgb depthColour(const DepthImage& image, double value, double low, double high) {
  if (!image.isSigned()) return depthColour(value, low, high);
  return signedColour(value / std::max({std::abs(low), std::abs(high), 1e-9}));
}

RgbImage depthPicture(const DepthImage& image, double low, double high, Rgb no_data) {
  RgbImage picture(image.columns, image.rows, no_data);
  float furthest = 0.0F;
  for (const float range : image.backdrop)
    if (std::isfinite(range)) furthest = std::max(furthest, range);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.columns; ++column) {
      const std::size_t cell = image.index(row, column);
      Rgb& pixel = picture.at(image.pixelOfColumn(column), image.pixelOfRow(row));
      if (!image.mark.empty() && image.mark[cell]) {
        pixel = kChangedColour;
      } else if (!image.backdrop.empty()) {
        // Near is light: the square root keeps the far half of a long room from becoming one dark patch.
        if (!std::isfinite(image.backdrop[cell])) continue;
        const double t = std::sqrt(image.backdrop[cell] / std::max(furthest, 1e-6F));
        const auto grey = static_cast<std::uint8_t>(std::lround(205.0 - 150.0 * t));
        pixel = {grey, grey, grey};
      } else if (std::isfinite(image.value[cell])) {
        pixel = image.colour.empty() ? depthColour(image, image.value[cell], low, high) : image.colour[cell];
      }
    }
  return picture;
}

std::string cellCodeText(CellCode code) {
  switch (code) {
    case cell_code::kMeasured:
      return "measured";
    case cell_code::kReplaced:
      return "replaced by a filter";
    case cell_code::kMissing:
      return "missing in the file";
    case cell_code::kOutOfBounds:
      return "out of bounds";
    case cell_code::kMasked:
      return "the machine itself";
    case cell_code::kNotScanned:
      return "not scanned";
    case cell_code::kNoReturn:
      return "no return";
    case cell_code::kLmsFirst:
      return "beyond range (LMS 8183)";
    case cell_code::kLmsOverflow:
      return "overflow (LMS 8189)";
    case cell_code::kLmsDazzled:
      return "dazzled (LMS 8190)";
    case cell_code::kLmsNoSignal:
      return "no signal (LMS 8191)";
    default:
      return (code >= cell_code::kLmsFirst && code <= cell_code::kLmsLast ? "LMS " : "code ") +
             std::to_string(code);
  }
}

}  // namespace tiltmap
