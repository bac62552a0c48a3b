// tiltmap copy|merge|compact|verify P.tiltmap ...: projects as files.
#include <filesystem>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"

namespace tiltmap::cli {

namespace {

struct FileWords {
  std::string project;
  std::string other;
  std::vector<double> at;  // x, y in metres, heading in degrees
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

int merge(Context& context, const FileWords& words) {
  std::error_code error;
  if (std::filesystem::equivalent(words.project, words.other, error))
    return context.console.failed(
        {"a project cannot be merged with itself", words.other, "name another one"});
  const auto other = readProject(words.other);
  if (!other) return context.console.failed(other.error());
  std::vector<std::string> warnings;
  return editCommand(
      context, words.project,
      [&](const SnapshotPtr& into) -> Result<ProjectEdit> {
        std::optional<Pose> placement = mergePlacement(*into, **other);
        if (words.at.size() == 3) placement = Pose::planar(words.at[0], words.at[1], words.at[2] * kDegree);
        if (!placement)
          warnings.push_back(
              "the projects do not tell how they stand to each other: the other's stop 0 is put where this "
              "one's is "
              "(tell it with --at X Y HEADING, or register pairs between the two)");
        if (into->projectId() == (*other)->projectId())
          warnings.push_back("one project is a copy of the other: stops that both have are there twice now");
        return mergeEdit(*into, **other, placement.value_or(Pose()));
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
  auto* merging = add("merge", "Append everything of another project, which stays as it is", merge);
  merging->add_option("other", words->other, "The project to take from")->required();
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
