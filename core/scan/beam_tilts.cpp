#include "core/scan/beam_tilts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/geometry/pose.h"

namespace tiltmap {

int mirrorTurns(const ScannerGeometry& geometry) {
  constexpr double kWholeDegree = kDegree, kWidestInterlacedRad = 181.0 * kDegree;
  if (std::abs(geometry.azimuth_step_rad) * (geometry.columns - 1) > kWidestInterlacedRad) return 1;
  return std::max(1, static_cast<int>(std::lround(kWholeDegree / std::abs(geometry.azimuth_step_rad))));
}

double beamTurns(const ScannerGeometry& geometry, int column) {
  const double way = std::abs(geometry.azimuth_step_rad) * column;  // the mirror's, from the first beam
  return column % mirrorTurns(geometry) + way / (2.0 * std::numbers::pi);
}

bool tiltMoved(const RangeImage& image) {
  return image.data().line_tilt_rad.size() > static_cast<std::size_t>(image.rows());
}

double lineTurnTilt(const RangeImage& image, int row) {
  return tiltMoved(image) ? image.data().line_tilt_rad[static_cast<std::size_t>(image.rows() + row)] : 0.0;
}

double beamTilt(const RangeImage& image, const ScannerGeometry& geometry, int row, int column) {
  const double way = lineTurnTilt(image, row);
  if (way == 0.0) return image.lineTilt(row);
  return image.lineTilt(row) + way * (beamTurns(geometry, column) - mirrorTurns(geometry));
}

void setTurnTilts(RangeImageData& data, const std::vector<double>& turn_tilt_rad) {
  const auto rows = static_cast<std::size_t>(data.rows);
  if (turn_tilt_rad.size() != rows || data.line_tilt_rad.size() < rows)
    throw std::invalid_argument("setTurnTilts: one entry a row, and the tilts of the lines first");
  data.line_tilt_rad.resize(rows);
  if (std::ranges::all_of(turn_tilt_rad, [](double way) { return way == 0.0; })) return;
  data.line_tilt_rad.insert(data.line_tilt_rad.end(), turn_tilt_rad.begin(), turn_tilt_rad.end());
}

Result<RangeImagePtr> withoutBeamTilts(const RangeImage& image, const ScannerGeometry& geometry) {
  RangeImageData data = image.data();
  data.line_tilt_rad.resize(static_cast<std::size_t>(data.rows));
  for (int row = 0; row < data.rows; ++row)
    data.line_tilt_rad[static_cast<std::size_t>(row)] -=
        0.5 * mirrorTurns(geometry) * lineTurnTilt(image, row);
  return RangeImage::make(std::move(data));
}

BeamTilts::BeamTilts(const RangeImage& image, const ScannerGeometry& geometry)
    : image_(image), tilt_zero_rad_(geometry.tilt_zero_rad) {
  const auto columns = static_cast<std::size_t>(image.columns());
  const double line = mirrorTurns(geometry);
  for (std::size_t k = 0; k < columns; ++k) turns_.push_back(beamTurns(geometry, static_cast<int>(k)) - line);
  offset_cosine_.assign(columns, 1.0);
  offset_sine_.assign(columns, 0.0);
  cosine_.resize(columns);
  sine_.resize(columns);
}

void BeamTilts::setRow(int row) {
  const double way = lineTurnTilt(image_, row);
  if (way != way_rad_) {
    way_rad_ = way;
    for (std::size_t k = 0; k < turns_.size(); ++k) {
      offset_cosine_[k] = std::cos(way * turns_[k]);
      offset_sine_[k] = std::sin(way * turns_[k]);
    }
  }
  const double e = image_.lineTilt(row) + tilt_zero_rad_;
  const double c = std::cos(e), s = std::sin(e);
  for (std::size_t k = 0; k < turns_.size(); ++k) {
    cosine_[k] = c * offset_cosine_[k] - s * offset_sine_[k];
    sine_[k] = s * offset_cosine_[k] + c * offset_sine_[k];
  }
}

}  // namespace tiltmap
