#include "hardware/capture/capture_operation.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/base/version.h"
#include "core/project/live_project.h"
#include "hardware/capture/capture_plan.h"
#include "hardware/capture/instruments.h"

namespace tiltmap {

namespace {

// One capture under way.
class Capture {
 public:
  Capture(const SnapshotPtr& snapshot, CapturePlan plan, const AskOperator& ask, const JobControl& job,
          LiveProject& live)
      : snapshot_(snapshot), plan_(std::move(plan)), ask_(ask), job_(job), live_(live) {
    if (!snapshot->scans().empty()) last_pose_ = snapshot->scans().back().odometry();
  }

  Result<OperationResult> run() {
    if (Status status = open(); !status) return fail(status.error());
    if (Status status = sweep_->prepare(job_); !status) return fail(status.error());
    for (int k = 0; k < plan_.stops; ++k) {
      if (Status status = stop(k); !status) {
        (void)sweep_->release();
        return fail(status.error());
      }
    }
    if (Status status = sweep_->release(); !status)
      warnings_.push_back("the instruments could not be put to rest: " + status.error().what);
    return result();
  }

 private:
  Status open() {
    const CaptureSettings& s = plan_.settings;
    Instruments instruments;
    if (s.emulate == CaptureDrive::None) {
      clock_ = std::make_unique<RealClock>();
      auto named = namedInstruments(s.scanner, s.tilt, *clock_, ask_);
      if (!named) return fail(named.error());
      instruments = std::move(*named);
    } else {
      auto experiment = Experiment::make(experimentOf(s.emulate), static_cast<std::uint64_t>(s.seed),
                                         plan_.first_stop + plan_.stops);
      if (!experiment) return fail(experiment.error());
      experiment_.emplace(*experiment);
      RigSettings rig;
      rig.start_rad = s.start_rad;
      rig.step_rad = s.step_rad;
      auto bench = EmulatedBench::make(*experiment, rig, s.speed, s.baud);
      if (!bench) return fail(bench.error());
      bench_ = std::move(*bench);
      instruments = bench_->instruments();
    }
    SweepSettings settings;
    settings.patience_s = s.patience_s;
    settings.steady = s.mode == CaptureMode::Continuous;
    sweep_ = std::make_unique<Sweep>(std::move(instruments), settings);
    return {};
  }

  // Where the stop is, as far as odometry knows; asks where nobody has said.
  Result<Pose> odometry(int k) {
    if (experiment_) return experiment_->poses()[static_cast<std::size_t>(plan_.first_stop + k)].odometry;
    std::string step = k == 0 ? plan_.settings.odometry : "";
    const bool between = k > 0 || (plan_.settings.resume && !plan_.unfinished);
    std::string trouble;
    while (between) {
      auto answer =
          ask_(trouble +
                   "drive to the next stop and give X,Y,HEADING since the last one (m right, m forward, "
                   "deg left)",
               job_.stop);
      if (!answer) return fail(answer.error());
      step = std::string(trimmed(*answer));
      const auto motion = parseStep(step);
      if (motion && !step.empty()) break;
      trouble = motion ? "" : motion.error().what + "; ";
    }
    const auto motion = parseStep(step);
    if (!motion) return fail(motion.error());
    if (last_pose_ && step.empty())
      warnings_.push_back("no odometry was given: the stop is stored where the last one was");
    return last_pose_ ? *last_pose_ * *motion : *motion;
  }

  JobRecord record(int k) const {
    JobRecord job;
    job.operation = kCaptureId;
    job.preset = "default";
    CaptureSettings settings = plan_.settings;
    settings.stops = plan_.stops - k;  // what is left, this one included
    settings.resume = false;
    job.values = captureTable().values(settings);
    job.program_version = programVersion();
    job.started = job.finished = utcNow();
    job.state = JobState::Accepted;
    return job;
  }

  // The stop as the start of a capture in the project; its id.
  Result<ScanId> begin(int k, const ScannerGeometry& geometry, const Pose& pose) {
    const int number =
        experiment_ ? plan_.first_stop + k : static_cast<int>(snapshot_->scans().size()) + added_;
    AddScan add;
    add.scan.geometry = geometry;
    add.scan.odometry = pose;
    add.scan.name = "stop " + std::to_string(number);
    add.scan.source = sweep_->instrumentNames();
    if (experiment_) {
      add.scan.source = "emulated " + std::string(nameOf(experiment_->id())) + " seed " +
                        std::to_string(experiment_->seed());
      add.poses.emplace(Stage::Truth, experiment_->poses()[static_cast<std::size_t>(number)].truth);
    }
    ProjectEdit edit;
    edit.title = "capture " + add.scan.name;
    edit.steps.emplace_back(std::move(add));
    edit.jobs.push_back(record(k));
    auto change = live_.apply(std::move(edit));
    if (!change) return fail(change.error());
    ++added_;
    return change->scans_added.front();
  }

