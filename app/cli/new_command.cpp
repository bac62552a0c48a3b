// tiltmap new P.tiltmap
#include "app/cli/command.h"
#include "core/project/project.h"

namespace tiltmap::cli {

void addNew(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("new", "Make an empty project");
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The file to make, NAME.tiltmap; nothing must be there yet")
      ->required();
  command->callback([path, &chosen] {
    chosen.body = [path](Context& context) -> int {
      auto project = Project::create(*path);
      if (!project) return context.console.failed(project.error());
      context.console.printJson({{"project", *path}});
      context.console.print("made " + *path);
      return kDone;
    };
  });
}

}  // namespace tiltmap::cli
