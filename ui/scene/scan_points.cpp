#include "ui/scene/scan_points.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/products/residuals.h"
#include "core/scan/normals.h"
#include "core/scan/reduction.h"

namespace tiltmap::ui {

namespace {

const std::array<std::string, 7> kNames = {"scan",   "height", "range",   "intensity",
                                           "normal", "age",    "residual"};

void add(ScanPoints& to, const Eigen::Vector3d& point, std::size_t cell) {
  for (int axis = 0; axis < 3; ++axis) to.xyz.push_back(static_cast<float>(point[axis]));
  to.cell.push_back(static_cast<std::uint32_t>(cell));
}

// The bits of row and column in turn, the lowest first: counting up through the numbers of a grid's cells
// made like this visits first every 2^k-th row and column, then the rows and columns between them.
double spreadOfCell(std::uint32_t row, std::uint32_t column) {
  std::uint64_t bits = 0;
  for (int k = 0; k < 16; ++k)
    bits = bits << 2 | static_cast<std::uint64_t>((row >> k & 1U) << 1 | ((row ^ column) >> k & 1U));
  return (static_cast<double>(bits) + 0.5) / 4294967296.0;
}

// The same of one number.
double spreadOfNumber(std::uint32_t number) {
  std::uint32_t bits = 0;
  for (int k = 0; k < 32; ++k) bits = bits << 1 | (number >> k & 1U);
  return (static_cast<double>(bits) + 0.5) / 4294967296.0;
}

template <class Value>
void permute(std::vector<Value>& values, const std::vector<std::uint32_t>& order, std::size_t width) {
  if (values.empty()) return;
  std::vector<Value> result;
  result.reserve(values.size());
  for (const std::uint32_t i : order)
    for (std::size_t k = 0; k < width; ++k) result.push_back(values[width * i + k]);
  values = std::move(result);
}

}  // namespace

std::size_t ScanPoints::countAtDensity(double wanted) const {
  if (size() == 0 || density.empty()) return size();
  const auto above = std::upper_bound(density.begin(), density.end(), wanted);
  if (above == density.begin()) return 0;
  if (above == density.end()) return size();
  const auto step = static_cast<double>(above - density.begin()) - 1.0;
  const double low = *(above - 1), part = (wanted - low) / std::max(*above - low, 1e-300);
  return static_cast<std::size_t>((step + part) / static_cast<double>(density.size() - 1) *
                                  static_cast<double>(size()));
}

void orderEvenly(ScanPoints& points, bool is_matrix, bool is_regular) {
  const std::size_t count = points.size();
  if (count == 0) return;
  // A point stands for the surface between it and its neighbours: one of the far ones for more of it than one
  // of the near ones. It is due when so many points a square metre are wanted that its number, which is
  // spread evenly over the cells, comes up.
  std::vector<std::pair<double, std::uint32_t>> due(count);
  const auto columns = static_cast<std::uint32_t>(std::max(1, points.columns));
  for (std::size_t i = 0; i < count; ++i) {
    const float* p = points.xyz.data() + 3 * i;
    const double squared = static_cast<double>(p[0]) * p[0] + static_cast<double>(p[1]) * p[1] +
                           static_cast<double>(p[2]) * p[2];
    const double range = std::clamp(std::sqrt(squared), 0.5, 40.0);
    double area = 1.0, number = 0.0;
    if (is_matrix) {
      number = spreadOfCell(points.cell[i] / columns, points.cell[i] % columns);
      // The lines of a tilting scanner meet at the ends of its axis, which is x.
      const double off_axis = std::hypot(static_cast<double>(p[1]), static_cast<double>(p[2])) /
                              std::max(std::sqrt(squared), 1e-9);
      area = range * range * (is_regular ? std::max(off_axis, 0.05) : 1.0);
    } else {
      number = spreadOfNumber(points.cell[i]);
    }
    due[i] = {number / area, static_cast<std::uint32_t>(i)};
  }
  std::sort(due.begin(), due.end());
  std::vector<std::uint32_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = due[i].second;
  permute(points.xyz, order, 3);
  permute(points.cell, order, 1);
  permute(points.intensity, order, 1);
  permute(points.normal, order, 3);
  points.density.resize(257);
  for (std::size_t k = 0; k < points.density.size(); ++k)
    points.density[k] = due[std::min(count - 1, k * count / 256)].first;
}

const std::string& sceneColouringName(SceneColouring colouring) {
  return kNames[static_cast<std::size_t>(colouring)];
}

Result<SceneColouring> parseSceneColouring(const std::string& name) {
  for (const SceneColouring colouring : kSceneColourings)
    if (sceneColouringName(colouring) == name) return colouring;
  const std::vector<std::string> names(kNames.begin(), kNames.end());
  const auto nearest = nearestName(name, names);
  return fail(
      "points cannot be coloured by \"" + printable(name) + "\"", "--colour",
      (nearest ? "did you mean " + *nearest + "? " : std::string()) + "there are " + joined(names, ", "));
}

std::string sceneColouringTitle(SceneColouring colouring) {
  static const std::array<const char*, 7> titles = {
      "Scan", "Height (m)", "Range (m)", "Intensity", "Direction of normals", "Age (s)", "Residual (m)"};
  return titles[static_cast<std::size_t>(colouring)];
}

Result<ScanPoints> scanPointsOf(const ScanEntry& scan, bool reduced) {
  const auto image = scan.image();
  if (!image) return fail(image.error());
  const RangeImage& matrix = **image;
  ScanPoints result;
  result.scan = scan.id;
  result.matrix = scan.matrix;
  result.lines = scan.lines;
  result.geometry = scan.geometry_id;
  result.reduced = reduced;
  result.columns = matrix.columns();
  result.line_time_s = matrix.data().line_time_s;
  const std::vector<Eigen::Vector3d> points = cellPoints(matrix, scan.geometry);
  if (reduced) {
    const PointCloud cloud = reducedAlongLines(matrix, points, {}, kReducedDistance_m);
    for (std::size_t i = 0; i < cloud.size(); ++i) add(result, cloud.points[i], cloud.cell[i]);
    result.intensity = cloud.intensity;
    orderEvenly(result, matrix.isMatrix(), matrix.isRegular());
    return result;
  }
  result.xyz.reserve(3 * matrix.validCells());
  result.cell.reserve(matrix.validCells());
  for (std::size_t cell = 0; cell < matrix.cells(); ++cell) {
    if (!matrix.hasPoint(cell)) continue;
    add(result, points[cell], cell);
    if (matrix.hasIntensity()) result.intensity.push_back(matrix.intensity(cell));
  }
  orderEvenly(result, matrix.isMatrix(), matrix.isRegular());
  return result;
}

PointsKey keyOf(const PointsWanted& wanted) {
  return {wanted.scan.id,          wanted.scan.matrix, wanted.scan.lines,
          wanted.scan.geometry_id, wanted.reduced,     wanted.normals};
}

PointsKey keyOf(const ScanPoints& points) {
  return {points.scan, points.matrix, points.lines, points.geometry, points.reduced, points.with_normals};
}

Result<ScanPoints> readPoints(const PointsWanted& wanted, const std::stop_token& stop) {
  auto points = scanPointsOf(wanted.scan, wanted.reduced);
  if (points && wanted.normals && !stop.stop_requested()) addNormals(*points, wanted.scan);
  return points;
}

void addNormals(ScanPoints& points, const ScanEntry& scan) {
  points.with_normals = true;
  if (!points.normal.empty() || points.size() == 0) return;
  points.normal.assign(points.xyz.size(), 0.0F);
  const auto image = scan.image();
  if (!image) return;  // told when the points were read
  const auto normals = matrixNormals(**image, cellPoints(**image, scan.geometry));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      points.normal[3 * i + static_cast<std::size_t>(axis)] =
          static_cast<float>(normals[points.cell[i]][axis]);
}

std::vector<float> colourValues(const ScanPoints& points, SceneColouring colouring,
                                const Pose& world_from_scan, std::size_t index,
                                std::optional<double> first_time_s) {
  std::vector<float> values;
  if (colouring == SceneColouring::Intensity) return points.intensity;
  if (colouring == SceneColouring::Scan || colouring == SceneColouring::Normal ||
      colouring == SceneColouring::Residual)
    return values;
  values.reserve(points.size());
  const Eigen::RowVector3d up = world_from_scan.rotation().row(2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p(points.xyz[3 * i], points.xyz[3 * i + 1], points.xyz[3 * i + 2]);
    double value = 0.0;
    if (colouring == SceneColouring::Height) value = up * p + world_from_scan.translation().z();
    if (colouring == SceneColouring::Range) value = p.norm();
    if (colouring == SceneColouring::Age) {
      const std::size_t row = points.cell[i] / static_cast<std::uint32_t>(std::max(1, points.columns));
      value = first_time_s && row < points.line_time_s.size() ? points.line_time_s[row] - *first_time_s
                                                              : static_cast<double>(index);
    }
    values.push_back(static_cast<float>(value));
  }
  return values;
}

ColourRange colourRangeOf(std::vector<float> values, SceneColouring colouring) {
  std::erase_if(values, [](float v) { return !std::isfinite(v); });
  if (values.empty()) return {};
  if (colouring == SceneColouring::Residual) {
    for (float& v : values) v = std::abs(v);
    const double high = largestShownResidual(static_cast<double>(medianOf(std::move(values))));
    return {-high, high, true};
  }
  const double share = colouring == SceneColouring::Age ? 0.0 : 0.02;
  const auto at = [&](double s) { return static_cast<double>(quantileOf(values, s)); };
  ColourRange range{at(share), at(1.0 - share), true};
  if (!(range.high - range.low > 1e-6)) range.high = range.low + 1.0;
  return range;
}

std::vector<std::uint32_t> evenlyStrided(std::size_t size, std::size_t count) {
  count = std::min(size, count);
  std::vector<std::uint32_t> chosen(count);
  for (std::size_t k = 0; k < count; ++k)
    chosen[k] = static_cast<std::uint32_t>((2 * k + 1) * size / (2 * count));
  return chosen;
}

}  // namespace tiltmap::ui
