// tiltmap import P.tiltmap FILE... [--format F] [--odometry POSES.tum] [--min-range M] [--max-range M]
#include <algorithm>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"

namespace tiltmap::cli {

void addImport(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("import", "Add scans from files; one bad file and nothing is added");
  auto path = std::make_shared<std::string>();
  auto files = std::make_shared<std::vector<std::string>>();
  command->add_option("project", *path, "The project")->required();
  command->add_option("files", *files, "Scan files, in the order they were taken")->required();
  // The files are words of their own; the other parameters are flags.
  std::vector<ParameterInfo> infos = operations().find("import")->parameters();
  std::erase_if(infos, [](const ParameterInfo& info) { return info.name == "files"; });
  auto flags = ParameterFlags::addTo(*command, infos);
  command->callback([path, files, flags, &chosen] {
    chosen.body = [path, files, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      for (const std::string& file : *files)
        if (file.find('\n') != std::string::npos)
          return context.console.wrongUsage(
              {"a file name holds a line break", printable(file), "rename the file"});
      (*values)["files"] = joined(*files, "\n");
      return operationCommand(context, *path, "import", "default", *values, [](const nlohmann::json& report) {
        const int added = report["added"].get<int>();
        return "added " + std::to_string(added) + (added == 1 ? " scan" : " scans");
      });
    };
  });
}

}  // namespace tiltmap::cli
