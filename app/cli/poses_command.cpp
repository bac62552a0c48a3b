// tiltmap poses P.tiltmap [--stage S] [--format table|tum|csv]
#include "app/cli/operation_runner.h"
#include "core/io/pose_file.h"
#include "core/products/localisation_table.h"

namespace tiltmap::cli {

namespace {

struct PosesWords {
  std::string project;
  std::string stage;
  std::string format = "table";
};

nlohmann::json posesJson(const std::string& stage, const std::vector<Pose>& poses) {
  nlohmann::json json = {{"stage", stage}, {"poses", nlohmann::json::array()}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector3d& t = poses[i].translation();
    const Eigen::Quaterniond& q = poses[i].quaternion();
    const Eigen::Vector3d h = poses[i].heading();
    json["poses"].push_back({{"index", i},
                             {"translation_m", {t.x(), t.y(), t.z()}},
                             {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                             {"heading", {h.x(), h.y(), h.z()}}});
  }
  return json;
}

int printPoses(Context& context, const PosesWords& words) {
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  auto stage = stageOrLatest(**snapshot, words.stage);
  if (!stage) return context.console.failed(stage.error());
  const std::vector<Pose> poses = (*snapshot)->filledPoses(*stage);
  context.console.printJson(posesJson(stageName(*stage), poses));
  if (words.format == "table") {
    context.console.print(textOf(localisationTable(stageName(*stage), poses)));
    return kDone;
  }
  IndexedPoses indexed;
  for (std::size_t i = 0; i < poses.size(); ++i) indexed.emplace(static_cast<int>(i), poses[i]);
  context.console.print(words.format == "tum" ? posesTumText(indexed) : posesCsvText(indexed));
  return kDone;
}

}  // namespace

void addPoses(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("poses", "Where the stops are, world_from_scan, scan 0 being the world");
  auto words = std::make_shared<PosesWords>();
  command->add_option("project", words->project, "The project")->required();
  command->add_option("--stage", words->stage,
                      "truth, odometry, pairwise or relaxed; the latest there is unless told");
  command
      ->add_option("--format", words->format,
                   "table (position and heading, as the thesis prints them), tum or csv")
      ->check(CLI::IsMember({"table", "tum", "csv"}))
      ->capture_default_str();
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return printPoses(context, *words); };
  });
}

}  // namespace tiltmap::cli
