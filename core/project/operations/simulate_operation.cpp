#include "core/project/operations/simulate_operation.h"

#include <nlohmann/json.hpp>

#include "core/calibration/scanner_errors.h"
#include "core/world/experiment.h"

namespace tiltmap {

namespace {

struct SimulateSettings {
  ExperimentId experiment = ExperimentId::Exp2Fixed;
  int seed = 1;
  int stops = 0;
  std::string plant;
  int threads = 0;
};

const ParameterTable<SimulateSettings>& simulateTable() {
  static const ParameterTable<SimulateSettings> table = [] {
    ParameterTable<SimulateSettings> t("simulate");
    std::vector<std::pair<std::string, ExperimentId>> names;
    for (const ExperimentId id : {ExperimentId::Exp1, ExperimentId::Exp2, ExperimentId::Exp2Fixed,
                                  ExperimentId::Loop, ExperimentId::Survey})
      names.emplace_back(std::string(nameOf(id)), id);
    t.choice("experiment", &SimulateSettings::experiment, names,
             "exp1 and exp2: the thesis' stops with its odometry; exp2fixed: exp2 with its two wrong "
             "odometry rows mended; "
             "loop: 40 stops, closed; survey: a long drive",
             "thesis tables 5.1, 5.2, 6.1, 6.3");
    t.integer("seed", &SimulateSettings::seed, "", 0, 2147483647,
              "Another seed, another site of the same kind", "ours");
    t.integer("stops", &SimulateSettings::stops, "", 0, 5000, "Number of stops, 0 for the experiment's own",
              "ours");
    t.text("plant", &SimulateSettings::plant,
           "Errors of the scanner that its scans know nothing of, for trying out the calibration, such as "
           "tilt-zero=0.5,lever-arm-y=0.05,range-offset=0.03; degrees and metres",
           "ours");
    t.integer("threads", &SimulateSettings::threads, "", 0, 256,
              "Threads to use, 0 for all cores; the result does not depend on it", "ours");
    return t;
  }();
  return table;
}

class SimulateOperation : public SettingsOperation<SimulateSettings> {
 public:
  SimulateOperation() : SettingsOperation(simulateTable()) {}
  std::string title() const override { return "Simulate a survey"; }
  std::string help() const override {
    return "Drives a simulated LMS-291 through a simulated site and stores its range matrices, its odometry, "
           "and the "
           "true poses as stage `truth`.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const SimulateSettings& settings) const override {
    if (!snapshot.scans().empty())
      return fail("the project already has scans, of another world than the simulated one",
                  snapshot.path().string(), "simulate into a new project (`tiltmap new`)");
    if (auto poses =
            experimentPoses(settings.experiment, static_cast<std::uint64_t>(settings.seed), settings.stops);
        !poses)
      return fail(poses.error());
    if (auto errors = parseScannerErrors(settings.plant, "--plant"); !errors) return fail(errors.error());
    return {};
  }

  Result<OperationResult> runSettings(const SnapshotPtr&, const SimulateSettings& settings,
                                      const JobControl& control) const override {
    const auto planted = parseScannerErrors(settings.plant, "--plant");
    if (!planted) return fail(planted.error());
    SimulationSettings how;
    if (!planted->isZero()) how.true_geometry = corrected(how.geometry, *planted);
    auto stops = simulateExperiment(settings.experiment, static_cast<std::uint64_t>(settings.seed),
                                    settings.stops, settings.threads, control, how);
    if (!stops) return fail(stops.error());
    OperationResult outcome;
    const std::string experiment(nameOf(settings.experiment));
    outcome.edit.title = "simulate " + std::to_string(stops->size()) + " stops of " + experiment;
    for (SimulatedStop& stop : *stops) {
      AddScan add;
      add.scan = std::move(stop.scan);
      add.poses.emplace(Stage::Truth, stop.truth);
      outcome.edit.steps.emplace_back(std::move(add));
    }
    outcome.report_json =
        nlohmann::json{{"added", stops->size()}, {"experiment", experiment}, {"seed", settings.seed}}.dump();
    return outcome;
  }
};

}  // namespace

std::unique_ptr<Operation> makeSimulateOperation() {
  return std::make_unique<SimulateOperation>();
}

}  // namespace tiltmap
