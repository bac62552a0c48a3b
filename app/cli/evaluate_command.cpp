// tiltmap evaluate P.tiltmap [--truth TRUTH.tum] [--stage S]
#include <cstdio>

#include "app/cli/operation_runner.h"
#include "core/io/pose_file.h"
#include "core/products/evaluation.h"

namespace tiltmap::cli {

namespace {

struct EvaluateWords {
  std::string project;
  std::string truth;
  std::string stage;
};

Result<std::vector<Pose>> truthPoses(const ProjectSnapshot& snapshot, const std::string& file) {
  if (file.empty()) {
    std::vector<Pose> list;
    for (const auto& pose : snapshot.poses(Stage::Truth)) {
      if (!pose)
        return fail("the project does not know the truth of every stop", snapshot.path().string(),
                    "name a file of true poses with --truth TRUTH.tum");
      list.push_back(*pose);
    }
    return list;
  }
  auto poses = readPosesTum(file);
  if (!poses) return fail(poses.error());
  std::vector<Pose> list;
  for (std::size_t i = 0; i < snapshot.scans().size(); ++i) {
    const auto pose = poses->find(static_cast<int>(i));
    if (pose == poses->end())
      return fail("there is no pose for scan " + std::to_string(i), file,
                  "give one line for each scan of the project");
    list.push_back(pose->second);
  }
  return list;
}

std::string evaluationText(const std::string& stage, const TrajectoryEvaluation& evaluation) {
  std::string text = "stop  translation mm  rotation deg   (stage " + stage + " against the truth)\n";
  char line[96];
  for (const StopError& stop : evaluation.stops) {
    std::snprintf(line, sizeof line, "%4zu  %14.1f  %12.4f\n", stop.index, 1000.0 * stop.translation_error_m,
                  stop.rotation_error_deg);
    text += line;
  }
  std::snprintf(line, sizeof line, "RMSE  %14.1f  %12.4f", 1000.0 * evaluation.rmse_translation_m,
                evaluation.rmse_rotation_deg);
  return text + line;
}

int evaluate(Context& context, const EvaluateWords& words) {
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  auto stage = stageOrLatest(**snapshot, words.stage);
  if (!stage) return context.console.failed(stage.error());
  auto truth = truthPoses(**snapshot, words.truth);
  if (!truth) return context.console.failed(truth.error());
  auto evaluation = evaluateTrajectory((*snapshot)->filledPoses(*stage), *truth);
  if (!evaluation) return context.console.failed(evaluation.error());
  nlohmann::json json = {{"stage", stageName(*stage)},
                         {"rmse_translation_m", evaluation->rmse_translation_m},
                         {"rmse_rotation_deg", evaluation->rmse_rotation_deg},
                         {"stops", nlohmann::json::array()}};
  for (const StopError& stop : evaluation->stops)
    json["stops"].push_back({{"index", stop.index},
                             {"translation_error_m", stop.translation_error_m},
                             {"rotation_error_deg", stop.rotation_error_deg}});
  context.console.printJson(json);
  context.console.print(evaluationText(stageName(*stage), *evaluation));
  return kDone;
}

}  // namespace

void addEvaluate(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("evaluate", "How far the stops are from the truth");
  auto words = std::make_shared<EvaluateWords>();
  command->add_option("project", words->project, "The project")->required();
  command->add_option("--truth", words->truth,
                      "TUM file with the true poses; else the project's stage truth");
  command->add_option("--stage", words->stage,
                      "odometry, pairwise or relaxed; the latest there is unless told");
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return evaluate(context, *words); };
  });
}

}  // namespace tiltmap::cli
