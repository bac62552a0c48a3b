#include "ui/scene/scan_points.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/scan/normals.h"
#include "core/scan/reduction.h"

namespace tiltmap::ui {

namespace {

const std::array<std::string, 6> kNames = {"scan", "height", "range", "intensity", "normal", "age"};

void add(ScanPoints& to, const Eigen::Vector3d& point, std::size_t cell) {
  for (int axis = 0; axis < 3; ++axis) to.xyz.push_back(static_cast<float>(point[axis]));
  to.cell.push_back(static_cast<std::uint32_t>(cell));
}

}  // namespace

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
  static const std::array<const char*, 6> titles = {"Scan",      "Height (m)",           "Range (m)",
                                                    "Intensity", "Direction of normals", "Age (s)"};
  return titles[static_cast<std::size_t>(colouring)];
}

Result<ScanPoints> scanPointsOf(const ScanEntry& scan, bool reduced) {
  const auto image = scan.image();
  if (!image) return fail(image.error());
  const RangeImage& matrix = **image;
  ScanPoints result;
  result.scan = scan.id;
  result.matrix = scan.matrix;
  result.geometry = scan.geometry_id;
  result.reduced = reduced;
  result.columns = matrix.columns();
  result.line_time_s = matrix.data().line_time_s;
  const std::vector<Eigen::Vector3d> points = cellPoints(matrix, scan.geometry);
  if (reduced) {
    const PointCloud cloud = reducedAlongLines(matrix, points, {}, kReducedDistance_m);
    for (std::size_t i = 0; i < cloud.size(); ++i) add(result, cloud.points[i], cloud.cell[i]);
    result.intensity = cloud.intensity;
    return result;
  }
  result.xyz.reserve(3 * matrix.validCells());
  result.cell.reserve(matrix.validCells());
  for (std::size_t cell = 0; cell < matrix.cells(); ++cell) {
    if (!matrix.hasPoint(cell)) continue;
    add(result, points[cell], cell);
    if (matrix.hasIntensity()) result.intensity.push_back(matrix.intensity(cell));
  }
  return result;
}

void addNormals(ScanPoints& points, const ScanEntry& scan) {
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
  if (colouring == SceneColouring::Scan || colouring == SceneColouring::Normal) return values;
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
  const double share = colouring == SceneColouring::Age ? 0.0 : 0.02;
  const auto at = [&](double s) {
    const auto k = static_cast<std::ptrdiff_t>(s * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return static_cast<double>(values[static_cast<std::size_t>(k)]);
  };
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
