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
#include "tests/benchmarks/capture_run.h"
#include "tests/benchmarks/limits.h"
#include "tests/benchmarks/machine.h"
#include "tests/benchmarks/operations.h"
#include "tests/benchmarks/pair_run.h"
#include "tests/benchmarks/pair_sets.h"
#include "tests/benchmarks/program_run.h"
#include "tests/benchmarks/verdict_run.h"
#include "tests/benchmarks/window_run.h"

namespace tiltmap::benchmarks {

namespace {

const std::vector<std::string> kBlocks = {"operations", "pairs",  "real",   "program",
                                          "capture",    "window", "verdict"};

struct Options {
  std::vector<std::string> blocks = kBlocks;
  std::string seeds = "1-2";
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

// All seeds of one experiment; false where a limit does not hold.
bool addPairs(Table& table, ExperimentId experiment, std::pair<int, int> seeds, const Options& options,
              const Tell& tell) {
  const std::vector<PairMethod> list = methods(options.ours_only);
  std::vector<PairMeasurement> all;
  std::vector<double> start_m, start_rad;
  for (int seed = seeds.first; seed <= seeds.second; ++seed) {
    const std::vector<PairProblem> pairs = simulatedPairs(experiment, static_cast<std::uint64_t>(seed));
    for (const PairProblem& pair : pairs) {
      const PoseDifference start = difference(pair.start_fixed_from_moving, *pair.true_fixed_from_moving);
      start_m.push_back(start.translation_m);
      start_rad.push_back(start.rotation_rad);
    }
    const OneThread limit;
    const std::vector<PairMeasurement> some = runPairs(pairs, list, options.rounds, tell);
    all.insert(all.end(), some.begin(), some.end());
  }
  const std::string subject = std::string(nameOf(experiment)) + ", seeds " + std::to_string(seeds.first) +
                              " to " + std::to_string(seeds.second) + ": " + std::to_string(start_m.size()) +
                              " neighbouring pairs against the truth";
  Row start{.subject = subject, .program = "(odometry, the start)"};
  start.median_mm = median(start_m) * 1e3;
  start.median_deg = median(start_rad) / kDegree;
  start.worst_mm = *std::max_element(start_m.begin(), start_m.end()) * 1e3;
  start.worst_deg = *std::max_element(start_rad.begin(), start_rad.end()) / kDegree;
  table.rows.push_back(start);
  addPairRows(table, subject, list, all);
  const std::vector<std::string> broken = brokenLimits(list, all);
  for (const std::string& limit : broken)
    table.notes.push_back("Limit not kept, " + std::string(nameOf(experiment)) + ": " + limit);
  return broken.empty();
}

int measure(const Options& options, std::pair<int, int> seeds) {
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
      "peers     0.5 m voxels, pairs up to 3 m, at most 60 iterations, 20 neighbours for normals");
  bool kept = true;
  if (blocks.contains("operations")) addOperations(table, options, tell);
  if (blocks.contains("pairs"))
    for (const ExperimentId experiment : {ExperimentId::Exp1, ExperimentId::Exp2Fixed})
      kept = addPairs(table, experiment, seeds, options, tell) && kept;
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
  if (!seeds) {
    std::cerr << "--seeds: give a range like 1-5\n";
    return 2;
  }
  try {
    return measure(options, *seeds);
  } catch (const std::exception& error) {
    std::cerr << "the benchmarks stopped: " << error.what() << '\n';
    return 1;
  }
}
