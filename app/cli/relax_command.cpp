// tiltmap relax P.tiltmap [--preset default|thesis|sequential] [--pin 0,5] [--threads N] [--record]
//   [any parameter]
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

std::string eventLine(const nlohmann::json& event) {
  std::string text = "step " + std::to_string(event["step"].get<int>()) + ": ";
  if (event.contains("scan")) text += "scan " + std::to_string(event["scan"].get<int>()) + " ";
  text += event["event"].get<std::string>();
  char part[96];
  if (event.contains("translation_m")) {
    std::snprintf(part, sizeof part, " %.2f mm, %.4f deg", 1000.0 * event["translation_m"].get<double>(),
                  event["rotation_deg"].get<double>());
    text += part;
  }
  if (event.contains("other")) text += ", scan " + std::to_string(event["other"].get<int>());
  if (event.contains("pairs")) text += ", " + std::to_string(event["pairs"].get<std::size_t>()) + " pairs";
  if (event.contains("rms_m")) {
    std::snprintf(part, sizeof part, ", rms %.2f mm", 1000.0 * event["rms_m"].get<double>());
    text += part;
  }
  if (event.contains("text")) text += ", " + event["text"].get<std::string>();
  return text + "\n";
}

std::string eventsAndTable(const nlohmann::json& report) {
  std::string text;
  for (const auto& event : report["events"]) text += eventLine(event);
  return text + movedTable(report);
}

// What scripts are promised; the record only when asked for, as it grows with the steps and the links.
nlohmann::json promised(const nlohmann::json& report) {
  nlohmann::json object;
  for (const char* key : {"milliseconds", "moved", "unlinked", "added", "warnings"}) object[key] = report[key];
  return object;
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
  auto record = std::make_shared<bool>(false);
  command->add_flag("--record", *record, "Show every event of every step, and with --json the links too");
  auto flags = ParameterFlags::addTo(*command, operations().find("relax")->parameters());
  command->callback([path, preset, record, flags, &chosen] {
    chosen.body = [path, preset, record, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      if (auto known = operations().find("relax")->presetValues(*preset); !known)
        return context.console.wrongUsage(known.error());
      const auto asJson = [all = *record](const nlohmann::json& report) {
        return all ? report : promised(report);
      };
      return operationCommand(context, *path, "relax", *preset, *values,
                              *record ? eventsAndTable : movedTable, Access::ReadWrite, asJson);
    };
  });
}

}  // namespace tiltmap::cli
