#include "hardware/capture/capture_operation.h"

#include "hardware/capture/capture_run.h"

namespace tiltmap {

namespace {

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
    auto bench = CaptureBench::open(plan->settings, plan->first_stop + plan->stops, ask_);
    if (!bench) return fail(bench.error());
    Sweep sweep((*bench)->instruments(), sweepSettings(plan->settings));
    CaptureTask task;
    task.snapshot = snapshot;
    task.plan = std::move(*plan);
    task.ask = ask_;
    auto outcome = runCapture(task, **bench, sweep, live, control);
    const Status rest = sweep.release();
    if (outcome && !rest)
      outcome->warnings.push_back("the instruments could not be put to rest: " + rest.error().what);
    return outcome;
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const CaptureSettings& settings) const override {
    const auto plan = planCapture(snapshot, settings);
    if (!plan) return fail(plan.error());
    if (const Status status = checkCapture(snapshot, plan->settings, ask_); !status) return status;
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
