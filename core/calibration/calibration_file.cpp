#include "core/calibration/calibration_file.h"

#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/version.h"
#include "core/io/file_bytes.h"

namespace tiltmap {

namespace {

constexpr const char* kFormat = "tiltmap calibration 1";

const char* stateName(EstimateState state) {
  switch (state) {
    case EstimateState::Estimated:
      return "estimated";
    case EstimateState::Held:
      return "held";
    case EstimateState::Undefined:
      return "undefined";
    case EstimateState::Weak:
      return "weak";
  }
  return "?";
}

nlohmann::json geometryJson(const ScannerGeometry& g) {
  return {{"tilt_zero_rad", g.tilt_zero_rad},
          {"lever_arm_m", {g.lever_arm_m.x(), g.lever_arm_m.y(), g.lever_arm_m.z()}},
          {"mounting_xyzw", {g.mounting.x(), g.mounting.y(), g.mounting.z(), g.mounting.w()}},
          {"range_offset_m", g.range_offset_m}};
}

}  // namespace

void takeCalibration(const ScannerGeometry& from, ScannerGeometry& to) {
  to.tilt_zero_rad = from.tilt_zero_rad;
  to.lever_arm_m = from.lever_arm_m;
  to.mounting = from.mounting;
  to.range_offset_m = from.range_offset_m;
}

bool sameCalibration(const ScannerGeometry& a, const ScannerGeometry& b) {
  return a.tilt_zero_rad == b.tilt_zero_rad && a.lever_arm_m == b.lever_arm_m &&
         a.mounting.coeffs() == b.mounting.coeffs() && a.range_offset_m == b.range_offset_m;
}

nlohmann::json calibrationJson(const Calibration& calibration) {
  nlohmann::json json = {{"scans", calibration.scans},
                         {"links", calibration.links},
                         {"patches", calibration.patches},
                         {"ground_stops", calibration.ground_stops},
                         {"iterations", calibration.iterations},
                         {"residual_before_m", calibration.residual_before_m},
                         {"residual_after_m", calibration.residual_after_m},
                         {"geometry", geometryJson(calibration.geometry)},
                         {"estimates", nlohmann::json::array()}};
  for (const ErrorEstimate& e : calibration.estimates)
    json["estimates"].push_back({{"name", scannerErrorName(e.error)},
                                 {"unit", isAngle(e.error) ? "rad" : "m"},
                                 {"state", stateName(e.state)},
                                 {"before", e.before},
                                 {"value", e.value},
                                 {"deviation", e.deviation},
                                 {"reason", e.reason}});
  return json;
}

std::string calibrationText(const Calibration& calibration, const std::vector<std::string>& scan_names,
                            const std::string& date) {
  nlohmann::json json = calibrationJson(calibration);
  json["format"] = kFormat;
  json["date"] = date;
  json["program_version"] = programVersion();
  json["scan_names"] = scan_names;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Result<ScannerGeometry> readCalibration(const std::filesystem::path& path) {
  const auto bytes = fileBytes(path);
  if (!bytes) return fail(bytes.error());
  const auto refuse = [&](const std::string& what) {
    return fail(what, path.string(), "name a file that `tiltmap calibrate --out` has written");
  };
  const nlohmann::json json = nlohmann::json::parse(*bytes, nullptr, false);
  if (!json.is_object() || json.value("format", nlohmann::json()) != kFormat)
    return refuse("this is no calibration");
  ScannerGeometry geometry;
  try {
    const nlohmann::json& g = json.at("geometry");
    geometry.tilt_zero_rad = g.at("tilt_zero_rad").get<double>();
    geometry.range_offset_m = g.at("range_offset_m").get<double>();
    const auto arm = g.at("lever_arm_m").get<std::array<double, 3>>();
    const auto q = g.at("mounting_xyzw").get<std::array<double, 4>>();
    geometry.lever_arm_m = {arm[0], arm[1], arm[2]};
    geometry.mounting = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
  } catch (const nlohmann::json::exception&) {
    return refuse("a number of the calibration is missing");
  }
  if (Status status = geometry.check(); !status) return refuse(status.error().what);
  return geometry;
}

}  // namespace tiltmap
