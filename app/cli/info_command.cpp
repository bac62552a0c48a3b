// tiltmap info P.tiltmap
#include <cstdio>

#include "app/cli/operation_runner.h"
#include "core/products/scan_colours.h"

namespace tiltmap::cli {

namespace {

nlohmann::json colourJson(const ScanEntry& scan) {
  return scan.colour ? nlohmann::json(hexOf(scanColour(scan, 0))) : nlohmann::json(nullptr);
}

nlohmann::json infoJson(const ProjectSnapshot& snapshot) {
  nlohmann::json info = {{"scans", nlohmann::json::array()},
                         {"links", nlohmann::json::array()},
                         {"stages", nlohmann::json::array()}};
  for (std::size_t i = 0; i < snapshot.scans().size(); ++i) {
    const ScanEntry& scan = snapshot.scans()[i];
    info["scans"].push_back({{"index", i},
                             {"name", scan.name},
                             {"rows", scan.rows},
                             {"columns", scan.columns},
                             {"lines", scan.lines},
                             {"valid", scan.valid_cells},
                             {"source", scan.source},
                             {"note", scan.note},
                             {"colour", colourJson(scan)},
                             {"photographs", scan.photographs.size()}});
  }
  for (const Link& link : snapshot.links()) {
    const auto index = [&](ScanId id) -> nlohmann::json {
      const auto place = snapshot.indexOf(id);
      return place ? nlohmann::json(*place) : nlohmann::json(nullptr);
    };
    info["links"].push_back({{"id", link.id},
                             {"fixed", index(link.fixed)},
                             {"moving", index(link.moving)},
                             {"overlap", link.overlap},
                             {"rms_m", link.rms_m},
                             {"correspondences", link.correspondences},
                             {"stop_reason", link.stop_reason},
                             {"succeeded", link.succeeded},
                             {"origin", linkOriginName(link.origin)},
                             {"state", linkStateName(link.state)}});
  }
  for (const Stage stage : snapshot.stages()) info["stages"].push_back(stageName(stage));
  const SurveyInfo& survey = snapshot.survey();
  info["survey"] = {{"site", survey.site},
                    {"operator", survey.operator_name},
                    {"device", survey.device},
                    {"date", survey.date}};
  return info;
}

std::string infoText(const nlohmann::json& info) {
  std::string text =
      std::to_string(info["scans"].size()) + " scans, " + std::to_string(info["links"].size()) + " links";
  std::string stages;
  for (const auto& stage : info["stages"]) stages += (stages.empty() ? "" : ", ") + stage.get<std::string>();
  text += "; poses: " + (stages.empty() ? "none" : stages) + "\n";
  if (!info["scans"].empty()) text += "scan  rows  columns  lines    valid  source\n";
  for (const auto& scan : info["scans"]) {
    char line[96];
    std::snprintf(line, sizeof line, "%4d %5d %8d %6d %8d  ", scan["index"].get<int>(),
                  scan["rows"].get<int>(), scan["columns"].get<int>(), scan["lines"].get<int>(),
                  scan["valid"].get<int>());
    text += line + scan["source"].get<std::string>() + "\n";
  }
  return text;
}

}  // namespace

void addInfo(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("info", "What a project holds");
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The project")->required();
  command->callback([path, &chosen] {
    chosen.body = [path](Context& context) -> int {
      auto snapshot = readProject(*path);
      if (!snapshot) return context.console.failed(snapshot.error());
      const nlohmann::json info = infoJson(**snapshot);
      context.console.printJson(info);
      context.console.print(infoText(info));
      return kDone;
    };
  });
}

}  // namespace tiltmap::cli
