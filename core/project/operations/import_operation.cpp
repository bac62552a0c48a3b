#include "core/project/operations/import_operation.h"

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/io/pose_file.h"
#include "core/io/scan_reader.h"

namespace tiltmap {

namespace {

struct ImportSettings {
  std::string files;
  ScanFormat format = ScanFormat::Auto;
  std::string odometry;
  double minimum_range_m = 0.0;
  double maximum_range_m = 0.0;
};

const ParameterTable<ImportSettings>& importTable() {
  static const ParameterTable<ImportSettings> table = [] {
    ParameterTable<ImportSettings> t("import");
    t.text("files", &ImportSettings::files, "The scan files, one a line, in the order they were taken",
           "ours");
    t.choice("format", &ImportSettings::format, scanFormatNames(),
             "Format of the files; auto goes by extension and then by what the file begins with", "ours");
    t.text("odometry", &ImportSettings::odometry,
           "TUM file (index x y z qx qy qz qw) with world_from_scan of each file; empty: what the files tell",
           "ours");
    t.real("min-range", &ImportSettings::minimum_range_m, "m", 0.0, 1000.0,
           "Nearer cells hold no point: the machine's own body", "ours: 0, nothing is left out");
    t.real("max-range", &ImportSettings::maximum_range_m, "m", 0.0, 10000.0,
           "Further cells hold no point: devices that write a far point for no return; 0: no bound",
           "ours: far points of an unknown scanner are kept");
    return t;
  }();
  return table;
}

std::vector<std::string> fileList(const std::string& text) {
  std::vector<std::string> files;
  for (const std::string_view line : splitAt(text, '\n'))
    if (!line.empty()) files.emplace_back(line);
  return files;
}

// Poses of the new scans from a TUM file. Its indices are those that the scans get in the project; a file
// that counts from 0 in the order of import serves as well.
Result<std::vector<Pose>> odometryFromFile(const std::string& path, std::size_t first, std::size_t count) {
  auto poses = readPosesTum(path);
  if (!poses) return fail(poses.error());
  for (const std::size_t offset : {first, std::size_t{0}}) {
    std::vector<Pose> list;
    while (list.size() < count) {
      const auto pose = poses->find(static_cast<int>(offset + list.size()));
      if (pose == poses->end()) break;
      list.push_back(pose->second);
    }
    if (list.size() == count) return list;
  }
  return fail("it does not have a pose for each of the " + std::to_string(count) + " scans", path,
              "give one line a scan, counted from 0 in the order of import, or by the index in the project "
              "(here from " +
                  std::to_string(first) + ")");
}

class ImportOperation : public SettingsOperation<ImportSettings> {
 public:
  ImportOperation() : SettingsOperation(importTable()) {}
  std::string title() const override { return "Import scans"; }
  std::string help() const override {
    return "Adds scans from files, keeping the range matrix where a file has one. One bad file and nothing "
           "is added.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot&, const ImportSettings& settings) const override {
    if (fileList(settings.files).empty())
      return fail("no file was named", "import", "name at least one scan file");
    if (settings.maximum_range_m > 0.0 && settings.maximum_range_m <= settings.minimum_range_m)
      return fail("the range bounds leave nothing", "--min-range and --max-range",
                  "make --max-range the larger one");
    return {};
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const ImportSettings& settings,
                                      const JobControl& control) const override {
    OperationResult outcome;
    std::vector<ImportedScan> imported;
    const auto files = fileList(settings.files);
    for (std::size_t i = 0; i < files.size(); ++i) {
      control.tell(static_cast<double>(i) / static_cast<double>(files.size()), "reading " + files[i]);
      auto read =
          readScans(files[i], {settings.format, settings.minimum_range_m, settings.maximum_range_m}, control);
      if (!read) return fail(read.error());
      for (ImportedScan& scan : read->scans) imported.push_back(std::move(scan));
      for (std::string& warning : read->warnings) outcome.warnings.push_back(std::move(warning));
    }
    if (Status status = placeAll(*snapshot, settings, imported, outcome.warnings); !status)
      return fail(status.error());

    std::vector<Scan> scans;
    for (ImportedScan& scan : imported) scans.push_back(std::move(scan.scan));
    outcome.report_json = nlohmann::json{{"added", scans.size()}}.dump();
    outcome.edit = importEdit(std::move(scans));
    if (snapshot->scans().empty()) {
      SurveyInfo survey = snapshot->survey();
      survey.site_from_world = imported.front().pose;
      outcome.edit.steps.push_back(SetSurvey{std::move(survey)});
    }
    return outcome;
  }

 private:
  // Gives every scan its odometry in the project's world.
  static Status placeAll(const ProjectSnapshot& snapshot, const ImportSettings& settings,
                         std::vector<ImportedScan>& imported, std::vector<std::string>& warnings) {
    if (!settings.odometry.empty()) {
      auto poses = odometryFromFile(settings.odometry, snapshot.scans().size(), imported.size());
      if (!poses) return fail(poses.error());
      for (std::size_t i = 0; i < imported.size(); ++i) imported[i].pose = (*poses)[i];
    }
    const bool empty = snapshot.scans().empty();
    const Pose site_from_world =
        (empty ? imported.front().pose : snapshot.survey().site_from_world).value_or(Pose());
    Pose last = empty ? Pose() : snapshot.scans().back().odometry();
    for (std::size_t i = 0; i < imported.size(); ++i) {
      const bool world = empty && i == 0;
      if (world) {
        last = Pose();
      } else if (imported[i].pose) {
        last = site_from_world.inverse() * *imported[i].pose;
      } else {
        warnings.push_back(imported[i].scan.source +
                           " tells no pose: its odometry is that of the scan before it");
      }
      imported[i].scan.odometry = last;
    }
    return {};
  }
};

}  // namespace

std::unique_ptr<Operation> makeImportOperation() {
  return std::make_unique<ImportOperation>();
}

}  // namespace tiltmap
