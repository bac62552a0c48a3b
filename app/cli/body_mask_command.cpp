// tiltmap body-mask P.tiltmap [--scans 0-13] [--apply] [--out FILE] [any parameter]
#include <cstdio>

#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

namespace {

std::string bodyText(const nlohmann::json& report) {
  if (report["cells"].get<std::size_t>() == 0) return "no cell shows the machine itself";
  char line[200];
  std::snprintf(line, sizeof line, "%zu cells show the machine itself, up to %.2f m away\n",
                report["cells"].get<std::size_t>(), report["furthest_m"].get<double>());
  std::string text = line;
  const double minimum = report["minimum_range_m"].get<double>();
  if (minimum <= 0.0) return text + "no minimum range keeps it out: surroundings come as near";
  std::snprintf(line, sizeof line, "a minimum range of %.2f m keeps it out%s", minimum,
                report["applied"].get<bool>() ? "; applied, `tiltmap undo` takes it back" : "; not applied");
  return text + line;
}

}  // namespace

void addBodyMask(CLI::App& app, Chosen& chosen) {
  addApplyingCommand(app, chosen, "body-mask", "Find the machine's own body in its scans and keep it out",
                     bodyText);
}

}  // namespace tiltmap::cli
