// tiltmap calibrate P.tiltmap [--scans 0-13] [--apply] [--out FILE] [--from FILE] [any parameter]
#include <cstdio>

#include "app/cli/operation_runner.h"
#include "core/geometry/pose.h"

namespace tiltmap::cli {

namespace {

std::string estimateLine(const nlohmann::json& estimate) {
  const bool angle = estimate["unit"] == "rad";
  const double scale = angle ? 1.0 / kDegree : 1000.0;
  const int places = angle ? 3 : 1;
  const char* unit = angle ? "deg" : "mm";
  const std::string name = estimate["name"];
  const std::string state = estimate["state"];
  const double sigma = scale * estimate["deviation"].get<double>();
  char line[160];
  if (state == "estimated") {
    std::snprintf(line, sizeof line, "%-13s  %9.*f  %9.*f  %9.*f  %s\n", name.c_str(), places,
                  scale * estimate["before"].get<double>(), places, scale * estimate["value"].get<double>(),
                  places, sigma, unit);
    return line;
  }
  char known[24] = "-";
  if (state == "weak" && sigma > 0.0) std::snprintf(known, sizeof known, "%.*f", places, sigma);
  std::snprintf(line, sizeof line, "%-13s  %9.*f  %9s  %9s  %-3s  ", name.c_str(), places,
                scale * estimate["before"].get<double>(), "-", known, unit);
  return line + estimate["reason"].get<std::string>() + "\n";
}

std::string calibrationTable(const nlohmann::json& report) {
  if (!report.contains("estimates"))
    return "calibrated " + std::to_string(report["scans"].get<int>()) + " scans from the file";
  std::string text = "error             before      found      sigma\n";
  for (const auto& estimate : report["estimates"]) text += estimateLine(estimate);
  char line[200];
  std::snprintf(line, sizeof line,
                "%d scans, %d pairs, ground at %d stops; median residual %.2f mm before, %.2f mm after\n",
                report["scans"].get<int>(), report["links"].get<int>(), report["ground_stops"].get<int>(),
                1000.0 * report["residual_before_m"].get<double>(),
                1000.0 * report["residual_after_m"].get<double>());
  return text + line +
         (report["applied"].get<bool>() ? "applied; `tiltmap undo` takes it back" : "not applied");
}

}  // namespace

void addCalibrate(CLI::App& app, Chosen& chosen) {
  addApplyingCommand(app, chosen, "calibrate",
                     "Estimate the scanner's tilt zero, lever arm, mounting and range offset from the scans",
                     calibrationTable);
}

}  // namespace tiltmap::cli
