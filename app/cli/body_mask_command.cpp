// tiltmap body-mask P.tiltmap [--scans 0-13] [--apply] [--out FILE] [--from FILE] [any parameter]
#include <cstdio>

#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

namespace {

std::string bodyText(const nlohmann::json& report) {
  const bool applied = report["applied"].get<bool>();
  const auto masked = report["masked_cells"].get<std::size_t>();
  char line[200];
  if (!report.contains("cells")) {
    std::snprintf(line, sizeof line, "%zu cells left out of %zu scans; `tiltmap undo` takes it back", masked,
                  report["scans"].get<std::size_t>());
    return line;
  }
  const auto cells = report["cells"].get<std::size_t>();
  if (cells == 0 && masked == 0) return "no cell shows the machine itself";
  if (cells == 0) {
    std::snprintf(line, sizeof line, "%zu cells are masked already, and no others show the machine itself",
                  masked);
    return line;
  }
  std::snprintf(
      line, sizeof line,
      "%zu cells show the machine itself, up to %.2f m away; with their margin the mask is %zu cells\n",
      cells, report["furthest_m"].get<double>(), masked);
  std::string text = line;
  const double minimum = report["minimum_range_m"].get<double>();
  if (minimum > 0.0)
    std::snprintf(line, sizeof line, "a minimum range of %.2f m keeps it out\n", minimum);
  else
    std::snprintf(line, sizeof line, "no minimum range keeps it out: surroundings come as near\n");
  return text + line + (applied ? "applied; `tiltmap undo` takes it back" : "not applied");
}

}  // namespace

void addBodyMask(CLI::App& app, Chosen& chosen) {
  addApplyingCommand(app, chosen, "body-mask", "Find the machine's own body in its scans and keep it out",
                     bodyText);
}

}  // namespace tiltmap::cli
