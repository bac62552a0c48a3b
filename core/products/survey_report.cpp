#include "core/products/survey_report.h"

#include <algorithm>
#include <map>

#include "core/products/scan_colours.h"
#include "core/project/operation.h"
#include "core/project/operations/relax_operation.h"
#include "core/scan/range_image.h"

namespace tiltmap {

namespace {

constexpr std::size_t kMostPoints = 3'000'000;

ReportStage stageReport(const ProjectSnapshot& snapshot, Stage stage) {
  const std::vector<Pose> poses = snapshot.filledPoses(stage);
  ReportStage report{localisationTable(stageName(stage), poses), std::nullopt};
  if (stage == Stage::Truth || !snapshot.hasStage(Stage::Truth)) return report;
  if (auto evaluation = evaluateTrajectory(poses, snapshot.filledPoses(Stage::Truth)))
    report.evaluation = *evaluation;
  return report;
}

std::vector<ReportPair> pairReports(const ProjectSnapshot& snapshot) {
  std::vector<ReportPair> pairs;
  for (const Link& link : snapshot.links()) {
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving || link.stop_reason == kFoundByRelaxation) continue;
    pairs.push_back({*fixed, *moving, link.overlap, link.rms_m, link.correspondences, link.iterations,
                     link.stop_reason, link.milliseconds, link.succeeded});
  }
  return pairs;
}

std::vector<ReportTrust> trustOf(const ProjectSnapshot& snapshot) {
  std::vector<ReportTrust> trust;
  const auto judged = judgeLinks(snapshot, snapshot.latestStage());
  for (std::size_t k = 0; k < judged.size(); ++k) {
    const Link& link = snapshot.links()[k];
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (fixed && moving) trust.push_back({*fixed, *moving, judged[k]});
  }
  return trust;
}

std::size_t relaxedLinks(const ProjectSnapshot& snapshot) {
  return static_cast<std::size_t>(std::ranges::count_if(
      snapshot.links(), [](const Link& link) { return link.stop_reason == kFoundByRelaxation; }));
}

std::vector<ReportMovement> movementsOf(const ProjectSnapshot& snapshot) {
  std::vector<ReportMovement> movements;
  if (!snapshot.hasStage(Stage::Pairwise) || !snapshot.hasStage(Stage::Relaxed)) return movements;
  const std::vector<Pose> before = snapshot.filledPoses(Stage::Pairwise);
  const std::vector<Pose> after = snapshot.filledPoses(Stage::Relaxed);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const PoseDifference by = difference(before[i], after[i]);
    movements.push_back({i, by.translation_m, by.rotation_rad / kDegree});
  }
  return movements;
}

// The last accepted job of each operation, in the order in which they ran.
std::vector<const JobRecord*> lastJobs(const ProjectSnapshot& snapshot) {
  std::map<std::string, const JobRecord*> last;
  for (const JobRecord& job : snapshot.jobs()) last[job.operation] = &job;
  std::vector<const JobRecord*> jobs;
  for (const JobRecord& job : snapshot.jobs())
    if (last.at(job.operation) == &job) jobs.push_back(&job);
  return jobs;
}

}  // namespace

Result<TopViewInput> topViewOf(const ProjectSnapshot& snapshot, Stage stage, const std::string& title,
                               const JobControl& control) {
  if (snapshot.scans().empty())
    return fail("the project has no scans to draw", snapshot.path().string(),
                "import, simulate or capture some first");
  TopViewInput input;
  input.title = title;
  input.world_from_scan = snapshot.filledPoses(stage);
  input.colours = scanColours(snapshot);
  std::size_t total = 0;
  for (const ScanEntry& scan : snapshot.scans()) total += scan.valid_cells;
  const std::size_t step = total / kMostPoints + 1;
  for (std::size_t i = 0; i < snapshot.scans().size(); ++i) {
    if (control.stopRequested()) return fail(kCancelled, "top view", "start again when you like");
    auto scan = snapshot.scans()[i].scan();
    if (!scan) return fail(scan.error());
    const auto points = cellPoints(*scan->image, scan->geometry);
    TopViewCloud cloud;
    cloud.scan = i;
    std::size_t counted = 0;
    for (std::size_t cell = 0; cell < points.size(); ++cell)
      if (scan->image->hasPoint(cell) && counted++ % step == 0)
        cloud.points.push_back(input.world_from_scan[i] * points[cell]);
    input.clouds.push_back(std::move(cloud));
  }
  return input;
}

ReportData reportOf(const ProjectSnapshot& snapshot, const std::string& survey_name) {
  ReportData report;
  report.survey = survey_name;
  report.scan_count = snapshot.scans().size();
  for (const ScanEntry& scan : snapshot.scans()) report.point_count += scan.valid_cells;
  for (const Stage stage : snapshot.stages()) report.stages.push_back(stageReport(snapshot, stage));
  report.pairs = pairReports(snapshot);
  report.trust = trustOf(snapshot);
  report.relaxed_links = relaxedLinks(snapshot);
  report.movements = movementsOf(snapshot);
  for (const JobRecord* job : lastJobs(snapshot)) {
    for (const std::string& warning : job->warnings) report.warnings.push_back(warning);
    const Operation* operation = operations().find(job->operation);
    report.parameters.push_back({job->operation, job->preset, job->values,
                                 operation ? operation->parameters() : std::vector<ParameterInfo>()});
    report.program_version = job->program_version;
    report.date = job->finished;
  }
  return report;
}

}  // namespace tiltmap
