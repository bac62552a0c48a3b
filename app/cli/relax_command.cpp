// tiltmap relax P.tiltmap [--preset default|thesis|sequential] [--pin 0,5] [--threads N] [any parameter]
#include <cstdio>

#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

namespace {

std::string movedTable(const nlohmann::json& report) {
  std::string text = " scan   moved mm  turned deg\n";
  for (const auto& scan : report["moved"]) {
    char line[80];
    std::snprintf(line, sizeof line, "%5d  %9.2f  %10.4f\n", scan["scan"].get<int>(),
                  1000.0 * scan["translation_m"].get<double>(), scan["rotation_deg"].get<double>());
    text += line;
  }
  std::size_t used = 0;
  for (const auto& link : report["links"]) used += link["used"].get<bool>() ? 1 : 0;
  char line[160];
  std::snprintf(line, sizeof line, "%zu scans, %zu links, %zu steps in %.0f ms", report["moved"].size(), used,
                report["steps"].get<std::size_t>(), report["milliseconds"].get<double>());
  return text + line;
}

}  // namespace

void addRelax(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("relax", "Spread the errors of the pairs over all scans");
  auto path = std::make_shared<std::string>();
  auto preset = std::make_shared<std::string>("default");
  command->add_option("project", *path, "The project")->required();
  command->add_option(
      "--preset", *preset,
      "Parameters to start from: default, thesis for the method as printed, or sequential for "
      "the baseline");
  auto flags = ParameterFlags::addTo(*command, operations().find("relax")->parameters());
  command->callback([path, preset, flags, &chosen] {
    chosen.body = [path, preset, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      if (auto known = operations().find("relax")->presetValues(*preset); !known)
        return context.console.wrongUsage(known.error());
      return operationCommand(context, *path, "relax", *preset, *values, movedTable);
    };
  });
}

}  // namespace tiltmap::cli
