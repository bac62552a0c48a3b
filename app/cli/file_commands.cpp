// tiltmap copy|merge|compact|verify P.tiltmap ...: projects as files.
#include <algorithm>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "core/project/operations/merge_operation.h"
#include "core/project/operations/registration_shards.h"

namespace tiltmap::cli {

namespace {

struct FileWords {
  std::string project;
  std::string other;
  std::vector<std::string> others;  // of merge: a project, or the parts of a registration
  std::vector<double> at;           // x, y in metres, heading in degrees
};

int copy(Context& context, const FileWords& words) {
  auto project = Project::open(words.project, Access::ReadOnly);
  if (!project) return context.console.failed(project.error());
  if (Status status = (*project)->saveCopy(words.other); !status)
    return context.console.failed(status.error());
  context.console.printJson({{"project", words.other}});
  context.console.print("made " + words.other);
  return kDone;
}

int compact(Context& context, const FileWords& words) {
  auto project = Project::open(words.project, Access::ReadWrite);
  if (!project) return context.console.failed(project.error());
  const auto report = (*project)->compact();
  if (!report) return context.console.failed(report.error());
  context.console.printJson({{"bytes_before", report->bytes_before},
                             {"bytes_after", report->bytes_after},
                             {"matrices_dropped", report->matrices_dropped}});
  context.console.print("from " + groupedInteger(static_cast<long long>(report->bytes_before)) + " to " +
                        groupedInteger(static_cast<long long>(report->bytes_after)) + " bytes; " +
                        std::to_string(report->matrices_dropped) +
                        " matrices of deleted stops dropped; what was done before can no longer be undone");
  return kDone;
}

int verify(Context& context, const FileWords& words) {
  auto project = Project::open(words.project, Access::ReadOnly);
  if (!project) return context.console.failed(project.error());
  if (Status status = (*project)->verify(); !status) return context.console.failed(status.error());
  context.console.printJson({{"whole", true}, {"scans", (*project)->snapshot()->scans().size()}});
  context.console.print("whole: every page and every matrix was read");
  return kDone;
}

int mergeParts(Context& context, const FileWords& words) {
  if (!words.at.empty())
    return context.console.wrongUsage({"the parts of a registration have no place of their own", "--at",
                                       "leave --at out; it is for merging a project"});
  std::vector<std::string> warnings;
  return editCommand(
      context, words.project,
      [&](const SnapshotPtr& into) {
        return mergeRegistrationParts(into, {words.others.begin(), words.others.end()})
            .map([&](OperationResult result) {
              warnings = std::move(result.warnings);
              return std::move(result.edit);
            });
      },
      &warnings);
}

int merge(Context& context, const FileWords& words) {
  if (std::ranges::any_of(words.others, isRegistrationPart)) return mergeParts(context, words);
  if (words.others.size() > 1)
    return context.console.failed(
        {"only one project is merged at a time, and none of these is a part of a "
         "registration",
         words.others.front(),
         "merge the projects one after the other, or name the parts that `tiltmap "
         "register --shard` wrote"});
  std::optional<Pose> placement;
  if (words.at.size() == 3) placement = Pose::planar(words.at[0], words.at[1], words.at[2] * kDegree);
  std::vector<std::string> warnings;
  return editCommand(
      context, words.project,
      [&](const SnapshotPtr& into) {
        return mergeProjects(into, words.others.front(), placement).map([&](OperationResult result) {
          warnings = std::move(result.warnings);
          return std::move(result.edit);
        });
      },
      &warnings);
}

}  // namespace

void addFiles(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<FileWords>();
  const auto add = [&](const char* name, const char* help, int (*body)(Context&, const FileWords&)) {
    auto* command = app.add_subcommand(name, help);
    command->add_option("project", words->project, "The project")->required();
    command->callback([words, body, &chosen] {
      chosen.body = [words, body](Context& context) -> int { return body(context, *words); };
    });
    return command;
  };
  add("copy", "Save as: the whole project, history included, as a new file", copy)
      ->add_option("new", words->other, "The file to make; nothing must be there yet")
      ->required();
  auto* merging = add("merge",
                      "Append everything of another project, which stays as it is; or put the parts of a "
                      "registration (register --shard) together",
                      merge);
  merging->add_option("other", words->others, "The project to take from, or all the parts")->required();
  merging
      ->add_option(
          "--at", words->at,
          "Where the other's world stands in this one's: x and y in metres, heading in degrees to the left; "
          "where both came with poses of one frame, it is known")
      ->expected(3)
      ->type_name("X Y HEADING");
  add("compact", "Give back the space of deleted stops; undo ends here", compact);
  add("verify", "Read every page and every matrix and tell whether all is whole", verify);
}

}  // namespace tiltmap::cli
