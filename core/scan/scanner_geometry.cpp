#include "core/scan/scanner_geometry.h"

#include <algorithm>
#include <cmath>

namespace tiltmap {

namespace {
Eigen::Vector3d tilted(const Eigen::Vector3d& v, double tilt_rad) {
  const double c = std::cos(tilt_rad), s = std::sin(tilt_rad);
  return {v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z()};
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
  // Undo the tilt, then lever arm and mounting: the beam plane is z = 0 there. Without calibration the tilt
  // is the polar angle of (y, z); otherwise find the tilt that brings the point into the beam plane, by
  // Newton.
  const double across = std::hypot(point_m.y(), point_m.z());
  const Eigen::Quaterniond unmount = mounting.conjugate();
  const auto inBeamFrame = [&](double e) {
    return Eigen::Vector3d(unmount * (tilted(point_m, -e) - lever_arm_m));
  };
  double e = across > 0.0 ? std::atan2(point_m.z(), point_m.y()) : 0.0;
  if (across > 0.0) {
    bool settled = false;
    for (int step = 0; step < 30 && !settled; ++step) {
      const double off = inBeamFrame(e).z();
      const double h = 1e-6;
      const double slope = (inBeamFrame(e + h).z() - inBeamFrame(e - h).z()) / (2.0 * h);
      if (std::abs(off) < 1e-12 * (1.0 + across)) {
        settled = true;
      } else {
        if (std::abs(slope) < 1e-9) return std::nullopt;
        e -= std::clamp(off / slope, -0.5, 0.5);
      }
    }
    if (!settled && std::abs(inBeamFrame(e).z()) > 1e-9 * (1.0 + across)) return std::nullopt;
  }
  const Eigen::Vector3d beam = inBeamFrame(e);
  const double range = std::hypot(beam.x(), beam.y());
  if (!(range > 0.0)) return std::nullopt;
  const double azimuth = std::atan2(beam.y(), beam.x());
  return MatrixPlace{(e - tilt_zero_rad - tilt_start_rad) / tilt_step_rad,
                     (azimuth - azimuth_start_rad) / azimuth_step_rad, range - range_offset_m};
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
  if (!lever_arm_m.allFinite() || !mounting.coeffs().allFinite() || std::abs(mounting.norm() - 1.0) > 1e-6)
    return bad("lever arm or mounting rotation is not usable", "give finite values and a unit quaternion");
  return {};
}

}  // namespace tiltmap
