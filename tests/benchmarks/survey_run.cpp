#include "tests/benchmarks/survey_run.h"

#include <span>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/project/project.h"
#include "core/world/experiment.h"
#include "tests/benchmarks/process_run.h"

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;

constexpr double kMost_s = 20.0;
constexpr double kMost_mb = 2048.0;
constexpr double kMostRatio = 1.5;
constexpr double kMostOneMore = 0.1;  // of relaxing all

struct Survey {
  Ended registered, relaxed, one_more;
  double first_mm = 0.0, first_deg = 0.0, last_mm = 0.0, last_deg = 0.0;
  double all_s() const { return 1e-3 * (registered.timing.wall_ms + relaxed.timing.wall_ms); }
  double all_cpu_ms() const { return registered.timing.cpu_ms + relaxed.timing.cpu_ms; }
};

void addStops(const fs::path& path, bool create, std::span<SimulatedStop> stops) {
  auto project = create ? Project::create(path.string()) : Project::open(path.string(), Access::ReadWrite);
  if (!project) throw std::runtime_error(project.error().what);
  std::vector<Scan> scans;
  for (SimulatedStop& stop : stops) scans.push_back(std::move(stop.scan));
  ProjectEdit edit = importEdit(std::move(scans));
  for (std::size_t i = 0; i < stops.size(); ++i)
    std::get<AddScan>(edit.steps[i]).poses.emplace(Stage::Truth, stops[i].truth);
  if (const auto change = (*project)->apply(edit); !change) throw std::runtime_error(change.error().what);
}

Survey measured(int count, const fs::path& program, const fs::path& scratch) {
  const auto drive = Experiment::make(ExperimentId::Survey, 1, count + 1);
  if (!drive) throw std::runtime_error(drive.error().what);
  auto stops = drive->simulateAll(0);
  if (!stops) throw std::runtime_error(stops.error().what);
  fs::remove_all(scratch);
  fs::create_directories(scratch);
  const fs::path path = scratch / "survey.tiltmap";
  const std::span<SimulatedStop> all(*stops);
  addStops(path, true, all.first(static_cast<std::size_t>(count)));
  const auto ended = [&](const std::string& command) {
    Ended one = run(program, {command, path.string(), "--json", "--quiet"}, scratch);
    if (one.exit_code != 0) throw std::runtime_error("tiltmap " + command + " did not succeed");
    return one;
  };
  const auto evaluate = [&](double& mm, double& deg) {
    const nlohmann::json errors = nlohmann::json::parse(ended("evaluate").output);
    mm = errors.at("rmse_translation_m").get<double>() * 1e3;
    deg = errors.at("rmse_rotation_deg").get<double>();
  };
  Survey survey;
  survey.registered = ended("register");
  survey.relaxed = ended("relax");
  evaluate(survey.first_mm, survey.first_deg);
  addStops(path, false, all.last(1));
  survey.one_more = ended("relax");
  evaluate(survey.last_mm, survey.last_deg);
  fs::remove_all(scratch);
  return survey;
}

Row rowOf(const std::string& subject, const std::string& what, const Ended& ended) {
  return {.subject = subject,
          .program = what,
          .wall_ms = ended.timing.wall_ms,
          .cpu_ms = ended.timing.cpu_ms,
          .remark = "peak " + fixedReal(ended.peak_mb, 0) + " MB"};
}

bool require(Table& table, bool kept, const std::string& what) {
  if (!kept) table.notes.push_back("Limit not kept, surveys: " + what);
  return kept;
}

}  // namespace

bool addSurveyRows(Table& table, const fs::path& program, const fs::path& scratch,
                   const std::function<void(const std::string&)>& tell) {
  double stop_of_100_ms = 0.0;
  bool kept = true;
  for (const int count : {100, 300, 1000}) {
    const std::string stops = std::to_string(count) + " stops";
    tell("a survey of " + stops);
    const Survey survey = measured(count, program, scratch);
    // By CPU time, which other programs on the machine disturb least.
    const double stop_ms = survey.all_cpu_ms() / count;
    if (count == 100) stop_of_100_ms = stop_ms;
    const std::string subject = "survey seed 1, " + stops + ", all cores; errors are RMSE over the stops";
    table.rows.push_back(rowOf(subject, "tiltmap register", survey.registered));
    Row relaxed = rowOf(subject, "tiltmap relax", survey.relaxed);
    relaxed.median_mm = survey.first_mm, relaxed.median_deg = survey.first_deg;
    relaxed.remark = fixedReal(survey.all_s(), 1) + " s with registering; CPU " + fixedReal(stop_ms, 1) +
                     " ms a stop, " + fixedReal(stop_ms / stop_of_100_ms, 2) + " of that at 100 stops; " +
                     relaxed.remark;
    table.rows.push_back(relaxed);
    Row more = rowOf(subject, "one stop more, tiltmap relax", survey.one_more);
    more.median_mm = survey.last_mm, more.median_deg = survey.last_deg;
    const double of_all = survey.one_more.timing.cpu_ms / survey.relaxed.timing.cpu_ms;
    more.remark = fixedReal(100.0 * of_all, 1) + " % of relaxing all; " + more.remark;
    table.rows.push_back(more);
    if (count < 1000) continue;
    kept = require(table, survey.all_s() <= kMost_s, stops + " took more than 20 s") && kept;
    kept = require(table, survey.relaxed.peak_mb <= kMost_mb, stops + " took more than 2 GB") && kept;
    kept = require(table, stop_ms <= kMostRatio * stop_of_100_ms,
                   "a stop of 1000 took more than 1.5 times one of 100") &&
           kept;
    kept = require(table, of_all <= kMostOneMore, "one stop more took over a tenth of all") && kept;
  }
  return kept;
}

}  // namespace tiltmap::benchmarks
