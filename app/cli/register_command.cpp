// tiltmap register P.tiltmap [--preset default|thesis] [--pairs 0:1,1:2] [--threads N] [any parameter]
#include <cstdio>

#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

namespace {

std::string pairTable(const nlohmann::json& report) {
  std::string text = "fixed  moving  overlap   rms mm   pairs  steps     ms  ended\n";
  for (const auto& pair : report["pairs"]) {
    char line[160];
    std::snprintf(line, sizeof line, "%5d  %6d  %5.0f %%  %7.2f  %6d  %5d  %5.1f  %s\n",
                  pair["fixed"].get<int>(), pair["moving"].get<int>(), 100.0 * pair["overlap"].get<double>(),
                  1000.0 * pair["rms_m"].get<double>(), pair["correspondences"].get<int>(),
                  pair["iterations"].get<int>(), pair["milliseconds"].get<double>(),
                  pair["stop_reason"].get<std::string>().c_str());
    text += line;
  }
  char line[80];
  std::snprintf(line, sizeof line, "%zu pairs in %.0f ms", report["pairs"].size(),
                report["milliseconds"].get<double>());
  return text + line;
}

}  // namespace

void addRegister(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("register", "Register pairs of scans, starting from the odometry");
  auto path = std::make_shared<std::string>();
  auto preset = std::make_shared<std::string>("default");
  command->add_option("project", *path, "The project")->required();
  command->add_option("--preset", *preset,
                      "Parameters to start from: default, or thesis for the method as printed");
  auto flags = ParameterFlags::addTo(*command, operations().find("register")->parameters());
  command->callback([path, preset, flags, &chosen] {
    chosen.body = [path, preset, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      if (auto known = operations().find("register")->presetValues(*preset); !known)
        return context.console.wrongUsage(known.error());
      return operationCommand(context, *path, "register", *preset, *values, pairTable);
    };
  });
}

}  // namespace tiltmap::cli
