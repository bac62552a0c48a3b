#include "core/project/operations/calibrate_operation.h"

#include <nlohmann/json.hpp>

#include "core/base/atomic_file.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/calibration/calibration_file.h"
#include "core/project/operations/index_list.h"

namespace tiltmap {

namespace {

struct CalibrateSettings {
  CalibrationSettings calibration;
  std::string scans;
  bool apply = false;
  std::string out;
  std::string from;
  int threads = 0;
};

const ParameterTable<CalibrateSettings>& calibrateTable() {
  using S = CalibrateSettings;
  static const ParameterTable<S> table = [] {
    ParameterTable<S> t("calibrate");
    t.text("scans", &S::scans, "Scans to calibrate from, such as 0-13 or 0,2,7; empty for all", "ours");
    t.boolean("apply", &S::apply,
              "Give the scans of this scanner the geometry found; without it only the table is made", "ours");
    t.text("out", &S::out, "File to write the calibration to (JSON), for scripts and for other surveys",
           "ours");
    t.text("from", &S::from, "File with a calibration to give to the scans, in place of estimating one",
           "ours");
    t.integer("threads", &S::threads, "", 0, 256,
              "Threads to use, 0 for all cores; the result does not depend on it", "ours");
    t.include(calibrationParameters(), &S::calibration);
    return t;
  }();
  return table;
}

Result<std::vector<int>> chosen(const ProjectSnapshot& snapshot, const CalibrateSettings& settings) {
  return parseIndexesOrAll(settings.scans, static_cast<int>(snapshot.scans().size()), "--scans");
}

// "tilt zero 0.498 deg": for the history.
std::string estimateText(const ErrorEstimate& e) {
  return scannerErrorName(e.error) + " " +
         (isAngle(e.error) ? fixedReal(e.value / kDegree, 3) + " deg"
                           : fixedReal(1000.0 * e.value, 1) + " mm");
}

// What was found, kept like any computation's record.
JobRecord recordOf(const Calibration& calibration, const std::string& scans) {
  JobRecord record;
  record.operation = "calibration";
  record.preset = "default";
  record.program_version = programVersion();
  record.started = record.finished = utcNow();
  record.state = JobState::Accepted;
  record.values["scans"] = scans;
  for (const ErrorEstimate& e : calibration.estimates) {
    if (e.state != EstimateState::Estimated) continue;
    const std::string unit = isAngle(e.error) ? " deg" : " m";
    const double scale = isAngle(e.error) ? 1.0 / kDegree : 1.0;
    record.values[scannerErrorName(e.error) + unit] = scale * e.value;
    record.values[scannerErrorName(e.error) + " sigma" + unit] = scale * e.deviation;
  }
  record.values["residual before m"] = calibration.residual_before_m;
  record.values["residual after m"] = calibration.residual_after_m;
  return record;
}

// The geometry for every scan that has the same calibration as the one `like`.
void giveGeometry(const ProjectSnapshot& snapshot, const ScannerGeometry& like, const ScannerGeometry& found,
                  std::vector<EditStep>& steps) {
  for (const ScanEntry& scan : snapshot.scans()) {
    if (!sameCalibration(scan.geometry, like)) continue;
    ScannerGeometry geometry = scan.geometry;
    takeCalibration(found, geometry);
    steps.emplace_back(SetGeometry{scan.id, geometry});
  }
}

constexpr const char* kLinksAreOlder =
    "links and pairwise poses are still those of the old geometry: register and relax the survey again";

class CalibrateOperation : public SettingsOperation<CalibrateSettings> {
 public:
  CalibrateOperation() : SettingsOperation(calibrateTable()) {}
  std::string title() const override { return "Calibrate the scanner"; }
  std::string help() const override {
    return "Estimates tilt zero, lever arm, mounting rotation and range offset from overlapping scans that "
           "have "
           "been registered, together with their poses. Tells each value, how well it is known, and which "
           "these "
           "scans do not tell. With `apply` the scans get the new geometry, which can be undone.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const CalibrateSettings& settings) const override {
    const auto scans = chosen(snapshot, settings);
    if (!scans) return fail(scans.error());
    if (!settings.from.empty()) {
      if (!settings.apply)
        return fail("a calibration from a file is only of use when it is applied", "--from", "add --apply");
      if (!settings.out.empty())
        return fail("there is nothing to write when a calibration comes from a file", "--out",
                    "leave --out or --from away");
      return readCalibration(settings.from).map([](const ScannerGeometry&) {});
    }
    if (scans->size() < 3)
      return fail("a calibration needs three overlapping scans or more, and " +
                      std::to_string(scans->size()) + (scans->size() == 1 ? " is" : " are") + " named",
                  snapshot.path().string(), "take more scans, or name more with --scans");
    if (!snapshot.hasStage(Stage::Pairwise) && !snapshot.hasStage(Stage::Relaxed))
      return fail("the scans have not been registered yet", snapshot.path().string(),
                  "run `tiltmap register` first, and `tiltmap relax`");
    return {};
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const CalibrateSettings& settings,
                                      const JobControl& control) const override {
    return settings.from.empty() ? estimated(snapshot, settings, control) : taken(snapshot, settings);
  }

