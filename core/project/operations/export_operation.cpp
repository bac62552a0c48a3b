#include "core/project/operations/export_operation.h"

#include <cstdlib>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/io/cloud_writer.h"
#include "core/products/scan_colours.h"
#include "core/project/operations/index_list.h"
#include "core/project/stage_choice.h"
#include "core/scan/reduction.h"

namespace tiltmap {

namespace {

struct ExportSettings {
  std::string file;
  std::string stage;
  std::string scans;
  bool per_scan = false;
  bool reduced = false;
  double reduction_distance_m = 0.5;
  CloudColour colour = CloudColour::Scan;
  bool double_precision = false;
};

const ParameterTable<ExportSettings>& exportTable() {
  static const ParameterTable<ExportSettings> table = [] {
    ParameterTable<ExportSettings> t("export");
    t.text(
        "file", &ExportSettings::file,
        "Where to write; the extension says the format: ply, pcd, ptx, 3d (3DTK), vtk, xyz, txt, asc or csv",
        "ours");
    t.text("stage", &ExportSettings::stage,
           "Whose poses: truth, odometry, pairwise or relaxed; empty: the latest there is", "ours");
    t.text("scans", &ExportSettings::scans, "Scans to write, such as 0-5 or 0,2,7; empty: all", "ours");
    t.boolean("per-scan", &ExportSettings::per_scan,
              "One file a scan instead of one for all: map000.ply, map001.ply, ... (.3d always: .pose "
              "beside). Whole "
              "scans keep their matrix and pose in ply, pcd, ptx and 3d",
              "ours");
    t.boolean("reduced", &ExportSettings::reduced,
              "Thin the points along the lines of each scan instead of writing all", "thesis 4.2.2.3");
    t.real("reduction-distance", &ExportSettings::reduction_distance_m, "m", 0.001, 100.0,
           "With reduced: neighbours in a line nearer than this become one", "thesis 4.2.2.3: 0.5 m");
    t.choice<CloudColour>(
        "colour", &ExportSettings::colour,
        {{"none", CloudColour::None},
         {"scan", CloudColour::Scan},
         {"height", CloudColour::Height},
         {"intensity", CloudColour::Intensity}},
        "Colour written with each point, in all formats but 3d; by scan as every view and picture has it",
        "ours");
    t.boolean(
        "double-precision", &ExportSettings::double_precision,
        "Coordinates as 8-byte floats in ply, pcd and vtk; PCL and Open3D read such ply, but not such pcd",
        "ours: 4 bytes hold 0.1 mm up to 1 km");
    return t;
  }();
  return table;
}

namespace fs = std::filesystem;

// A folder beside the files to be, gone with all it holds unless they have been moved out.
class Staging {
 public:
  static Result<Staging> beside(const fs::path& file) {
    const fs::path parent = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::string name = (parent / ".tiltmap-export-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      return fail("nothing can be written into the folder", parent.string(),
                  "choose a folder that exists and that you may write into");
    return Staging(name);
  }
  ~Staging() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  Staging(Staging&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}
  Staging& operator=(Staging&&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  explicit Staging(fs::path folder) : folder_(std::move(folder)) {}
  fs::path folder_;
};

// map.ply and 7: map007.ply, as 3DTK numbers its scans.
fs::path fileOfScan(const fs::path& file, int index) {
  std::string number = std::to_string(index);
  if (number.size() < 3) number.insert(0, 3 - number.size(), '0');
  return file.parent_path() / (file.stem().string() + number + file.extension().string());
}

// One file a scan, none of them under its name before all are complete.
Result<std::vector<std::string>> writeEach(const fs::path& file, const std::vector<int>& list,
                                           const CloudForExport& all, WriteOptions options,
                                           const JobControl& control) {
  for (const int index : list)
    if (fs::is_directory(fileOfScan(file, index)))
      return fail("there is a folder of that name", fileOfScan(file, index).string(), "choose another name");
  const auto staging = Staging::beside(file);
  if (!staging) return fail(staging.error());
  // One scale for all, so that the files go together.
  const auto scale = colourScale(all, options.colour, control);
  if (!scale) return fail(scale.error());
  options.scale = *scale;
  for (std::size_t k = 0; k < list.size(); ++k) {
    control.tell(static_cast<double>(k) / static_cast<double>(list.size()),
                 "writing scan " + std::to_string(list[k]));
    CloudForExport one = all;
    one.scans = 1;
    one.scan = [&all, k](std::size_t) { return all.scan(k); };
    const JobControl quiet{{}, control.stop};
    if (Status status =
            writeCloud(staging->folder() / fileOfScan(file, list[k]).filename(), one, options, quiet);
        !status)
      return fail(status.error().what, fileOfScan(file, list[k]).string(), status.error().remedy);
  }
  std::vector<std::string> written;
  for (const fs::directory_entry& entry : fs::directory_iterator(staging->folder())) {
    const fs::path target = file.parent_path() / entry.path().filename();
    std::error_code error;
    fs::rename(entry.path(), target, error);
    if (error)
      return fail("a complete file cannot be given its name: " + error.message(), target.string(),
                  "look what is in its place, and export again");
    written.push_back(target.string());
  }
  std::ranges::sort(written);
  return written;
}

class ExportOperation : public SettingsOperation<ExportSettings> {
 public:
  ExportOperation() : SettingsOperation(exportTable()) {}
  std::string title() const override { return "Export map"; }
  std::string help() const override {
    return "Writes the points of the scans, placed by their poses, as one file or as one a scan.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const ExportSettings& settings) const override {
    if (settings.file.empty()) return fail("no file was named", "export", "name the file to write");
    if (snapshot.scans().empty())
      return fail("the project has no scans to export", snapshot.path().string(),
                  "import, simulate or capture some first");
    if (auto format = cloudFormatOf(settings.file); !format) return fail(format.error());
    if (auto stage = stageOrLatest(snapshot, settings.stage); !stage) return fail(stage.error());
    if (auto list = selected(snapshot, settings); !list) return fail(list.error());
    return {};
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const ExportSettings& settings,
                                      const JobControl& control) const override {
    const auto stage = stageOrLatest(*snapshot, settings.stage);
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

    const auto cloud = cloudOfScans(snapshot, *list, poses, settings);
    if (!cloud) return fail(cloud.error());
    WriteOptions options;
    options.colour = settings.colour;
    options.double_precision = settings.double_precision;
    std::vector<std::string> files = {settings.file};
    if (settings.per_scan) {
      auto written = writeEach(settings.file, *list, *cloud, options, control);
      if (!written) return fail(written.error());
      files = std::move(*written);
    } else if (Status status = writeCloud(settings.file, *cloud, options, control); !status) {
      return fail(status.error());
    }
    outcome.report_json = nlohmann::json{
        {"file", files.front()},
        {"files", files},
        {"stage", stageName(*stage)},
        {"scans",
         list->size()}}.dump();
    return outcome;
  }

