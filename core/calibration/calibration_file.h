// A calibration as text: for scripts, for keeping, and for giving to other surveys of the same scanner.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/calibration/calibrate.h"

namespace tiltmap {

// Which members of ScannerGeometry a calibration gives; the others are left alone.
void takeCalibration(const ScannerGeometry& from, ScannerGeometry& to);
bool sameCalibration(const ScannerGeometry& a, const ScannerGeometry& b);

// Estimates (rad, m) with deviations and reasons, geometry, residuals and counts.
nlohmann::json calibrationJson(const Calibration& calibration);
// The same with format, date (UTC, ISO 8601), program version and the names of the scans: the text of a file.
std::string calibrationText(const Calibration& calibration, const std::vector<std::string>& scan_names,
                            const std::string& date);
// The calibrated members of a file written so, in a geometry otherwise default. Error: not readable, of
// another kind, or values that no scanner has.
Result<ScannerGeometry> readCalibration(const std::filesystem::path& path);

}  // namespace tiltmap
