#include "core/calibration/scanner_errors.h"

#include <algorithm>
#include <cmath>

#include "core/base/parameter.h"
#include "core/base/text.h"
#include "core/geometry/pose.h"

namespace tiltmap {

std::string scannerErrorName(ScannerError error) {
  switch (error) {
    case ScannerError::TiltZero:
      return "tilt zero";
    case ScannerError::LeverX:
      return "lever arm x";
    case ScannerError::LeverY:
      return "lever arm y";
    case ScannerError::LeverZ:
      return "lever arm z";
    case ScannerError::MountingX:
      return "mounting x";
    case ScannerError::MountingY:
      return "mounting y";
    case ScannerError::MountingZ:
      return "mounting z";
    case ScannerError::RangeOffset:
      return "range offset";
  }
  return "?";
}

bool isAngle(ScannerError error) {
  return error == ScannerError::TiltZero || error == ScannerError::MountingX ||
         error == ScannerError::MountingY || error == ScannerError::MountingZ;
}

Result<ErrorVector> parseScannerErrors(const std::string& text, const std::string& where) {
  constexpr double kMost_deg = 10.0, kMost_m = 1.0;
  std::vector<std::string> names;
  for (const ScannerError error : kAllScannerErrors) {
    std::string name = scannerErrorName(error);
    std::ranges::replace(name, ' ', '-');
    names.push_back(std::move(name));
  }
  ErrorVector errors = ErrorVector::Zero();
  if (trimmed(text).empty()) return errors;
  std::vector<bool> named(names.size(), false);
  for (const std::string_view part : splitAt(text, ',')) {
    const auto sides = splitAt(part, '=');
    const std::string name(trimmed(sides.front()));
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return fail(unknownParameter(name, names, where));
    const auto k = static_cast<std::size_t>(found - names.begin());
    const bool angle = isAngle(kAllScannerErrors[k]);
    const auto value = sides.size() == 2 ? parseReal(trimmed(sides[1])) : std::nullopt;
    if (!value || !(std::abs(*value) <= (angle ? kMost_deg : kMost_m)) || named[k])
      return fail("\"" + std::string(trimmed(part)) + "\" is no error of a scanner", where,
                  "give each once, such as tilt-zero=0.5,range-offset=0.03: up to 10 degrees and 1 metre");
    named[k] = true;
    errors[static_cast<Eigen::Index>(k)] = *value * (angle ? kDegree : 1.0);
  }
  return errors;
}

ErrorVector errorsOf(const ScannerGeometry& geometry) {
  ErrorVector errors;
  errors << geometry.tilt_zero_rad, geometry.lever_arm_m, rotationLog(geometry.mounting),
      geometry.range_offset_m;
  return errors;
}

ScannerGeometry corrected(const ScannerGeometry& geometry, const ErrorVector& change) {
  ScannerGeometry result = geometry;
  result.tilt_zero_rad += change[0];
  result.lever_arm_m += change.segment<3>(1);
  result.mounting = (rotationExp(change.segment<3>(4)) * geometry.mounting).normalized();
  result.range_offset_m += change[7];
  return result;
}

std::optional<Eigen::Matrix<double, 3, kScannerErrors>> errorMotions(const ScannerGeometry& geometry,
                                                                     const Eigen::Vector3d& point_m) {
  const auto place = geometry.place(point_m);
  if (!place) return std::nullopt;
  const double tilt = geometry.tilt_start_rad + place->row * geometry.tilt_step_rad + geometry.tilt_zero_rad;
  const Eigen::Matrix3d b = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Vector3d v = b.transpose() * point_m - geometry.lever_arm_m;
  Eigen::Matrix<double, 3, kScannerErrors> motions;
  motions.col(0) = Eigen::Vector3d::UnitX().cross(point_m);
  motions.middleCols<3>(1) = b;
  for (int axis = 0; axis < 3; ++axis) motions.col(4 + axis) = b * Eigen::Vector3d::Unit(axis).cross(v);
  motions.col(7) = b * v.normalized();
  return motions;
}

}  // namespace tiltmap
