#include "core/scan/scanner_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tiltmap {

namespace {
Eigen::Vector3d tilted(const Eigen::Vector3d& v, double tilt_rad) {
  const double c = std::cos(tilt_rad), s = std::sin(tilt_rad);
  return {v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z()};
}

// Whole turns added until the index is as near to the middle of the matrix as it can be.
double nearestTurn(double index, double step_rad, int count) {
  const double turn = 2.0 * std::numbers::pi / std::abs(step_rad);
  return index - turn * std::round((index - 0.5 * (count - 1)) / turn);
}

// How far a place lies outside the matrix, radians.
double outside(const ScannerGeometry& geometry, const MatrixPlace& place) {
  const auto beyond = [](double index, int count) { return std::max({-index, index - (count - 1), 0.0}); };
  return beyond(place.row, geometry.rows) * std::abs(geometry.tilt_step_rad) +
         beyond(place.column, geometry.columns) * std::abs(geometry.azimuth_step_rad);
}
}  // namespace

Eigen::Vector3d ScannerGeometry::direction(double tilt_rad, double azimuth_rad) const {
  return tilted(mounting * Eigen::Vector3d(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0),
                tilt_rad + tilt_zero_rad);
}

Eigen::Vector3d ScannerGeometry::point(double tilt_rad, double azimuth_rad, double range_m) const {
  const Eigen::Vector3d beam = mounting * Eigen::Vector3d(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0);
  return tilted(lever_arm_m + (range_m + range_offset_m) * beam, tilt_rad + tilt_zero_rad);
}

std::optional<MatrixPlace> ScannerGeometry::place(const Eigen::Vector3d& point_m) const {
  if (!point_m.allFinite()) return std::nullopt;
  // The tilt e brings the beam plane, normal n in the tilting frame, onto the point: n . (Rx(-e) p -
  // lever_arm) = 0, which is a cos e + b sin e = d, with none, one or two solutions.
  const Eigen::Vector3d n = mounting * Eigen::Vector3d::UnitZ();
  const double a = n.y() * point_m.y() + n.z() * point_m.z();
  const double b = n.y() * point_m.z() - n.z() * point_m.y();
  const double d = n.dot(lever_arm_m) - n.x() * point_m.x();
  const double reach = std::hypot(a, b);
  const double rounding = 1e-12 * (1.0 + point_m.norm() + lever_arm_m.norm());
  if (std::abs(d) > reach + rounding) return std::nullopt;
  if (reach <= rounding)
    return placeAtTilt(tiltOfRow(0) + 0.5 * (rows - 1) * tilt_step_rad + tilt_zero_rad, point_m);

  const double middle = std::atan2(b, a);
  const double aside = std::acos(std::clamp(d / reach, -1.0, 1.0));
  // Of the two the one inside the matrix or nearer to it.
  const auto first = placeAtTilt(middle + aside, point_m);
  const auto second = placeAtTilt(middle - aside, point_m);
  if (!first || !second) return first ? first : second;
  return outside(*this, *second) < outside(*this, *first) ? second : first;
}

std::optional<MatrixPlace> ScannerGeometry::placeAtTilt(double tilt_rad,
                                                        const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d beam = mounting.conjugate() * (tilted(point_m, -tilt_rad) - lever_arm_m);
  const double from_mirror = std::hypot(beam.x(), beam.y());
  const double range = from_mirror - range_offset_m;
  if (!(from_mirror > 1e-9) || !(range > 0.0)) return std::nullopt;
  return MatrixPlace{
      nearestTurn((tilt_rad - tilt_zero_rad - tilt_start_rad) / tilt_step_rad, tilt_step_rad, rows),
      nearestTurn((std::atan2(beam.y(), beam.x()) - azimuth_start_rad) / azimuth_step_rad, azimuth_step_rad,
                  columns),
      range};
}

Status ScannerGeometry::check() const {
  const auto bad = [](const char* what, const char* remedy) {
    return fail(what, "scanner geometry", remedy);
  };
  if (rows < 1 || columns < 1 || static_cast<long long>(rows) * columns > 100'000'000)
    return bad("the matrix has no cells or too many", "give 1 to 100 million cells");
  if (azimuth_step_rad == 0.0 || tilt_step_rad == 0.0)
    return bad("an angular step is zero", "give both steps");
  for (const double value : {azimuth_start_rad, azimuth_step_rad, tilt_start_rad, tilt_step_rad,
                             tilt_zero_rad, range_offset_m, minimum_range_m, maximum_range_m})
    if (!std::isfinite(value)) return bad("a value is not finite", "give numbers");
  if (minimum_range_m < 0.0 || maximum_range_m < 0.0 ||
      (maximum_range_m > 0.0 && maximum_range_m <= minimum_range_m))
    return bad("the bounds of the range leave nothing", "give a maximum above the minimum, or 0 for none");
  if (!lever_arm_m.allFinite() || !mounting.coeffs().allFinite() || std::abs(mounting.norm() - 1.0) > 1e-6)
    return bad("lever arm or mounting rotation is not usable", "give finite values and a unit quaternion");
  return {};
}

}  // namespace tiltmap
