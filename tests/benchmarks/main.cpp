// Holds Tiltmap against the libraries others would take, in one run, and prints one table.
#include <cstdio>
#include <functional>
#include <iostream>
#include <optional>
#include <set>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "core/base/text.h"
#include "core/scan/point_cloud.h"
#include "core/scan/range_image.h"
#include "tests/benchmarks/ablation_run.h"
#include "tests/benchmarks/capture_run.h"
#include "tests/benchmarks/drive_run.h"
#include "tests/benchmarks/limits.h"
#include "tests/benchmarks/machine.h"
#include "tests/benchmarks/operations.h"
#include "tests/benchmarks/pair_run.h"
#include "tests/benchmarks/pair_sets.h"
#include "tests/benchmarks/program_run.h"
#include "tests/benchmarks/survey_run.h"
#include "tests/benchmarks/verdict_run.h"
#include "tests/benchmarks/window_run.h"

namespace tiltmap::benchmarks {

namespace {

const std::vector<std::string> kBlocks = {"operations", "pairs",   "drives", "ablations", "real",
                                          "program",    "capture", "window", "verdict",   "survey"};

struct Options {
  std::vector<std::string> blocks = kBlocks;
  std::string seeds = "1-2";
  std::string tuning_seeds = "101-102";
  int rounds = 3;
  bool ours_only = false;
  bool json = false;
  bool check = false;
  bool quiet = false;
  std::string commit;
  std::string program = TILTMAP_PROGRAM;
  std::string scratch = TILTMAP_SCRATCH;
};

using Tell = std::function<void(const std::string&)>;

// "1-5" or "3".
std::optional<std::pair<int, int>> seedRange(const std::string& text) {
  const std::vector<std::string_view> parts = splitAt(text, '-');
  if (parts.empty() || parts.size() > 2) return {};
  const auto first = parseInteger(parts.front());
  const auto last = parseInteger(parts.back());
  if (!first || !last || *first < 1 || *last < *first || *last > 1000) return {};
  return std::pair(static_cast<int>(*first), static_cast<int>(*last));
}

std::vector<PairMethod> methods(bool ours_only) {
  std::vector<PairMethod> list = ownMethods();
  if (ours_only) return list;
  for (const auto& peers : {pclMethods(), open3dMethods()})
    list.insert(list.end(), peers.begin(), peers.end());
  return list;
}

void addOperations(Table& table, const Options& options, const Tell& tell) {
  tell("operations on one scan");
  const std::vector<PairProblem> pairs = simulatedPairs(ExperimentId::Exp2Fixed, 1);
  const PairProblem& pair = pairs.front();
  OperationInput input;
  input.scan = pair.fixed;
  input.cell_points = cellPoints(*pair.fixed.image, pair.fixed.geometry);
  input.points = cloudOf(*pair.fixed.image, pair.fixed.geometry).points;
  for (const Eigen::Vector3d& p : cloudOf(*pair.moving.image, pair.moving.geometry).points)
    input.queries.push_back(*pair.true_fixed_from_moving * p);
  table.heading.push_back("scan      exp2fixed seed 1, stop 0: " + std::to_string(input.points.size()) +
                          " points; looked up in it: the " + std::to_string(input.queries.size()) +
                          " of stop 1");
  std::vector<Operation> operations = ownOperations(input);
  if (!options.ours_only)
    for (const auto& peers : {pclOperations(input), nanoflannOperations(input)})
      operations.insert(operations.end(), peers.begin(), peers.end());
  const OneThread limit;
  addOperationRows(table, operations, std::max(3, options.rounds));
}

// A row of what is no program: the start, the noise floor.
Row rowOfNone(const std::string& subject, const std::string& name, const std::vector<double>& metres,
              const std::vector<double>& radians) {
  Row row{.subject = subject, .program = name};
  row.median_mm = median(metres) * 1e3;
  row.median_deg = median(radians) / kDegree;
  row.most_mm = quantile(metres, 0.95) * 1e3;
  row.worst_mm = *std::max_element(metres.begin(), metres.end()) * 1e3;
  row.worst_deg = *std::max_element(radians.begin(), radians.end()) / kDegree;
  return row;
}

// All seeds of one experiment.
std::vector<PairMeasurement> addPairs(Table& table, ExperimentId experiment, std::pair<int, int> seeds,
                                      const std::vector<PairMethod>& list, int rounds, const Tell& tell) {
  std::vector<PairMeasurement> all;
  std::vector<double> start_m, start_rad, floor_m, floor_rad;
  for (int seed = seeds.first; seed <= seeds.second; ++seed) {
    const std::vector<PairProblem> pairs = simulatedPairs(experiment, static_cast<std::uint64_t>(seed));
    for (const PairProblem& pair : pairs) {
      const PoseDifference start = difference(pair.start_fixed_from_moving, *pair.true_fixed_from_moving);
      start_m.push_back(start.translation_m);
      start_rad.push_back(start.rotation_rad);
      floor_m.push_back(pair.floor->translation_m);
      floor_rad.push_back(pair.floor->rotation_rad);
    }
    const OneThread limit;
    const std::vector<PairMeasurement> some = runPairs(pairs, list, rounds, tell);
    all.insert(all.end(), some.begin(), some.end());
  }
  const std::string subject = std::string(nameOf(experiment)) + ", seeds " + std::to_string(seeds.first) +
                              " to " + std::to_string(seeds.second) + ": " + std::to_string(start_m.size()) +
                              " neighbouring pairs against the truth";
  table.rows.push_back(rowOfNone(subject, "(odometry, the start)", start_m, start_rad));
  table.rows.push_back(rowOfNone(subject, "(noise floor)", floor_m, floor_rad));
  addPairRows(table, subject, list, all);
  return all;
}

// False where a limit does not hold.
bool keepsLimits(Table& table, ExperimentId experiment, const std::vector<PairMethod>& list,
                 const std::vector<PairMeasurement>& all) {
  const std::vector<std::string> broken = brokenLimits(list, all);
  for (const std::string& limit : broken)
    table.notes.push_back("Limit not kept, " + std::string(nameOf(experiment)) + ": " + limit);
  return broken.empty();
}

int measure(const Options& options, std::pair<int, int> seeds, std::pair<int, int> tuning_seeds) {
  const Tell tell = [&options](const std::string& what) {
    if (!options.quiet) std::cerr << "  " << what << std::endl;
  };
  const std::set<std::string> blocks(options.blocks.begin(), options.blocks.end());
  Table table;
  table.heading = machineLines(options.commit);
  table.heading.push_back("times     one thread; the quietest of " + std::to_string(options.rounds) +
                          " rounds taken in turns; of pairs the median over the pairs");
  table.heading.push_back(
      "          ours from the raw matrices, the peers' from a cloud of points, all preparation included");
  table.heading.push_back("          x ours: CPU time over that of our first row");
  table.heading.push_back(
      "errors    x floor: over the noise floor (Cramer-Rao) of the same pair, the median of that");
  table.heading.push_back(
      "peers     0.5 m voxels, pairs up to 3 m, at most 60 iterations, 20 neighbours for normals");
  bool kept = true;
  if (blocks.contains("operations")) addOperations(table, options, tell);
  for (const ExperimentId experiment : {ExperimentId::Exp1, ExperimentId::Exp2Fixed}) {
    if (blocks.contains("pairs")) {
      const std::vector<PairMethod> list = methods(options.ours_only);
      const auto all = addPairs(table, experiment, seeds, list, options.rounds, tell);
      kept = keepsLimits(table, experiment, list, all) && kept;
    }
    if (blocks.contains("drives"))
      addDriveRows(table, experiment, seeds, options.program, options.scratch, options.rounds, tell);
  }
  if (blocks.contains("ablations"))
    for (const ExperimentId experiment : {ExperimentId::Exp1, ExperimentId::Exp2Fixed})
      addPairs(table, experiment, tuning_seeds, ablations(), options.rounds, tell);
  if (blocks.contains("real")) {
    const OneThread limit;
    addRealRows(table, methods(options.ours_only), options.rounds, tell);
  }
  if (blocks.contains("program"))
    addProgramRows(table, options.program, options.scratch, options.rounds, tell);
  if (blocks.contains("capture")) addCaptureRows(table, options.scratch, tell);
  if (blocks.contains("window"))
    kept = addWindowRows(table, TILTMAP_WINDOW_BENCHMARK, options.program,
                         std::string(options.scratch) + "-window", tell) &&
           kept;
  if (blocks.contains("verdict")) {
    kept = addVerdictRows(table, seeds, tell) && kept;
    kept = addStopRows(table, seeds, tell) && kept;
  }
  if (blocks.contains("survey"))
    kept = addSurveyRows(table, options.program, std::string(options.scratch) + "-survey", tell) && kept;
  table.heading.push_back("load      " + loadAverage() + " at the end");
  if (options.json)
    std::cout << table.json().dump(2) << '\n';
  else
    table.print(std::cout);
  return options.check && !kept ? 1 : 0;
}

}  // namespace

}  // namespace tiltmap::benchmarks

