// tiltmap poses P.tiltmap [--stage S] [--format table|tum|csv|kitti|pose|frames] [--out FILE|FOLDER]
#include "app/cli/operation_runner.h"
#include "core/base/atomic_file.h"
#include "core/io/pose_file.h"
#include "core/products/localisation_table.h"

namespace tiltmap::cli {

namespace {

struct PosesWords {
  std::string project;
  std::string stage;
  std::string format = "table";
  std::string out;

  // One file a scan: 3DTK's way.
  bool many() const { return format == "pose" || format == "frames"; }
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

Result<std::string> posesText(const std::string& format, const std::string& stage,
                              const std::vector<Pose>& poses, const IndexedPoses& indexed) {
  if (format == "tum") return posesTumText(indexed);
  if (format == "csv") return posesCsvText(indexed);
  if (format == "kitti") return posesKittiText(indexed, "tiltmap poses");
  return textOf(localisationTable(stage, poses));
}

int printPoses(Context& context, const PosesWords& words) {
  if (words.many() && words.out.empty())
    return context.console.wrongUsage({"the format " + words.format + " has one file a scan", "tiltmap poses",
                                       "name a folder for them with --out"});
  if (Status status = checkOutput(words.out, words.project); !status)
    return context.console.failed(status.error());
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  auto stage = stageOrLatest(**snapshot, words.stage);
  if (!stage) return context.console.failed(stage.error());
  const std::vector<Pose> poses = (*snapshot)->filledPoses(*stage);
  IndexedPoses indexed;
  for (std::size_t i = 0; i < poses.size(); ++i) indexed.emplace(static_cast<int>(i), poses[i]);
  nlohmann::json json = posesJson(stageName(*stage), poses);
  std::string printed;
  if (words.many()) {
    const auto files = writePoses3dtk(
        words.out, words.format == "pose" ? Poses3dtk::PoseFiles : Poses3dtk::FramesFiles, indexed);
    if (!files) return context.console.failed(files.error());
    json["files"] = *files;
    printed = "wrote " + std::to_string(files->size()) + " files into " + words.out;
  } else {
    auto text = posesText(words.format, stageName(*stage), poses, indexed);
    if (!text) return context.console.failed(text.error());
    printed = std::move(*text);
    if (!words.out.empty()) {
      if (Status status = writeFileAtomically(words.out, printed); !status)
        return context.console.failed(status.error());
      json["files"] = {words.out};
      printed = "wrote " + words.out;
    }
  }
  context.console.printJson(json);
  context.console.print(printed);
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
                   "table (position and heading, as the thesis prints them), tum, csv, kitti, or 3DTK's pose "
                   "and frames")
      ->check(CLI::IsMember({"table", "tum", "csv", "kitti", "pose", "frames"}))
      ->capture_default_str();
  command->add_option("--out", words->out,
                      "Write a file instead of printing; for pose and frames the folder for one file a scan");
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return printPoses(context, *words); };
  });
}

}  // namespace tiltmap::cli
