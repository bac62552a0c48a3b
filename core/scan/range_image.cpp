#include "core/scan/range_image.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/scan/beam_tilts.h"

namespace tiltmap {

RangeImage::RangeImage(RangeImageData data) : data_(std::move(data)) {
  valid_cells_ = static_cast<std::size_t>(std::ranges::count_if(data_.code, cell_code::hasPoint));
}

Result<RangeImagePtr> RangeImage::make(RangeImageData data) {
  const auto refuse = [](std::string what) {
    return fail(std::move(what), "range image", "the data does not form a matrix; check its source");
  };
  if (data.rows < 1 || data.columns < 1) return refuse("a range image needs at least one row and one column");
  const std::size_t cells = data.cells();
  const auto rows = static_cast<std::size_t>(data.rows);
  if (data.range_m.size() != cells || data.code.size() != cells)
    return refuse("ranges or codes do not fill the matrix");
  if (!data.intensity.empty() && data.intensity.size() != cells)
    return refuse("intensities do not fill the matrix");
  if (!data.direction.empty() && data.direction.size() != cells)
    return refuse("directions do not fill the matrix");
  // As many again where the tilt moved on during the lines (beam_tilts.h).
  if (data.line_tilt_rad.size() != rows && data.line_tilt_rad.size() != 2 * rows)
    return refuse("there is not one tilt angle for every line");
  if (!data.line_time_s.empty() && data.line_time_s.size() != rows)
    return refuse("there is not one time for every line");
  for (const double tilt : data.line_tilt_rad)
    if (!std::isfinite(tilt)) return refuse("a tilt angle is not finite");
  for (const double time : data.line_time_s)
    if (!std::isfinite(time)) return refuse("the time of a line is not finite");
  for (std::size_t i = 0; i < cells; ++i) {
    if (!cell_code::hasPoint(data.code[i])) {
      data.range_m[i] = 0.0F;
      if (!data.direction.empty()) data.direction[i].setZero();
      continue;
    }
    if (!(data.range_m[i] > 0.0F) || !std::isfinite(data.range_m[i]))
      return refuse("cell " + std::to_string(i) + " claims a point but has no positive range");
    if (!data.direction.empty() && !(std::abs(data.direction[i].norm() - 1.0F) < 1e-3F))
      return refuse("the direction of cell " + std::to_string(i) + " is not a unit vector");
  }
  return RangeImagePtr(new RangeImage(std::move(data)));
}

int RangeImage::scannedLines() const {
  int lines = 0;
  for (int row = 0; row < rows(); ++row) {
    const auto first = data_.code.begin() + static_cast<std::ptrdiff_t>(index(row, 0));
    if (std::any_of(first, first + columns(), [](CellCode c) { return c != cell_code::kNotScanned; }))
      ++lines;
  }
  return lines;
}

Eigen::Vector3d cellPoint(const RangeImage& image, const ScannerGeometry& geometry, int row, int column) {
  const std::size_t cell = image.index(row, column);
  if (!image.isRegular())
    return image.directions()[cell].cast<double>() * static_cast<double>(image.range(cell));
  return geometry.point(beamTilt(image, geometry, row, column), geometry.azimuthOfColumn(column),
                        static_cast<double>(image.range(cell)));
}

std::vector<Eigen::Vector3d> cellPoints(const RangeImage& image, const ScannerGeometry& geometry) {
  std::vector<Eigen::Vector3d> points(image.cells(), Eigen::Vector3d::Zero());
  const auto columns = static_cast<std::size_t>(image.columns());
  std::vector<Eigen::Vector3d> beams;  // in the tilting frame, one a column
  if (image.isRegular()) {
    for (int column = 0; column < image.columns(); ++column) {
      const double a = geometry.azimuthOfColumn(column);
      beams.push_back(geometry.mounting * Eigen::Vector3d(std::cos(a), std::sin(a), 0.0));
    }
  }
  const bool moved = tiltMoved(image) && image.isRegular();
  std::optional<BeamTilts> tilts;
  if (moved) tilts.emplace(image, geometry);
  for (int row = 0; row < image.rows(); ++row) {
    const double e = image.lineTilt(row) + geometry.tilt_zero_rad;
    double c = std::cos(e), s = std::sin(e);
    if (moved) tilts->setRow(row);
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row) * columns + column;
      if (!image.hasPoint(cell)) continue;
      const double range = static_cast<double>(image.range(cell));
      if (!image.isRegular()) {
        points[cell] = image.directions()[cell].cast<double>() * range;
        continue;
      }
      if (moved) c = tilts->cosine(column), s = tilts->sine(column);
      const Eigen::Vector3d v = geometry.lever_arm_m + (range + geometry.range_offset_m) * beams[column];
      points[cell] = {v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z()};
    }
  }
  return points;
}

}  // namespace tiltmap
