#include "tests/benchmarks/program_run.h"

#include <array>
#include <cstdio>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/benchmarks/process_run.h"

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;

// What `tiltmap evaluate --json --stage` says about the poses of a stage.
Row stageRow(const std::string& subject, const fs::path& program, const fs::path& project,
             const std::string& stage, const fs::path& scratch) {
  Row row{.subject = subject, .program = "poses of stage " + stage};
  const Ended ended = run(program, {"evaluate", project.string(), "--stage", stage, "--json"}, scratch);
  const nlohmann::json told = nlohmann::json::parse(ended.output, nullptr, false);
  if (ended.exit_code != 0 || !told.is_object()) {
    row.remark = "tiltmap evaluate failed";
    return row;
  }
  double worst_m = 0.0;
  double worst_deg = 0.0;
  std::size_t good = 0;
  for (const nlohmann::json& stop : told.at("stops")) {
    const double metres = stop.at("translation_error_m").get<double>();
    worst_m = std::max(worst_m, metres);
    worst_deg = std::max(worst_deg, stop.at("rotation_error_deg").get<double>());
    good += metres <= 0.02 ? 1 : 0;
  }
  row.worst_mm = worst_m * 1e3;
  row.worst_deg = worst_deg;
  row.within = std::to_string(good) + "/" + std::to_string(told.at("stops").size());
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "RMSE %.2f mm, %.4f deg",
                told.at("rmse_translation_m").get<double>() * 1e3,
                told.at("rmse_rotation_deg").get<double>());
  row.remark = text.data();
  return row;
}

bool hasCommand(const fs::path& program, const std::string& command, const fs::path& scratch) {
  return run(program, {command, "--help"}, scratch).exit_code == 0;
}

// The quietest of several runs, each on a fresh copy of the project; the last copy stays at `work`.
Ended quietest(const fs::path& program, const Arguments& arguments, const fs::path& original,
               const fs::path& work, const fs::path& scratch, int rounds) {
  Ended best;
  for (int round = 0; round < rounds; ++round) {
    fs::copy_file(original, work, fs::copy_options::overwrite_existing);
    const Ended ended = run(program, arguments, scratch);
    best.timing.keepQuietest(ended.timing);
    best.exit_code = ended.exit_code;
    if (ended.exit_code != 0) break;
  }
  return best;
}

Row timeRow(const std::string& subject, const std::string& name, const Ended& ended) {
  Row row{.subject = subject, .program = name};
  if (ended.exit_code == 0) {
    row.wall_ms = ended.timing.wall_ms;
    row.cpu_ms = ended.timing.cpu_ms;
    row.remark = "whole process, all cores";
  } else {
    row.remark = "ended with exit code " + std::to_string(ended.exit_code);
  }
  return row;
}

// A simulated survey from its matrices to relaxed poses: the time of each step, the error of each stage.
struct Chain {
  std::string subject;
  Arguments simulate;
};

void addChain(const Chain& chain, Table& table, const fs::path& program, const fs::path& scratch, int rounds,
              const std::function<void(const std::string&)>& tell) {
  tell(chain.subject);
  const fs::path original = scratch / "original.tiltmap";
  const fs::path registered = scratch / "registered.tiltmap";
  const fs::path work = scratch / "work.tiltmap";
  fs::remove(original);
  const Ended made = run(program, {"new", original.string()}, scratch);
  Arguments simulate{"simulate", original.string(), "--quiet"};
  simulate.insert(simulate.end(), chain.simulate.begin(), chain.simulate.end());
  const Ended simulated = run(program, simulate, scratch);
  if (made.exit_code != 0 || simulated.exit_code != 0 || !fs::exists(original)) {
    table.notes.push_back("Skipped: " + program.string() + " made no project of " + chain.subject + ".");
    return;
  }
  table.rows.push_back(timeRow(chain.subject, "tiltmap simulate", simulated));
  table.rows.push_back(stageRow(chain.subject, program, original, "odometry", scratch));
  const auto addStage = [&](const std::string& command, const fs::path& from, const std::string& stage) {
    const Ended ended = quietest(program, {command, work.string(), "--quiet"}, from, work, scratch, rounds);
    table.rows.push_back(timeRow(chain.subject, "tiltmap " + command, ended));
    if (ended.exit_code == 0) table.rows.push_back(stageRow(chain.subject, program, work, stage, scratch));
    return ended.exit_code == 0;
  };
  if (!addStage("register", original, "pairwise")) return;
  fs::copy_file(work, registered, fs::copy_options::overwrite_existing);
  addStage("relax", registered, "relaxed");
}

}  // namespace

void addProgramRows(Table& table, const fs::path& program, const fs::path& scratch, int rounds,
                    const std::function<void(const std::string&)>& tell) {
  fs::remove_all(scratch);
  fs::create_directories(scratch);
  for (const char* command : {"new", "simulate", "register", "relax"}) {
    if (hasCommand(program, command, scratch)) continue;
    table.notes.push_back("Skipped: " + program.string() + " has no command " + command + ".");
    return;
  }
  const std::vector<Chain> chains = {
      {"tiltmap as a process: exp2fixed, 14 stops, seed 1", {"--experiment", "exp2fixed"}},
      {"tiltmap as a process: loop, 40 stops round a block, seed 1", {"--experiment", "loop"}},
      {"tiltmap as a process: survey, 100 stops, seed 1", {"--experiment", "survey", "--stops", "100"}}};
  for (const Chain& chain : chains) addChain(chain, table, program, scratch, rounds, tell);
}

}  // namespace tiltmap::benchmarks