 private:
  static Result<OperationResult> estimated(const SnapshotPtr& snapshot, const CalibrateSettings& settings,
                                           const JobControl& control) {
    const auto list = chosen(*snapshot, settings);
    if (!list) return fail(list.error());
    const std::vector<Pose> poses = snapshot->filledPoses(snapshot->latestStage());
    std::vector<Scan> scans;
    std::vector<Pose> starts;
    std::vector<std::string> names;
    for (const int i : *list) {
      auto scan = snapshot->scans()[static_cast<std::size_t>(i)].scan();
      if (!scan) return fail(scan.error());
      names.push_back(scan->name);
      scans.push_back(std::move(*scan));
      starts.push_back(poses[static_cast<std::size_t>(i)]);
    }
    auto found = calibrate(scans, starts, settings.calibration, settings.threads, control);
    if (!found) return fail(found.error());

    OperationResult outcome;
    outcome.warnings = found->warnings;
    if (!settings.out.empty())
      if (Status status = writeFileAtomically(settings.out, calibrationText(*found, names, utcNow()));
          !status)
        return fail(status.error());
    nlohmann::json report = calibrationJson(*found);
    report["applied"] = settings.apply;
    std::vector<std::string> parts;
    for (const ErrorEstimate& e : found->estimates)
      if (e.state == EstimateState::Estimated) parts.push_back(estimateText(e));
    if (settings.apply && parts.empty()) {
      report["applied"] = false;
      outcome.warnings.emplace_back("nothing was applied, since these scans tell none of the errors");
    } else if (settings.apply) {
      outcome.edit.title = "calibrate: " + joined(parts, ", ");
      outcome.edit.base = snapshot;
      giveGeometry(*snapshot, scans.front().geometry, found->geometry, outcome.edit.steps);
      SetPoses relaxed{Stage::Relaxed, {}};
      for (std::size_t k = 0; k < list->size(); ++k)
        relaxed.poses.emplace_back(snapshot->scans()[static_cast<std::size_t>((*list)[k])].id,
                                   found->poses[k]);
      outcome.edit.steps.emplace_back(std::move(relaxed));
      outcome.edit.jobs.push_back(recordOf(*found, joined(names, ", ")));
      outcome.warnings.emplace_back(kLinksAreOlder);
    }
    outcome.report_json = report.dump();
    return outcome;
  }

  static Result<OperationResult> taken(const SnapshotPtr& snapshot, const CalibrateSettings& settings) {
    const auto geometry = readCalibration(settings.from);
    if (!geometry) return fail(geometry.error());
    const auto list = chosen(*snapshot, settings);
    if (!list) return fail(list.error());
    OperationResult outcome;
    outcome.edit.title = "calibrate " + std::to_string(list->size()) + " scans from a file";
    outcome.edit.base = snapshot;
    for (const int i : *list) {
      const ScanEntry& scan = snapshot->scans()[static_cast<std::size_t>(i)];
      SetGeometry step{scan.id, scan.geometry};
      takeCalibration(*geometry, step.geometry);
      outcome.edit.steps.emplace_back(std::move(step));
    }
    if (snapshot->hasStage(Stage::Pairwise)) outcome.warnings.emplace_back(kLinksAreOlder);
    outcome.report_json = nlohmann::json{{"applied", true}, {"scans", list->size()}}.dump();
    return outcome;
  }
};

}  // namespace

std::unique_ptr<Operation> makeCalibrateOperation() {
  return std::make_unique<CalibrateOperation>();
}

}  // namespace tiltmap
