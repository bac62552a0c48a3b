// The scanner's intrinsic errors as unknowns: what they are called, and how points move with them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/scan/scanner_geometry.h"

namespace tiltmap {

// Calibration members of ScannerGeometry, one number each. Lever arm and mounting are given in the tilting
// frame, whose x axis is the tilt axis.
enum class ScannerError {
  TiltZero,
  LeverX,
  LeverY,
  LeverZ,
  MountingX,  // rotation vector
  MountingY,
  MountingZ,
  RangeOffset,
};
inline constexpr int kScannerErrors = 8;
inline constexpr std::array<ScannerError, kScannerErrors> kAllScannerErrors{
    ScannerError::TiltZero,  ScannerError::LeverX,    ScannerError::LeverY,    ScannerError::LeverZ,
    ScannerError::MountingX, ScannerError::MountingY, ScannerError::MountingZ, ScannerError::RangeOffset};

// radians or metres, in the order of ScannerError.
using ErrorVector = Eigen::Matrix<double, kScannerErrors, 1>;
using ErrorMatrix = Eigen::Matrix<double, kScannerErrors, kScannerErrors>;

std::string scannerErrorName(ScannerError error);  // "lever arm y"; stable
bool isAngle(ScannerError error);

// "tilt-zero=0.5,lever-arm-y=0.05": names with hyphens; degrees and metres outside, radians and metres
// inside. Nothing named is zero. Error: a name that is none, a number that is none or too large, a name
// twice.
Result<ErrorVector> parseScannerErrors(const std::string& text, const std::string& where);

ErrorVector errorsOf(const ScannerGeometry& geometry);
// A small change added; that of the mounting is a rotation after it (in the tilting frame).
ScannerGeometry corrected(const ScannerGeometry& geometry, const ErrorVector& change);

// Derivative of a point of the scan frame by each of the errors, the scanner's reading held: a column each (m
// per rad or m). From ScannerGeometry's equation, with B = Rx(e + tilt_zero) and v the beam in the tilting
// frame: x cross p; B; B (axis cross v); B v / |v|. Nothing for a point that no beam reaches.
std::optional<Eigen::Matrix<double, 3, kScannerErrors>> errorMotions(const ScannerGeometry& geometry,
                                                                     const Eigen::Vector3d& point_m);

}  // namespace tiltmap
