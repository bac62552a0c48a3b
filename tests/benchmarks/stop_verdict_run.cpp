#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/base/random.h"
#include "core/multiview/stop_verdict.h"
#include "core/world/experiment.h"
#include "tests/benchmarks/verdict_cases.h"
#include "tests/benchmarks/verdict_run.h"
#include "tests/support/stop_scenes.h"

namespace tiltmap::benchmarks {

namespace {

using namespace test_support;

constexpr int kLongDrive = 16;  // stops of loop and survey
constexpr int kFarther = 9;     // stops left out: some 40 m of street

struct StopTally {
  std::array<std::size_t, 3> lights{};
  std::size_t wrong = 0;  // told to move on with a wrong pose
  std::vector<double> milliseconds;
};
using StopTallies = std::map<std::string, StopTally>;

// Everything that may happen at one stop behind a map.
class StopTrial {
 public:
  StopTrial(const Experiment& experiment, const std::vector<SimulatedStop>& stops, const Scan& elsewhere,
            StopTallies& tallies)
      : experiment_(experiment), stops_(stops), elsewhere_(elsewhere), tallies_(tallies) {}

  void at(const StopMap& map, std::size_t stop) {
    RandomStream random = RandomStream::keyed({experiment_.seed(), stop, 0x570bULL});
    const Scan& scan = stops_[stop].scan;
    const Pose odometry = odometryOf(stop - 1, stop);
    judge("good", map, scan, odometry, stop);
    const int first = static_cast<int>(random.below(300));
    judge("dirty window", map, dirtyWindow(scan, first, first + 61, stop), odometry, stop);
    judge("covered window", map, coveredWindow(scan, first, first + 61, cell_code::kLmsDazzled), odometry,
          stop);
    if (stop % 3 == 1)
      judge("blocked view", map, blockedStop(experiment_, static_cast<int>(stop), experiment_.seed()),
            odometry, stop);
    judge("another place", map, elsewhere_, odometry, stop, false);
    const double way = random.uniform(0.0, 2.0 * std::numbers::pi), size = random.uniform(2.0, 8.0);
    const Pose lie =
        Pose::planar(size * std::cos(way), size * std::sin(way),
                     random.uniform(30.0, 180.0) * kDegree * (random.uniform() < 0.5 ? 1.0 : -1.0));
    judge("odometry that lies", map, scan, odometry * lie, stop);
    if (stop + kFarther < stops_.size())
      judge("too far", map, stops_[stop + kFarther].scan, odometryOf(stop - 1, stop + kFarther),
            stop + kFarther);
  }

 private:
  Pose odometryOf(std::size_t from, std::size_t to) const {
    return stops_[from].truth * stops_[from].scan.odometry.inverse() * stops_[to].scan.odometry;
  }
  void judge(const std::string& kind, const StopMap& map, const Scan& scan, const Pose& odometry,
             std::size_t stop, bool has_truth = true) {
    const StopVerdict verdict = stopVerdict(map, scan, odometry);
    StopTally& tally = tallies_[kind];
    ++tally.lights.at(static_cast<std::size_t>(verdict.light));
    tally.milliseconds.push_back(verdict.milliseconds);
    if (verdict.light != StopLight::MoveOn) return;
    const PoseDifference error = difference(stops_[stop].truth, verdict.world_from_scan);
    tally.wrong += !has_truth || error.translation_m > kWrongM || error.rotation_rad > kWrongRad ? 1 : 0;
  }

  const Experiment& experiment_;
  const std::vector<SimulatedStop>& stops_;
  const Scan& elsewhere_;
  StopTallies& tallies_;
};

void tryExperiment(ExperimentId id, std::uint64_t seed, StopTallies& tallies) {
  const bool drive = id == ExperimentId::Loop || id == ExperimentId::Survey;
  const auto experiment = Experiment::make(id, seed, drive ? kLongDrive : 0);
  const auto stops = experiment->simulateAll(0);
  const auto elsewhere = Experiment::make(ExperimentId::Survey, seed + 5000, 1)->simulate(0, 0);
  if (!stops || !elsewhere) throw std::runtime_error("the simulation stopped");
  StopMap map;
  StopTrial trial(*experiment, *stops, elsewhere->scan, tallies);
  for (std::size_t i = 0; i < stops->size(); ++i) {
    if (i > 0) trial.at(map, i);
    map.add((*stops)[i].scan, (*stops)[i].truth);
  }
}

}  // namespace

bool addStopRows(Table& table, std::pair<int, int> seeds,
                 const std::function<void(const std::string&)>& tell) {
  StopTallies tallies;
  for (int seed = seeds.first; seed <= seeds.second; ++seed)
    for (const ExperimentId id :
         {ExperimentId::Exp1, ExperimentId::Exp2Fixed, ExperimentId::Loop, ExperimentId::Survey}) {
      tell("stops of " + std::string(nameOf(id)) + " seed " + std::to_string(seed));
      tryExperiment(id, static_cast<std::uint64_t>(seed), tallies);
    }
  const std::string subject = "Stops at the last line, seeds " + std::to_string(seeds.first) + " to " +
                              std::to_string(seeds.second) + ": told to move on";
  bool kept = true;
  for (auto& [kind, tally] : tallies) {
    const std::size_t total = tally.milliseconds.size(), on = tally.lights[0];
    std::ranges::sort(tally.milliseconds);
    Row row{.subject = subject, .program = kind};
    row.wall_ms = tally.milliseconds[total / 2];
    row.within = std::to_string(on) + "/" + std::to_string(total);
    std::array<char, 120> remark{};
    std::snprintf(remark.data(), remark.size(),
                  "rescan %zu, closer %zu; moved on with a wrong pose %zu; slowest %.0f ms", tally.lights[1],
                  tally.lights[2], tally.wrong, tally.milliseconds.back());
    row.remark = remark.data();
    table.rows.push_back(row);
    kept = kept && tally.wrong == 0;
    if (kind == "good")
      kept = kept && static_cast<double>(on) >= kRightCalledGood * static_cast<double>(total);
    if (kind == "dirty window" || kind == "covered window" || kind == "blocked view" ||
        kind == "another place")
      kept = kept && on == 0;
  }
  return kept;
}

}  // namespace tiltmap::benchmarks
