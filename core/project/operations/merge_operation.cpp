#include "core/project/operations/merge_operation.h"

#include <cmath>
#include <vector>

#include "core/base/text.h"
#include "core/project/project.h"

namespace tiltmap {

namespace {

struct MergeSettings {
  std::string file;
  std::string at;
};

const ParameterTable<MergeSettings>& mergeTable() {
  static const ParameterTable<MergeSettings> table = [] {
    ParameterTable<MergeSettings> t("merge");
    t.text("file", &MergeSettings::file, "The project to take from; it stays as it is", "ours");
    t.text("at", &MergeSettings::at,
           "Where the other's world stands in this one's: x and y in metres, heading in degrees to the left, "
           "such as "
           "12.5 3 90; empty: as known from the frame that both came in",
           "ours");
    return t;
  }();
  return table;
}

// Nothing for an empty text.
Result<std::optional<Pose>> placementOf(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string_view word : splitWords(text)) {
    const auto number = parseReal(word);
    if (!number || !std::isfinite(*number)) {
      numbers.clear();
      break;
    }
    numbers.push_back(*number);
  }
  if (trimmed(text).empty()) return std::optional<Pose>();
  if (numbers.size() != 3)
    return fail(printable(text) + " is not x, y and heading", "--at",
                "write three numbers: 12.5 3 90");
  return std::optional(Pose::planar(numbers[0], numbers[1], numbers[2] * kDegree));
}

class MergeOperation : public SettingsOperation<MergeSettings> {
 public:
  MergeOperation() : SettingsOperation(mergeTable()) {}
  std::string title() const override { return "Merge a project"; }
  std::string help() const override {
    return "Appends the scans of another project with their poses, links and photographs. One edit, which "
           "can be "
           "undone; the other project stays as it is.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot&, const MergeSettings& settings) const override {
    if (settings.file.empty()) return fail("no project is named", "--file", "choose the one to take from");
    std::error_code error;
    if (!std::filesystem::is_regular_file(settings.file, error))
      return fail("there is no such file", settings.file, "choose a project that is there");
    return placementOf(settings.at).map([](const std::optional<Pose>&) {});
  }
  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const MergeSettings& settings,
                                      const JobControl&) const override {
    return placementOf(settings.at).and_then([&](const std::optional<Pose>& placement) {
      return mergeProjects(snapshot, settings.file, placement);
    });
  }
};

struct NoSettings {};

const ParameterTable<NoSettings>& verifyTable() {
  static const ParameterTable<NoSettings> table("verify");
  return table;
}

class VerifyOperation : public SettingsOperation<NoSettings> {
 public:
  VerifyOperation() : SettingsOperation(verifyTable()) {}
  std::string title() const override { return "Check the file"; }
  std::string help() const override { return "Reads every page and every matrix of the project file."; }

 protected:
  Status checkSettings(const ProjectSnapshot&, const NoSettings&) const override { return {}; }
  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const NoSettings&,
                                      const JobControl& control) const override {
    control.tell(-1.0, "reading every page");
    const auto project = Project::open(snapshot->path(), Access::ReadOnly);
    if (!project) return fail(project.error());
    return (*project)->verify().map([] { return OperationResult(); });
  }
};

}  // namespace

Result<OperationResult> mergeProjects(const SnapshotPtr& into, const std::filesystem::path& other_path,
                                      const std::optional<Pose>& world_from_other_world) {
  std::error_code ignored;
  if (std::filesystem::equivalent(into->path(), other_path, ignored))
    return fail("a project cannot be merged with itself", other_path.string(), "name another one");
  const auto project = Project::open(other_path, Access::ReadOnly);
  if (!project) return fail(project.error());
  const SnapshotPtr other = (*project)->snapshot();
  OperationResult result;
  std::optional<Pose> placement = world_from_other_world;
  if (!placement) placement = mergePlacement(*into, *other);
  if (!placement)
    result.warnings.push_back(
        "the projects do not tell how they stand to each other: the other's stop 0 is put where this one's "
        "is (tell it "
        "with --at X Y HEADING, or register pairs between the two)");
  if (into->projectId() == other->projectId())
    result.warnings.push_back("one project is a copy of the other: stops that both have are there twice now");
  result.edit = mergeEdit(*into, *other, placement.value_or(Pose()));
  return result;
}

std::unique_ptr<Operation> makeMergeOperation() {
  return std::make_unique<MergeOperation>();
}

const Operation& verifyOperation() {
  static const VerifyOperation operation;
  return operation;
}

}  // namespace tiltmap
