#include "tests/benchmarks/drive_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "tests/benchmarks/noise_floor.h"
#include "tests/benchmarks/pair_run.h"
#include "tests/benchmarks/process_run.h"

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;

// One stage over the seeds; a figure a seed.
struct Stage {
  std::vector<double> wall_ms, cpu_ms, own_ms, metres, radians, times_floor;
};

NoiseFloor rootMeanSquare(const std::vector<NoiseFloor>& floors) {
  NoiseFloor sum;
  for (const NoiseFloor& floor : floors) {
    sum.translation_m += floor.translation_m * floor.translation_m;
    sum.rotation_rad += floor.rotation_rad * floor.rotation_rad;
  }
  const double count = static_cast<double>(std::max<std::size_t>(floors.size(), 1));
  return {std::sqrt(sum.translation_m / count), std::sqrt(sum.rotation_rad / count)};
}

nlohmann::json told(const Ended& ended, const std::string& what) {
  nlohmann::json json = nlohmann::json::parse(ended.output, nullptr, false);
  if (ended.exit_code != 0 || !json.is_object())
    throw std::runtime_error("tiltmap " + what + " ended with exit code " + std::to_string(ended.exit_code));
  return json;
}

Row rowOf(const std::string& subject, const std::string& program, const Stage& stage) {
  Row row{.subject = subject, .program = program};
  if (!stage.wall_ms.empty()) row.wall_ms = median(stage.wall_ms), row.cpu_ms = median(stage.cpu_ms);
  row.median_mm = median(stage.metres) * 1e3;
  row.median_deg = median(stage.radians) / kDegree;
  row.worst_mm = *std::ranges::max_element(stage.metres) * 1e3;
  row.worst_deg = *std::ranges::max_element(stage.radians) / kDegree;
  if (!stage.times_floor.empty()) row.times_floor = median(stage.times_floor);
  if (!stage.own_ms.empty())
    row.remark = fixedReal(median(stage.own_ms), 1) + " ms of it computing (" +
                 fixedReal(*std::ranges::min_element(stage.own_ms), 1) + " to " +
                 fixedReal(*std::ranges::max_element(stage.own_ms), 1) + ")";
  return row;
}

// Runs a command on fresh copies of the project; the last stays at `work`.
void addTo(Stage& stage, const fs::path& program, const std::string& command, const std::string& name,
           const fs::path& from, const fs::path& work, const fs::path& scratch, int rounds,
           const NoiseFloor& floor) {
  Timing timing;
  double own_ms = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    fs::copy_file(from, work, fs::copy_options::overwrite_existing);
    const Ended ended =
        run(program, {command, work.string(), "--threads", "1", "--json", "--quiet"}, scratch);
    own_ms = std::min(own_ms, told(ended, command).at("milliseconds").get<double>());
    timing.keepQuietest(ended.timing);
  }
  stage.wall_ms.push_back(timing.wall_ms);
  stage.cpu_ms.push_back(timing.cpu_ms);
  stage.own_ms.push_back(own_ms);
  const nlohmann::json errors =
      told(run(program, {"evaluate", work.string(), "--stage", name, "--json"}, scratch), "evaluate");
  stage.metres.push_back(errors.at("rmse_translation_m").get<double>());
  stage.radians.push_back(errors.at("rmse_rotation_deg").get<double>() * kDegree);
  stage.times_floor.push_back(stage.metres.back() / floor.translation_m);
}

}  // namespace

void addDriveRows(Table& table, ExperimentId experiment, std::pair<int, int> seeds, const fs::path& program,
                  const fs::path& scratch, int rounds, const std::function<void(const std::string&)>& tell) {
  const std::string name(nameOf(experiment));
  Stage floors, registered, relaxed;
  fs::remove_all(scratch);
  fs::create_directories(scratch);
  const fs::path original = scratch / "original.tiltmap", chain = scratch / "chain.tiltmap",
                 work = scratch / "work.tiltmap";
  for (int seed = seeds.first; seed <= seeds.second; ++seed) {
    tell(name + " seed " + std::to_string(seed) + ", the whole drive");
    const Result<Experiment> drive = Experiment::make(experiment, static_cast<std::uint64_t>(seed));
    if (!drive) throw std::runtime_error(drive.error().what);
    const Result<std::vector<SimulatedStop>> stops = drive->simulateAll(0);
    if (!stops) throw std::runtime_error(stops.error().what);
    const NoiseFloor floor = rootMeanSquare(driveFloors(*drive, *stops));
    floors.metres.push_back(floor.translation_m);
    floors.radians.push_back(floor.rotation_rad);
    fs::remove(original);
    if (run(program, {"new", original.string()}, scratch).exit_code != 0 ||
        run(program,
            {"simulate", original.string(), "--experiment", name, "--seed", std::to_string(seed), "--quiet"},
            scratch)
                .exit_code != 0) {
      table.notes.push_back("Skipped: " + program.string() + " made no project of " + name + ".");
      return;
    }
    addTo(registered, program, "register", "pairwise", original, chain, scratch, rounds, floor);
    addTo(relaxed, program, "relax", "relaxed", chain, work, scratch, rounds, floor);
  }
  const std::string subject = name + ", seeds " + std::to_string(seeds.first) + " to " +
                              std::to_string(seeds.second) +
                              ": drives through the program, one thread; errors are RMSE over the stops";
  table.rows.push_back(rowOf(subject, "(noise floor)", floors));
  table.rows.push_back(rowOf(subject, "tiltmap register, chained", registered));
  table.rows.push_back(rowOf(subject, "tiltmap relax", relaxed));
}

}  // namespace tiltmap::benchmarks
