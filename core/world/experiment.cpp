#include "core/world/experiment.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/scan/beam_tilts.h"
#include "core/world/drive.h"

namespace tiltmap {

namespace {

constexpr std::array<std::pair<ExperimentId, std::string_view>, 5> kNames{
    {{ExperimentId::Exp1, "exp1"},
     {ExperimentId::Exp2, "exp2"},
     {ExperimentId::Exp2Fixed, "exp2fixed"},
     {ExperimentId::Loop, "loop"},
     {ExperimentId::Survey, "survey"}}};
constexpr double kStartTime = 1149152400.0;  // 2006-06-01 09:00:00 UTC, seconds since the Unix epoch
constexpr double kSeenM = 86.0;              // how far around a stop the site is built

Status fits(const SimulationSettings& settings) {
  if (const Status checked = settings.geometry.check(); !checked) return checked;
  if (!settings.true_geometry) return {};
  if (const Status checked = settings.true_geometry->check(); !checked) return checked;
  if (settings.true_geometry->rows != settings.geometry.rows ||
      settings.true_geometry->columns != settings.geometry.columns)
    return fail("the true scanner's matrix has another size than the stored one's", "simulation settings",
                "give both geometries the same rows and columns");
  return {};
}

}  // namespace

std::string_view nameOf(ExperimentId id) {
  for (const auto& [known, name] : kNames)
    if (known == id) return name;
  return "unknown";
}

Result<ExperimentId> experimentNamed(std::string_view name) {
  for (const auto& [id, known] : kNames)
    if (known == name) return id;
  return fail("there is no experiment called \"" + std::string(name) + "\"", "experiment",
              "choose one of exp1, exp2, exp2fixed, loop, survey");
}

int defaultStops(ExperimentId id) {
  switch (id) {
    case ExperimentId::Exp1:
      return 5;
    case ExperimentId::Exp2:
    case ExperimentId::Exp2Fixed:
      return 14;
    case ExperimentId::Loop:
      return 40;
    case ExperimentId::Survey:
      return 50;
  }
  return 0;
}

struct Experiment::Plan {
  ExperimentId id = ExperimentId::Exp1;
  std::uint64_t seed = 1;
  Drive drive;
  std::vector<StopPoses> poses;
};

Result<Experiment> Experiment::make(ExperimentId id, std::uint64_t seed, int stops) {
  const bool from_tables = id != ExperimentId::Loop && id != ExperimentId::Survey;
  if (stops < 0 || (from_tables && stops > defaultStops(id)) || stops > 100'000)
    return fail("experiment " + std::string(nameOf(id)) + " cannot have " + std::to_string(stops) + " stops",
                "stops", from_tables ? "give 1 to " + std::to_string(defaultStops(id)) : "give 1 to 100000");
  const int count = stops == 0 ? defaultStops(id) : stops;
  auto plan = std::make_shared<Plan>();
  plan->id = id;
  plan->seed = seed;
  switch (id) {
    case ExperimentId::Exp1:
      plan->drive = experiment1Drive(seed);
      break;
    case ExperimentId::Exp2:
      plan->drive = experiment2Drive(seed, false);
      break;
    case ExperimentId::Exp2Fixed:
      plan->drive = experiment2Drive(seed, true);
      break;
    case ExperimentId::Loop:
      plan->drive = loopDrive(seed, count);
      break;
    case ExperimentId::Survey:
      plan->drive = surveyDrive(seed, count);
      break;
  }
  Drive& drive = plan->drive;
  drive.site_from_scan.resize(static_cast<std::size_t>(count));
  const std::vector<Pose> truth = rebased(drive.site_from_scan);
  for (std::size_t i = 0; i < truth.size(); ++i) plan->poses.push_back({drive.odometry[i], truth[i]});
  return Experiment(std::move(plan));
}

ExperimentId Experiment::id() const {
  return plan_->id;
}
std::uint64_t Experiment::seed() const {
  return plan_->seed;
}
int Experiment::stops() const {
  return static_cast<int>(plan_->poses.size());
}
const std::vector<StopPoses>& Experiment::poses() const {
  return plan_->poses;
}
Pose Experiment::siteFromWorld() const {
  return plan_->drive.site_from_scan.front();
}

std::shared_ptr<const Site> Experiment::siteAt(int stop) const {
  const Eigen::Vector2d centre =
      plan_->drive.site_from_scan.at(static_cast<std::size_t>(stop)).translation().head<2>();
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(kSeenM + 6.0);
  Ground ground(plan_->drive.terrain, centre - reach, centre + reach);
  const StreetGrid& grid = plan_->drive.grid;
  std::vector<Shape> shapes = shapesAround(grid, ground, centre, kSeenM);
  return std::make_shared<const Site>(std::move(ground), std::move(shapes),
                                      [grid](double x, double y) { return grid.groundReflectivity(x, y); });
}

Result<SimulatedStop> Experiment::simulate(int stop, int threads, const JobControl& job,
                                           const SimulationSettings& settings) const {
  if (stop < 0 || stop >= stops()) throw std::invalid_argument("Experiment::simulate: no such stop");
  if (const Status checked = fits(settings); !checked) return fail(checked.error());
  return simulateIn(*siteAt(stop), stop, threads, job, settings, true);
}

Result<SimulatedStop> Experiment::simulateIn(const Site& site, int stop, int threads, const JobControl& job,
                                             const SimulationSettings& settings, bool report) const {
  const ScannerGeometry& scanner = settings.true_geometry ? *settings.true_geometry : settings.geometry;
  const double line_s = lineDuration(scanner, settings.beam);
  const double scan_s = settings.line_period_s * (scanner.rows - 1) + line_s;
  const double start = kStartTime + stop * (scan_s + settings.drive_s);

  RangeImageData data;
  data.rows = scanner.rows;
  data.columns = scanner.columns;
  data.range_m.resize(data.cells());
  data.code.resize(data.cells());
  data.intensity.resize(data.cells());
  data.line_tilt_rad.resize(static_cast<std::size_t>(data.rows));
  data.line_time_s.resize(static_cast<std::size_t>(data.rows));
  const Pose site_from_scan = siteFromScan(stop);
  std::atomic<int> done = 0;
  parallelFor(static_cast<std::size_t>(data.rows), threads, [&](std::size_t row) {
    if (job.stopRequested()) return;
    const double line_start = start + settings.line_period_s * static_cast<double>(row);
    const double level = settings.geometry.tiltOfRow(static_cast<int>(row));
    const double speed =
        settings.continuous_tilt ? settings.geometry.tilt_step_rad / settings.line_period_s : 0.0;
    // The tilt is read back when the line ends, as its time is taken.
    const auto tilt = [=](double time_s) { return level + speed * (time_s - line_start - line_s); };
    const std::vector<Echo> echoes =
        castLine(site, site_from_scan, scanner, tilt, line_start,
                 RandomStream::keyed({plan_->seed, static_cast<std::uint64_t>(plan_->id),
                                      static_cast<std::uint64_t>(stop), row}),
                 settings.beam);
    const std::size_t first = row * echoes.size();
    for (std::size_t j = 0; j < echoes.size(); ++j) {
      data.range_m[first + j] = echoes[j].range_m;
      data.code[first + j] = echoes[j].code;
      data.intensity[first + j] = echoes[j].intensity;
    }
    data.line_tilt_rad[row] = level;
    data.line_time_s[row] = line_start + line_s;
    if (report) job.tell(static_cast<double>(++done) / data.rows, "scanning stop " + std::to_string(stop));
  });
  if (job.stopRequested()) return fail(kCancelled, "simulation", "start it again");
  if (settings.continuous_tilt) {
    const double speed = settings.geometry.tilt_step_rad / settings.line_period_s;
    setTurnTilts(data,
                 std::vector<double>(static_cast<std::size_t>(data.rows), speed * settings.beam.turn_s));
  }
  auto image = RangeImage::make(std::move(data));
  if (!image) return fail(image.error());
  SimulatedStop result;
  const StopPoses& poses_here = poses()[static_cast<std::size_t>(stop)];
  result.scan.image = *image;
  result.scan.geometry = settings.geometry;
  result.scan.odometry = poses_here.odometry;
  result.scan.name = "stop " + std::to_string(stop);
  result.scan.source = "simulated " + std::string(nameOf(plan_->id)) + " seed " + std::to_string(plan_->seed);
  result.truth = poses_here.truth;
  return result;
}

Result<std::vector<SimulatedStop>> Experiment::simulateAll(int threads, const JobControl& job,
                                                           const SimulationSettings& settings) const {
  if (const Status checked = fits(settings); !checked) return fail(checked.error());
  const auto count = static_cast<std::size_t>(stops());
  std::vector<Result<SimulatedStop>> slots(count, SimulatedStop{});
  std::atomic<int> done = 0;
  parallelFor(count, threads, [&](std::size_t i) {
    const int stop = static_cast<int>(i);
    if (job.stopRequested()) return;
    slots[i] = simulateIn(*siteAt(stop), stop, 1, job, settings, false);
    job.tell(static_cast<double>(++done) / static_cast<double>(count),
             "scanning stop " + std::to_string(stop));
  });
  if (job.stopRequested()) return fail(kCancelled, "simulation", "start it again");
  std::vector<SimulatedStop> result;
  result.reserve(count);
  for (auto& slot : slots) {
    if (!slot) return fail(slot.error());
    result.push_back(std::move(*slot));
  }
  return result;
}

Result<std::vector<SimulatedStop>> simulateExperiment(ExperimentId id, std::uint64_t seed, int stops,
                                                      int threads, const JobControl& job,
                                                      const SimulationSettings& settings) {
  const auto experiment = Experiment::make(id, seed, stops);
  if (!experiment) return fail(experiment.error());
  return experiment->simulateAll(threads, job, settings);
}

Result<std::vector<StopPoses>> experimentPoses(ExperimentId id, std::uint64_t seed, int stops) {
  const auto experiment = Experiment::make(id, seed, stops);
  if (!experiment) return fail(experiment.error());
  return experiment->poses();
}

}  // namespace tiltmap
