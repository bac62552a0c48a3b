#include "hardware/capture/capture_run.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/base/version.h"
#include "hardware/capture/capture_operation.h"
#include "hardware/capture/known_rig.h"
#include "hardware/capture/stop_odometry.h"

namespace tiltmap {

namespace {

// One capture under way.
class Capture {
 public:
  Capture(const CaptureTask& task, CaptureBench& bench, Sweep& sweep, LiveProject& live,
          const JobControl& job)
      : task_(task),
        plan_(task.plan),
        bench_(bench),
        sweep_(sweep),
        live_(live),
        job_(job),
        experiment_(bench.experiment()) {
    if (!task.snapshot->scans().empty()) last_pose_ = task.snapshot->scans().back().odometry();
  }

  Result<OperationResult> run() {
    if (!plan_.settings.odometry_from.empty() && !experiment_) {
      auto source = StopOdometry::make(plan_.settings.odometry_from, plan_.settings.odometry_axes);
      if (!source) return fail(source.error());
      odometry_source_ = std::move(*source);
    }
    sweep_.setSettings(sweepSettings(plan_.settings));
    if (Status status = sweep_.prepare(job_); !status) return fail(status.error());
    for (int k = 0; k < plan_.stops; ++k)
      if (Status status = stop(k); !status) return fail(status.error());
    return result();
  }

 private:
  // Where the stop is, as far as odometry knows; asks where nobody has said.
  Result<Pose> odometry(int k) {
    if (experiment_) return experiment_->poses()[static_cast<std::size_t>(plan_.first_stop + k)].odometry;
    if (k == 0 && task_.last_from_next)
      return last_pose_ ? *last_pose_ * *task_.last_from_next : *task_.last_from_next;
    const bool between = k > 0 || (plan_.settings.resume && !plan_.unfinished);
    if (odometry_source_) {
      if (between)
        if (auto there =
                task_.ask("drive to the next stop and press Enter once the vehicle stands", job_.stop);
            !there)
          return fail(there.error());
      return odometry_source_->poseOf(task_.snapshot->scans().size() + static_cast<std::size_t>(added_),
                                      last_pose_, plan_.settings.patience_s, job_);
    }
    std::string step = k == 0 ? plan_.settings.odometry : "";
    std::string trouble;
    while (between) {
      auto answer =
          task_.ask(trouble +
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
    // What is left, this one included.
    settings.stops = (plan_.drive_stops > 0 ? plan_.drive_stops - plan_.first_stop : plan_.stops) - k;
    settings.resume = false;
    job.values = captureTable().values(settings);
    job.program_version = programVersion();
    job.started = job.finished = utcNow();
    job.state = JobState::Accepted;
    return job;
  }

  // What the stop takes over from those before it.
  KnownRig known(const ScannerGeometry& sweep, const std::string& instruments) {
    if (!plan_.settings.known_rig) return {};
    auto rig = knownRig(*task_.snapshot, sweep, instruments);
    if (!rig) {
      warnings_.push_back("calibration and mask of earlier stops could not be read, so this one has none: " +
                          rig.error().what);
      return {};
    }
    known_rig_ = knownRigText(*rig);
    return std::move(*rig);
  }

  // The stop as the start of a capture in the project; its id.
  Result<ScanId> begin(int k, const ScannerGeometry& geometry, const Pose& pose) {
    const int number =
        experiment_ ? plan_.first_stop + k : static_cast<int>(task_.snapshot->scans().size()) + added_;
    AddScan add;
    add.scan.geometry = geometry;
    add.scan.odometry = pose;
    add.scan.name = "stop " + std::to_string(number);
    add.scan.source = sweep_.instrumentNames();
    if (experiment_) {
      add.scan.source = emulatedSource(plan_.settings.emulate, plan_.settings.seed);
      add.poses.emplace(Stage::Truth, experiment_->poses()[static_cast<std::size_t>(number)].truth);
    }
    ProjectEdit edit;
    edit.title = "capture " + add.scan.name;
    const KnownRig rig = known(geometry, add.scan.source);
    takeOver(rig, add.scan.geometry);
    edit.steps.emplace_back(std::move(add));
    if (rig.body) edit.steps.emplace_back(SetBodyMask{addedScan(0), rig.body});
    edit.jobs.push_back(record(k));
    auto change = live_.apply(std::move(edit));
    if (!change) return fail(change.error());
    ++added_;
    return change->scans_added.front();
  }

  Status stop(int k) {
    if (EmulatedBench* emulated = bench_.emulated())
      if (Status status = emulated->moveTo(plan_.first_stop + k); !status) return status;
    const bool unfinished = k == 0 && plan_.unfinished;
    ScannerGeometry geometry =
        sweep_.geometry(plan_.settings.lines, plan_.settings.start_rad, plan_.settings.step_rad);
    std::vector<bool> taken(static_cast<std::size_t>(geometry.rows), false);
    ScanId scan = 0;
    if (unfinished) {
      scan = plan_.unfinished->id;
      if (Status status = readUnfinished(geometry, taken); !status) return status;
    } else {
      if (Status status = sweep_.check(geometry); !status) return status;
      const auto pose = odometry(k);
      if (!pose) return fail(pose.error());
      auto begun = begin(k, geometry, *pose);
      if (!begun) return fail(begun.error());
      scan = *begun;
      last_pose_ = *pose;
    }
    if (task_.begun) task_.begun(scan, geometry, taken);
    JobControl part = job_;
    part.report = [this, k](const Progress& progress) {
      const std::string where =
          plan_.stops > 1 ? "stop " + std::to_string(k + 1) + " of " + std::to_string(plan_.stops) + ", "
                          : "";
      job_.tell((k + std::max(0.0, progress.fraction)) / plan_.stops, where + progress.message);
    };
    auto report = sweep_.run(
        geometry, std::move(taken),
        [this, scan](int row, ScanLine line) { return live_.appendLine(scan, row, std::move(line)); }, part,
        task_.events);
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
    if (!known_rig_.empty()) report["known_rig"] = known_rig_;
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

  const CaptureTask& task_;
  const CapturePlan& plan_;
  CaptureBench& bench_;
  Sweep& sweep_;
  LiveProject& live_;
  const JobControl& job_;
  const std::optional<Experiment>& experiment_;
  std::unique_ptr<StopOdometry> odometry_source_;
  std::optional<Pose> last_pose_;
  int added_ = 0;
  std::string known_rig_;  // what the last stop took over
  SweepReport total_;
  std::vector<double> durations_;
  std::vector<std::string> warnings_;
};

}  // namespace

SweepOptions sweepSettings(const CaptureSettings& settings) {
  SweepOptions sweep;
  sweep.patience_s = settings.patience_s;
  sweep.steady = settings.mode == CaptureMode::Continuous;
  return sweep;
}

double storedBytes(int lines, int columns) {
  // Ranges of 4 and codes of 2 bytes; half as much again is for the pages of the file and its log.
  return 1.5 * lines * (6.0 * columns + 200.0);
}

Result<OperationResult> runCapture(const CaptureTask& task, CaptureBench& bench, Sweep& sweep,
                                   LiveProject& live, const JobControl& job) {
  return Capture(task, bench, sweep, live, job).run();
}

}  // namespace tiltmap