 private:
  static Result<std::vector<int>> selected(const ProjectSnapshot& snapshot, const ExportSettings& settings) {
    const int count = static_cast<int>(snapshot.scans().size());
    return parseIndexList(settings.scans.empty() ? "0-" + std::to_string(count - 1) : settings.scans, count,
                          "--scans");
  }
  // The scans, one at a time from the file. Refuses a list without any point.
  static Result<CloudForExport> cloudOfScans(const SnapshotPtr& snapshot, const std::vector<int>& list,
                                             const std::vector<Pose>& poses, const ExportSettings& settings) {
    CloudForExport cloud;
    cloud.scans = list.size();
    cloud.scan = [snapshot, list, poses, settings](std::size_t k) -> Result<ExportScan> {
      const auto index = static_cast<std::size_t>(list[k]);
      return snapshot->scans()[index].scan().map([&](const Scan& scan) {
        ExportScan out = exported(scan, index, poses[index], settings);
        const Rgb colour = scanColour(snapshot->scans()[index], index);
        out.colour = {colour.r, colour.g, colour.b};
        return out;
      });
    };
    std::size_t points = 0;
    for (const int index : list) {
      const auto image = snapshot->scans()[static_cast<std::size_t>(index)].image();
      if (!image) return fail(image.error());
      cloud.intensity |= (*image)->hasIntensity();
      points += (*image)->validCells();
    }
    if (points == 0)
      return fail("the scans hold no point", snapshot->path().string(), "choose scans with points");
    return cloud;
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