int main(int argc, char** argv) {
  using namespace tiltmap::benchmarks;
  Options options;
  CLI::App app{"Holds Tiltmap against PCL, Open3D and nanoflann; prints one table."};
  app.add_option("--blocks", options.blocks, "What to measure")
      ->delimiter(',')
      ->check(CLI::IsMember(kBlocks))
      ->capture_default_str();
  app.add_option("--seeds", options.seeds, "Simulated sites: 1-2, 1-5, 1-10, ...")->capture_default_str();
  app.add_option("--tuning-seeds", options.tuning_seeds, "Simulated sites of the ablations")
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "Turns of which the quietest counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_flag("--ours-only", options.ours_only, "Leave the peers out");
  app.add_flag("--json", options.json, "One JSON object instead of the text");
  app.add_flag("--check", options.check, "Exit with 1 where a limit on the preset default is not kept");
  app.add_flag("--quiet", options.quiet, "No progress on standard error");
  app.add_option("--commit", options.commit, "What to call this state of the sources");
  app.add_option("--program", options.program, "The tiltmap to run as a process")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const auto seeds = seedRange(options.seeds);
  const auto tuning_seeds = seedRange(options.tuning_seeds);
  if (!seeds || !tuning_seeds) {
    std::cerr << "--seeds, --tuning-seeds: give a range like 1-5\n";
    return 2;
  }
  try {
    return measure(options, *seeds, *tuning_seeds);
  } catch (const std::exception& error) {
    std::cerr << "the benchmarks stopped: " << error.what() << '\n';
    return 1;
  }
}