  Status stop(int k) {
    if (bench_)
      if (Status status = bench_->moveTo(plan_.first_stop + k); !status) return status;
    const bool unfinished = k == 0 && plan_.unfinished;
    ScannerGeometry geometry =
        sweep_->geometry(plan_.settings.lines, plan_.settings.start_rad, plan_.settings.step_rad);
    std::vector<bool> taken(static_cast<std::size_t>(geometry.rows), false);
    ScanId scan = 0;
    if (unfinished) {
      scan = plan_.unfinished->id;
      if (Status status = readUnfinished(geometry, taken); !status) return status;
    } else {
      if (Status status = sweep_->check(geometry); !status) return status;
      const auto pose = odometry(k);
      if (!pose) return fail(pose.error());
      auto begun = begin(k, geometry, *pose);
      if (!begun) return fail(begun.error());
      scan = *begun;
      last_pose_ = *pose;
    }
    JobControl part = job_;
    part.report = [this, k](const Progress& progress) {
      const std::string where =
          plan_.stops > 1 ? "stop " + std::to_string(k + 1) + " of " + std::to_string(plan_.stops) + ", "
                          : "";
      job_.tell((k + std::max(0.0, progress.fraction)) / plan_.stops, where + progress.message);
    };
    auto report = sweep_->run(
        geometry, std::move(taken),
        [this, scan](int row, ScanLine line) { return live_.appendLine(scan, row, std::move(line)); }, part);
    if (!report) return fail(report.error());
    note(*report);
    return {};
  }

  Status readUnfinished(ScannerGeometry& geometry, std::vector<bool>& taken) const {
    const ScanEntry& entry = *plan_.unfinished;
    if (geometry.columns != entry.columns)
      return fail("the scan was begun with " + std::to_string(entry.columns) +
                      " values a line and the scanner sends " + std::to_string(geometry.columns),
                  entry.name, "use the scanner and the variant it was begun with, or begin a new scan");
    geometry = entry.geometry;
    const auto image = entry.image();
    if (!image) return fail(image.error());
    taken.assign(static_cast<std::size_t>(entry.rows), false);
    for (int row = 0; row < entry.rows; ++row)
      taken[static_cast<std::size_t>(row)] = (*image)->code(row, 0) != cell_code::kNotScanned;
    return {};
  }

  void note(const SweepReport& report) {
    total_.taken += report.taken;
    total_.spoiled += report.spoiled;
    total_.recoveries += report.recoveries;
    total_.slowest_store_s = std::max(total_.slowest_store_s, report.slowest_store_s);
    durations_.push_back(report.duration_s);
    for (const std::string& text : report.warnings)
      if (std::ranges::find(warnings_, text) == warnings_.end()) warnings_.push_back(text);
  }

  OperationResult result() const {
    OperationResult outcome;
    outcome.warnings = warnings_;
    nlohmann::json report = {{"stops", plan_.stops},
                             {"lines", total_.taken},
                             {"seconds_per_scan", durations_},
                             {"spoiled", total_.spoiled},
                             {"recoveries", total_.recoveries},
                             {"slowest_store_ms", 1000.0 * total_.slowest_store_s}};
    if (experiment_) {
      const Mip50EmulatorSettings motor;
      report["experiment"] = std::string(nameOf(experiment_->id()));
      report["seed"] = experiment_->seed();
      report["motor"] = {{"counts_per_ms", motor.most_speed},
                         {"counts_per_ms2", motor.most_acceleration},
                         {"settling_ms", 1000.0 * motor.settle_s}};
    }
    outcome.report_json = report.dump();
    return outcome;
  }

  SnapshotPtr snapshot_;
  CapturePlan plan_;
  const AskOperator& ask_;
  const JobControl& job_;
  LiveProject& live_;
  std::unique_ptr<RealClock> clock_;
  std::optional<Experiment> experiment_;
  std::unique_ptr<EmulatedBench> bench_;
  std::unique_ptr<Sweep> sweep_;
  std::optional<Pose> last_pose_;
  int added_ = 0;
  SweepReport total_;
  std::vector<double> durations_;
  std::vector<std::string> warnings_;
};

class CaptureOperation : public SettingsOperation<CaptureSettings> {
 public:
  explicit CaptureOperation(AskOperator ask) : SettingsOperation(captureTable()), ask_(std::move(ask)) {}
  std::string title() const override { return "Capture with the scanner"; }
  std::string help() const override {
    return "Takes a scan line by line with a tilted scanner: each line while the tilt stands still, stored "
           "as soon as it "
           "is complete. What is interrupted can be gone on with.";
  }
  Result<OperationResult> runLive(const SnapshotPtr& snapshot, const ParameterValues& values,
                                  const JobControl& control, LiveProject& live) const override {
    CaptureSettings settings;
    if (Status status = captureTable().apply(values, settings); !status) return fail(status.error());
    auto plan = planCapture(*snapshot, settings);
    if (!plan) return fail(plan.error());
    return Capture(snapshot, std::move(*plan), ask_, control, live).run();
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const CaptureSettings& settings) const override {
    const auto plan = planCapture(snapshot, settings);
    if (!plan) return fail(plan.error());
    if (const Status status = checkCapture(plan->settings, ask_); !status) return status;
    const ScannerGeometry geometry{.rows = plan->settings.lines,
                                   .tilt_start_rad = plan->settings.start_rad,
                                   .tilt_step_rad = plan->settings.step_rad};
    return geometry.check();
  }
  Result<OperationResult> runSettings(const SnapshotPtr&, const CaptureSettings&,
                                      const JobControl&) const override {
    return fail("a capture stores while it runs and needs the project", "capture",
                "run it as a job of an open project");
  }

 private:
  AskOperator ask_;
};

}  // namespace

std::unique_ptr<Operation> makeCaptureOperation(AskOperator ask) {
  return std::make_unique<CaptureOperation>(std::move(ask));
}

}  // namespace tiltmap
