#include "tests/benchmarks/verdict_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>

#include "core/world/experiment.h"
#include "tests/benchmarks/verdict_cases.h"
#include "tests/support/real_scans.h"

namespace tiltmap::benchmarks {

namespace {

constexpr int kStops = 24;  // of the long drives

struct Tally {
  std::size_t total = 0, good = 0, doubtful = 0, bad = 0;
  std::vector<std::string> trouble;  // wrong ones called good

  void add(Verdict verdict) {
    ++total;
    ++(verdict == Verdict::Good ? good : verdict == Verdict::Doubtful ? doubtful : bad);
  }
};

struct Counts {
  std::map<std::string, Tally> kinds;  // "right", "wrong: slide", ...
  std::vector<double> nees;            // of right ones judged good, simulated
};

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

void count(const std::vector<VerdictCase>& cases, const std::string& name, bool truth_known, Counts& counts) {
  for (const VerdictCase& c : cases) {
    if (!c.counts) continue;
    Tally& tally = counts.kinds[c.right ? "right" : "wrong: " + c.kind];
    tally.add(c.judgement.verdict);
    const bool good = c.judgement.verdict == Verdict::Good;
    if (good && !c.right)
      tally.trouble.push_back(
          name + ", " + c.kind +
          text(": %.3f m, %.2f deg off called good", c.error.translation_m, c.error.rotation_rad / kDegree));
    if (good && c.right && truth_known)
      counts.nees.push_back(c.rig_error.dot(c.judgement.strength.covariance.ldlt().solve(c.rig_error)));
  }
}

void addRows(Table& table, const std::string& subject, const Counts& counts) {
  for (const auto& [kind, tally] : counts.kinds) {
    Row row{.subject = subject, .program = kind};
    row.within = std::to_string(tally.good) + "/" + std::to_string(tally.total) + " good";
    row.remark = text("doubtful %zu, bad %zu", tally.doubtful, tally.bad);
    table.rows.push_back(row);
    for (const std::string& trouble : tally.trouble) table.notes.push_back(trouble);
  }
}

void addTo(Counts& sum, const Counts& some) {
  for (const auto& [kind, tally] : some.kinds) {
    Tally& all = sum.kinds[kind];
    all.total += tally.total, all.good += tally.good, all.doubtful += tally.doubtful, all.bad += tally.bad;
  }
  sum.nees.insert(sum.nees.end(), some.nees.begin(), some.nees.end());
}

int stopsOf(ExperimentId id) {
  return id == ExperimentId::Loop || id == ExperimentId::Survey ? kStops : 0;
}

// Neighbours and second neighbours, and each stop against one of a place it never saw.
Counts simulatedCounts(ExperimentId id, int seed, const VerdictScan* elsewhere) {
  const auto stops = simulateExperiment(id, static_cast<std::uint64_t>(seed), stopsOf(id), 0);
  if (!stops) throw std::runtime_error(stops.error().what);
  std::vector<VerdictScan> scans;
  for (const SimulatedStop& stop : *stops) scans.push_back(verdictScan(stop.scan));
  Counts counts;
  const auto one = [&](std::size_t i, std::size_t j, const VerdictScan* moving) {
    VerdictPair pair;
    pair.fixed = &scans[i];
    pair.moving = moving ? moving : &scans[j];
    pair.overlaps = moving == nullptr;
    pair.truth = (*stops)[i].truth.inverse() * (*stops)[j].truth;
    pair.start = (*stops)[i].scan.odometry.inverse() * (*stops)[j].scan.odometry;
    pair.seed =
        static_cast<std::uint64_t>(seed) * 1000000 + static_cast<std::uint64_t>(id) * 100000 + i * 200 + j;
    const std::string name = std::string(nameOf(id)) + " seed " + std::to_string(seed) + ", pair " +
                             std::to_string(i) + ":" + std::to_string(j);
    count(verdictCases(pair, 1), name, true, counts);
  };
  for (std::size_t i = 0; i < scans.size(); ++i) {
    for (std::size_t j = i + 1; j < std::min(scans.size(), i + 3); ++j) one(i, j, nullptr);
    if (elsewhere && i + 1 < scans.size()) one(i, i + 1, elsewhere);
  }
  return counts;
}

// Real scans: a registration is right where chained and direct agree around a triangle.
Counts realCounts(const std::string& name, const std::vector<Scan>& raw) {
  Counts counts;
  std::vector<VerdictScan> scans;
  for (const Scan& scan : raw) scans.push_back(verdictScan(scan));
  std::map<std::pair<std::size_t, std::size_t>, Pose> found;
  const auto start = [&](std::size_t i, std::size_t j) {
    return raw[i].odometry.inverse() * raw[j].odometry;
  };
  for (std::size_t i = 0; i < scans.size(); ++i)
    for (std::size_t j = i + 1; j < std::min(scans.size(), i + 3); ++j) {
      const auto result = registerPair(scans[i].prepared, scans[j].prepared, start(i, j), {});
      if (result && result->succeeded()) found[{i, j}] = result->fixed_from_moving;
    }
  std::map<std::pair<std::size_t, std::size_t>, Pose> right;
  for (std::size_t i = 0; i + 2 < scans.size(); ++i) {
    const auto a = found.find({i, i + 1}), b = found.find({i + 1, i + 2}), c = found.find({i, i + 2});
    if (a == found.end() || b == found.end() || c == found.end()) continue;
    const PoseDifference closure = difference(a->second * b->second, c->second);
    if (closure.translation_m > kRightM || closure.rotation_rad > kRightRad) continue;
    for (const auto& side : {a, b, c}) right[side->first] = side->second;
  }
  for (const auto& [sides, truth] : right) {
    VerdictPair pair;
    pair.fixed = &scans[sides.first];
    pair.moving = &scans[sides.second];
    pair.truth = truth;
    pair.start = start(sides.first, sides.second);
    pair.seed = sides.first * 100 + sides.second;
    count(verdictCases(pair, 2),
          name + ", pair " + std::to_string(sides.first) + ":" + std::to_string(sides.second), false, counts);
  }
  return counts;
}

void addRealCounts(Table& table, Counts& sum, const std::function<void(const std::string&)>& tell) {
  using namespace test_support;
  const auto add = [&](const std::string& name, const std::vector<Scan>& scans) {
    tell("verdicts on " + name);
    const Counts counts = realCounts(name, scans);
    addRows(table, "Verdicts, " + name + ": pairs whose triangle closes", counts);
    addTo(sum, counts);
  };
  const auto skipped = [&](const std::string& name) {
    table.notes.push_back("Skipped: " + name +
                          " (no ../shared/data; TILTMAP_SHARED_DATA may name the folder).");
  };
  if (const auto folder = realData("bedkowski_13"))
    add("bedkowski_13", readStations(*folder));
  else
    skipped("bedkowski_13");
  if (const auto folder = realData("3dtk_dat"))
    add("3dtk_dat", {readUosScan(*folder, 0), readUosScan(*folder, 1), readUosScan(*folder, 2)});
  else
    skipped("3dtk_dat");
  if (const auto folder = realData("libpointmatcher")) {
    std::vector<Scan> scans;
    for (int i = 0; i < 3; ++i) {
      const std::string file = "cloud.0000" + std::to_string(i) + ".vtk";
      scans.push_back(cloudScan(readAsciiVtk(*folder / file), file));
    }
    add("libpointmatcher", scans);
  } else {
    skipped("libpointmatcher");
  }
}

// A mean of n chi-square numbers of 6 degrees lies within these in 95 of 100 cases.
std::pair<double, double> chiSquareBounds(std::size_t n) {
  const double half = 1.96 * std::sqrt(12.0 / static_cast<double>(n));
  return {6.0 - half, 6.0 + half};
}

}  // namespace

bool addVerdictRows(Table& table, std::pair<int, int> seeds,
                    const std::function<void(const std::string&)>& tell) {
  Counts sum;
  for (const ExperimentId id : {ExperimentId::Exp1, ExperimentId::Exp2Fixed, ExperimentId::Exp2,
                                ExperimentId::Loop, ExperimentId::Survey}) {
    Counts counts;
    for (int seed = seeds.first; seed <= seeds.second; ++seed) {
      tell("verdicts on " + std::string(nameOf(id)) + " seed " + std::to_string(seed));
      const auto other = Experiment::make(ExperimentId::Survey, static_cast<std::uint64_t>(seed) + 5000, 1);
      const auto scan = other->simulate(0, 0);
      const VerdictScan elsewhere = verdictScan(scan->scan);
      addTo(counts, simulatedCounts(id, seed, &elsewhere));
    }
    addRows(table,
            text("Verdicts, %s, seeds %d to %d: neighbours and second neighbours",
                 std::string(nameOf(id)).c_str(), seeds.first, seeds.second),
            counts);
    addTo(sum, counts);
  }
  addRealCounts(table, sum, tell);

  Tally wrong;
  for (const auto& [kind, tally] : sum.kinds)
    if (kind != "right") wrong.total += tally.total, wrong.good += tally.good;
  const Tally& right = sum.kinds["right"];
  const double share =
      right.total > 0 ? static_cast<double>(right.good) / static_cast<double>(right.total) : 0.0;
  const std::string subject = "Verdicts, all together";
  addRows(table, subject, sum);
  bool kept = wrong.good == 0 && share >= kRightCalledGood;
  table.notes.push_back(
      text("Verdicts: %zu of %zu wrong registrations called good; %zu of %zu right ones (%.1f %%).",
           wrong.good, wrong.total, right.good, right.total, 100.0 * share));
  if (wrong.total < kFewestWrong || right.total < kFewestRight)
    table.notes.push_back(text("Verdicts: a full count takes at least %zu wrong and %zu right ones.",
                               kFewestWrong, kFewestRight));
  if (!sum.nees.empty()) {
    double mean = 0.0;
    for (const double value : sum.nees) mean += value / static_cast<double>(sum.nees.size());
    const auto [low, high] = chiSquareBounds(sum.nees.size());
    const auto within =
        static_cast<std::size_t>(std::ranges::count_if(sum.nees, [](double v) { return v <= 12.592; }));
    Row row{.subject = subject, .program = "normalised error squared (6 expected)"};
    row.within = text("%.2f in %.2f to %.2f", mean, low, high);
    row.remark = text("%.1f %% below the 95 %% bound of a single pair",
                      100.0 * static_cast<double>(within) / static_cast<double>(sum.nees.size()));
    table.rows.push_back(row);
    kept = kept && mean >= low && mean <= high;
  }
  return kept;
}

}  // namespace tiltmap::benchmarks
