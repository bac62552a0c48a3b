// tiltmap demo [--out DIR] [--experiment E] [--seed N]: from nothing to a map, a picture and a report.
#include <filesystem>

#include "app/cli/operation_runner.h"
#include "core/base/atomic_file.h"
#include "core/products/png.h"
#include "core/products/survey_report.h"

namespace tiltmap::cli {

namespace {

namespace fs = std::filesystem;

// Marks a project as the demo's own, which the next demo may replace.
constexpr const char* kDemoSite = "Tiltmap demo";

struct DemoWords {
  std::string folder = "tiltmap-demo";
  std::string experiment = "exp2fixed";
  int seed = 1;
};

struct DemoFiles {
  fs::path project, map, picture, report;
};

// Takes an earlier demo's project away; refuses to touch anything else.
Status makeRoom(const DemoFiles& files) {
  std::error_code error;
  fs::create_directories(files.project.parent_path(), error);
  if (error)
    return fail("the folder cannot be made: " + error.message(), files.project.parent_path().string(),
                "choose another with --out DIR");
  if (!fs::exists(files.project)) return {};
  auto earlier = readProject(files.project.string());
  if (!earlier || (*earlier)->survey().site != kDemoSite)
    return fail("there is a file that an earlier demo did not make", files.project.string(),
                "choose another folder with --out DIR, or move the file away");
  for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(files.project.string() + suffix, error);
  return {};
}

Result<OperationResult> runStep(Context& context, Project& project, const std::string& operation,
                                const ParameterValues& values, const std::string& said) {
  context.console.note(said);
  auto outcome = runOperation(context, project, operation, "default", values);
  if (outcome)
    for (const std::string& warning : outcome->warnings) context.console.warn(warning);
  return outcome;
}

// How far the poses of each stage are from the truth, in one line a stage.
void tellAccuracy(Context& context, const ReportData& report) {
  for (const ReportStage& stage : report.stages) {
    if (!stage.evaluation) continue;
    char line[120];
    std::snprintf(line, sizeof line, "  %-9s RMSE %8.1f mm, %7.3f deg", stage.table.stage.c_str(),
                  1000.0 * stage.evaluation->rmse_translation_m, stage.evaluation->rmse_rotation_deg);
    context.console.note(line);
  }
}

Status makeSurvey(Context& context, Project& project, const DemoWords& words, const DemoFiles& files) {
  SurveyInfo survey = project.snapshot()->survey();
  survey.site = kDemoSite;
  if (auto change = project.apply(surveyEdit(survey)); !change) return fail(change.error());
  // As fast as the machine can, in memory: the same lines every time.
  auto captured = runStep(
      context, project, "capture",
      {{"emulate", words.experiment}, {"seed", static_cast<long long>(words.seed)}, {"speed", 0.0}},
      "Capturing " + words.experiment + " with the emulated scanner on its emulated tilt ...");
  if (!captured) return fail(captured.error());
  auto registered = runStep(context, project, "register", {}, "Registering each scan to the one before ...");
  if (!registered) return fail(registered.error());
  auto relaxed = runStep(context, project, "relax", {}, "Spreading the errors over all scans ...");
  if (!relaxed) return fail(relaxed.error());
  auto written = runStep(context, project, "export", {{"file", files.map.string()}}, "Writing the map ...");
  if (!written) return fail(written.error());
  return {};
}

Result<ReportData> writePictureAndReport(Context& context, const Project& project, const DemoWords& words,
                                         const DemoFiles& files) {
  const SnapshotPtr snapshot = project.snapshot();
  const Stage stage = snapshot->latestStage();
  auto input = topViewOf(
      *snapshot, stage,
      words.experiment + ", " + std::to_string(snapshot->scans().size()) + " stops, " + stageName(stage),
      context.job());
  if (!input) return fail(input.error());
  auto view = drawTopView(*input);
  if (!view) return fail(view.error());
  if (Status status = writePng(files.picture, view->image); !status) return fail(status.error());
  ReportData report = reportOf(*snapshot, "Demo: " + words.experiment);
  report.picture = std::move(view->image);
  report.picture_caption = "The map from above, scans placed by their " + stageName(stage) + " poses";
  report.files = {{files.map.filename().string(), "Map (PLY)"},
                  {files.picture.filename().string(), "Picture (PNG)"},
                  {files.project.filename().string(), "Project"}};
  auto page = reportHtml(report);
  if (!page) return fail(page.error());
  if (Status status = writeFileAtomically(files.report, *page); !status) return fail(status.error());
  return report;
}

int demo(Context& context, const DemoWords& words) {
  const fs::path folder = words.folder;
  const DemoFiles files = {folder / "demo.tiltmap", folder / "map.ply", folder / "map.png",
                           folder / "report.html"};
  if (Status status = makeRoom(files); !status) return context.console.failed(status.error());
  auto project = Project::create(files.project);
  if (!project) return context.console.failed(project.error());
  if (Status status = makeSurvey(context, **project, words, files); !status)
    return context.console.failed(status.error());
  auto report = writePictureAndReport(context, **project, words, files);
  if (!report) return context.console.failed(report.error());
  tellAccuracy(context, *report);
  nlohmann::json json = {{"project", files.project.string()},
                         {"map", files.map.string()},
                         {"picture", files.picture.string()},
                         {"report", files.report.string()},
                         {"warnings", warningsJson(report->warnings)}};
  context.console.printJson(json);
  context.console.print("map: " + files.map.string() + "\npicture: " + files.picture.string() +
                        "\nreport: " + files.report.string());
  return kDone;
}

}  // namespace

void addDemo(CLI::App& app, Chosen& chosen) {
  auto* command =
      app.add_subcommand("demo", "From nothing to a map, a picture and a report, on a simulated site");
  auto words = std::make_shared<DemoWords>();
  command->add_option("--out", words->folder, "Folder for what is made")->capture_default_str();
  command->add_option("--experiment", words->experiment, "exp1, exp2, exp2fixed, loop or survey")
      ->check(CLI::IsMember({"exp1", "exp2", "exp2fixed", "loop", "survey"}))
      ->capture_default_str();
  command->add_option("--seed", words->seed, "Another seed, another site")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->callback(
      [words, &chosen] { chosen.body = [words](Context& context) -> int { return demo(context, *words); }; });
}

}  // namespace tiltmap::cli
