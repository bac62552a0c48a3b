#include "core/project/operations/export_operation.h"

#include <nlohmann/json.hpp>

#include "core/io/cloud_writer.h"
#include "core/project/operations/index_list.h"
#include "core/scan/reduction.h"

namespace tiltmap {

namespace {

struct ExportSettings {
  std::string file;
  std::string stage;
  std::string scans;
  bool reduced = false;
  double reduction_distance_m = 0.5;
  CloudColour colour = CloudColour::Scan;
  bool double_precision = false;
};

const ParameterTable<ExportSettings>& exportTable() {
  static const ParameterTable<ExportSettings> table = [] {
    ParameterTable<ExportSettings> t("export");
    t.text("file", &ExportSettings::file,
           "Where to write; the extension says the format: ply, pcd, xyz, csv, ptx, vtk", "ours");
    t.text("stage", &ExportSettings::stage,
           "Whose poses: truth, odometry, pairwise or relaxed; empty: the latest there is", "ours");
    t.text("scans", &ExportSettings::scans, "Scans to write, such as 0-5 or 0,2,7; empty: all", "ours");
    t.boolean("reduced", &ExportSettings::reduced,
              "Thin the points along the lines of each scan instead of writing all", "thesis 4.2.2.3");
    t.real("reduction-distance", &ExportSettings::reduction_distance_m, "m", 0.001, 100.0,
           "With reduced: neighbours in a line nearer than this become one", "thesis 4.2.2.3: 0.5 m");
    t.choice<CloudColour>("colour", &ExportSettings::colour,
                          {{"none", CloudColour::None},
                           {"scan", CloudColour::Scan},
                           {"height", CloudColour::Height},
                           {"intensity", CloudColour::Intensity}},
                          "Colour written with each point, in formats that have one", "ours");
    t.boolean("double-precision", &ExportSettings::double_precision,
              "Coordinates as 8-byte floats in ply, pcd and vtk", "ours: 4 bytes hold 0.1 mm up to 1 km");
    return t;
  }();
  return table;
}

Result<Stage> stageOf(const ProjectSnapshot& snapshot, const std::string& name) {
  if (name.empty()) return snapshot.latestStage();
  auto stage = parseStage(name);
  if (stage && !snapshot.hasStage(*stage))
    return fail("the project has no poses of stage " + name, snapshot.path().string(),
                "run the operation that makes it first, or choose another stage (`tiltmap info` lists them)");
  return stage;
}

class ExportOperation : public SettingsOperation<ExportSettings> {
 public:
  ExportOperation() : SettingsOperation(exportTable()) {}
  std::string title() const override { return "Export map"; }
  std::string help() const override {
    return "Writes the points of all scans, placed by their poses, as one file.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const ExportSettings& settings) const override {
    if (settings.file.empty()) return fail("no file was named", "export", "name the file to write");
    if (snapshot.scans().empty())
      return fail("the project has no scans to export", snapshot.path().string(),
                  "import, simulate or capture some first");
    if (auto format = cloudFormatOf(settings.file); !format) return fail(format.error());
    if (auto stage = stageOf(snapshot, settings.stage); !stage) return fail(stage.error());
    if (auto list = selected(snapshot, settings); !list) return fail(list.error());
    return {};
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const ExportSettings& settings,
                                      const JobControl& control) const override {
    const auto stage = stageOf(*snapshot, settings.stage);
    const auto list = selected(*snapshot, settings);
    if (!stage) return fail(stage.error());
    if (!list) return fail(list.error());
    OperationResult outcome;
    const auto stage_poses = snapshot->poses(*stage);
    const std::vector<Pose> poses = snapshot->filledPoses(*stage);
    for (const int index : *list)
      if (!stage_poses[static_cast<std::size_t>(index)])
        outcome.warnings.push_back("scan " + std::to_string(index) + " has no pose of stage " +
                                   stageName(*stage) +
                                   ": it is placed by its odometry from the nearest scan that has one");

    std::size_t points = 0;
    CloudForExport cloud;
    cloud.scans = list->size();
    cloud.scan = [&](std::size_t k) -> Result<ExportScan> {
      const auto index = static_cast<std::size_t>((*list)[k]);
      return snapshot->scans()[index].scan().map(
          [&](const Scan& scan) { return exported(scan, index, poses[index], settings); });
    };
    for (std::size_t k = 0; k < list->size(); ++k) {
      auto image = snapshot->scans()[static_cast<std::size_t>((*list)[k])].image();
      if (!image) return fail(image.error());
      cloud.intensity |= (*image)->hasIntensity();
      points += (*image)->validCells();
    }
    if (points == 0)
      return fail("the scans hold no point", snapshot->path().string(), "choose scans with points");
    WriteOptions options;
    options.colour = settings.colour;
    options.double_precision = settings.double_precision;
    if (Status status = writeCloud(settings.file, cloud, options, control); !status)
      return fail(status.error());
    outcome.report_json =
        nlohmann::json{{"file", settings.file}, {"stage", stageName(*stage)}, {"scans", list->size()}}.dump();
    return outcome;
  }

 private:
  static Result<std::vector<int>> selected(const ProjectSnapshot& snapshot, const ExportSettings& settings) {
    const int count = static_cast<int>(snapshot.scans().size());
    return parseIndexList(settings.scans.empty() ? "0-" + std::to_string(count - 1) : settings.scans, count,
                          "--scans");
  }
  static ExportScan exported(const Scan& scan, std::size_t index, const Pose& pose,
                             const ExportSettings& settings) {
    ExportScan out;
    out.index = static_cast<int>(index);
    out.world_from_scan = pose;
    out.geometry = scan.geometry;
    if (settings.reduced) {
      out.cloud = reducedAlongLines(*scan.image, cellPoints(*scan.image, scan.geometry), {},
                                    settings.reduction_distance_m);
    } else {
      out.image = scan.image;
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Operation> makeExportOperation() {
  return std::make_unique<ExportOperation>();
}

}  // namespace tiltmap
