// tiltmap register P.tiltmap [--preset default|thesis] [--pairs 0:1,1:2] [--threads N] [--shard K/N --out
// PART]
//   [any parameter]
#include <cstdio>

#include "app/cli/operation_runner.h"
#include "core/project/operations/registration_shards.h"

namespace tiltmap::cli {

namespace {

std::string pairTable(const nlohmann::json& report) {
  std::string text = "fixed  moving  matched   rms mm   pairs  steps     ms  ended\n";
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

struct RegisterWords {
  std::string project;
  std::string preset = "default";
  std::string shard;
  std::string out;
};

// A part of the pairs, into a file of its own; the project is only read.
int registerPart(Context& context, const RegisterWords& words, const ParameterValues& values) {
  const auto shard = parseShard(words.shard);
  if (!shard) return context.console.wrongUsage(shard.error());
  if (Status status = checkOutput(words.out, words.project); !status)
    return context.console.failed(status.error());
  const auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto part = registerShard(*snapshot, words.preset, values, *shard, context.job());
  context.console.endProgress();
  if (!part) return context.console.failed(part.error());
  if (Status status = writeRegistrationPart(*part, words.out); !status)
    return context.console.failed(status.error());
  const nlohmann::json report = {{"part", words.out},
                                 {"shard", part->shard.k},
                                 {"of", part->shard.n},
                                 {"pairs", nlohmann::json::parse(registeredPairsJson(part->pairs))},
                                 {"milliseconds", part->milliseconds},
                                 {"warnings", nlohmann::json::array()}};
  context.console.printJson(report);
  context.console.print(pairTable(report) + "\npart " + shardName(*shard) + " written to " + words.out);
  return kDone;
}

}  // namespace

void addRegister(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("register", "Register pairs of scans, starting from the odometry");
  auto words = std::make_shared<RegisterWords>();
  command->add_option("project", words->project, "The project")->required();
  command->add_option("--preset", words->preset,
                      "Parameters to start from: default, or thesis for the method as printed");
  auto* shard = command->add_option(
      "--shard", words->shard,
      "Only part K of N of the pairs, into the file --out; `tiltmap merge` puts the parts together");
  shard->type_name("K/N");
  auto* out = command->add_option("--out", words->out, "With --shard: the file to write");
  shard->needs(out);
  out->needs(shard);
  auto flags = ParameterFlags::addTo(*command, operations().find("register")->parameters());
  command->callback([words, flags, &chosen] {
    chosen.body = [words, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      if (auto known = operations().find("register")->presetValues(words->preset); !known)
        return context.console.wrongUsage(known.error());
      if (!words->shard.empty()) return registerPart(context, *words, *values);
      return operationCommand(context, words->project, "register", words->preset, *values, pairTable);
    };
  });
}

}  // namespace tiltmap::cli
