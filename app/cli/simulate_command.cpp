// tiltmap simulate P.tiltmap --experiment exp1|exp2|exp2fixed|loop|survey [--seed N] [--stops N]
#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

void addSimulate(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "simulate", "Drive the simulated scanner through an experiment, into an empty project");
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The project")->required();
  auto flags = ParameterFlags::addTo(*command, operations().find("simulate")->parameters());
  command->callback([path, flags, &chosen] {
    chosen.body = [path, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      return operationCommand(
          context, *path, "simulate", "default", *values, [](const nlohmann::json& report) {
            return "simulated " + std::to_string(report["added"].get<int>()) + " stops of " +
                   report["experiment"].get<std::string>() + ", their truth kept as stage truth";
          });
    };
  });
}

}  // namespace tiltmap::cli
