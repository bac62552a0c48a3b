// tiltmap export P.tiltmap OUT.ply|pcd|ptx|3d|vtk|xyz|csv [--stage S] [--raw|--reduced] [--scans 0-5]
// [--per-scan]
#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

void addExport(CLI::App& app, Chosen& chosen) {
  auto* command =
      app.add_subcommand("export", "Write the map, all scans placed by their poses, for other programs");
  auto path = std::make_shared<std::string>();
  auto file = std::make_shared<std::string>();
  command->add_option("project", *path, "The project")->required();
  command
      ->add_option(
          "file", *file,
          "Where to write; the extension says the format: ply, pcd, ptx, 3d, vtk, xyz, txt, asc or csv")
      ->required();
  std::vector<ParameterInfo> infos = operations().find("export")->parameters();
  std::erase_if(infos, [](const ParameterInfo& info) { return info.name == "file"; });
  auto flags = ParameterFlags::addTo(*command, infos);
  command->add_flag("--raw")
      ->description("Every point (this is so unless told otherwise)")
      ->excludes("--reduced");
  command->callback([path, file, flags, &chosen] {
    chosen.body = [path, file, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      (*values)["file"] = *file;
      return operationCommand(
          context, *path, "export", "default", *values,
          [](const nlohmann::json& report) {
            const std::size_t files = report["files"].size();
            return "wrote " + report["file"].get<std::string>() +
                   (files > 1 ? " and " + std::to_string(files - 1) + " more" : "") + " (" +
                   std::to_string(report["scans"].get<int>()) +
                   " scans, poses: " + report["stage"].get<std::string>() + ")";
          },
          Access::ReadOnly);
    };
  });
}

}  // namespace tiltmap::cli
