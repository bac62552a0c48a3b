#include "hardware/capture/station_capture.h"

namespace tiltmap {

namespace {

class StationCapture : public SettingsOperation<CaptureSettings> {
 public:
  StationCapture(std::shared_ptr<CaptureStation> station, std::optional<Pose> last_from_next)
      : SettingsOperation(captureTable()),
        station_(std::move(station)),
        last_from_next_(std::move(last_from_next)) {}
  std::string title() const override { return "Capture a stop"; }
  std::string help() const override {
    return "Takes a scan line by line with the instruments that are connected; each line is stored as soon "
           "as it "
           "is complete.";
  }
  Result<OperationResult> runLive(const SnapshotPtr& snapshot, const ParameterValues& values,
                                  const JobControl& control, LiveProject& live) const override {
    CaptureSettings settings;
    if (Status status = captureTable().apply(values, settings); !status) return fail(status.error());
    return station_->capture(snapshot, settings, last_from_next_, live, control);
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const CaptureSettings& settings) const override {
    return station_->checkCapture(snapshot, settings);
  }
  Result<OperationResult> runSettings(const SnapshotPtr&, const CaptureSettings&,
                                      const JobControl&) const override {
    return fail("a capture stores while it runs and needs the project", "capture",
                "run it as a job of an open project");
  }

 private:
  std::shared_ptr<CaptureStation> station_;
  std::optional<Pose> last_from_next_;
};

}  // namespace

std::unique_ptr<Operation> makeStationCapture(std::shared_ptr<CaptureStation> station,
                                              std::optional<Pose> last_from_next) {
  return std::make_unique<StationCapture>(std::move(station), std::move(last_from_next));
}

}  // namespace tiltmap
