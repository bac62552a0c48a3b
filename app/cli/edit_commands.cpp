// tiltmap rename|note|survey|delete|rebase P.tiltmap ...: what people change about a survey. Each can be
// undone.
#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "core/products/colour.h"
#include "core/project/operations/index_list.h"

namespace tiltmap::cli {

namespace {

struct StopWords {
  std::string project;
  long long scan = 0;
  std::string text;
};

CLI::App* addStopCommand(CLI::App& app, const char* name, const char* help, StopWords& words) {
  auto* command = app.add_subcommand(name, help);
  command->add_option("project", words.project, "The project")->required();
  command->add_option("scan", words.scan, "Number of the stop, from 0, as `tiltmap info` shows it")
      ->required();
  return command;
}

void addRename(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<StopWords>();
  auto* command = addStopCommand(app, "rename", "Give a stop another name", *words);
  command->add_option("name", words->text, "The new name")->required();
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) -> Result<ProjectEdit> {
        if (trimmed(words->text).empty())
          return fail("the new name is empty", "tiltmap rename", "give a name");
        return snapshot->scanAt(words->scan).map([&](const ScanEntry* scan) {
          return renameEdit(scan->id, words->text);
        });
      });
    };
  });
}

int printNote(Context& context, const StopWords& words) {
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto scan = (*snapshot)->scanAt(words.scan);
  if (!scan) return context.console.failed(scan.error());
  context.console.printJson({{"scan", words.scan}, {"note", (*scan)->note}});
  if (!(*scan)->note.empty()) context.console.print((*scan)->note);
  return kDone;
}

void addNote(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<StopWords>();
  auto* command = addStopCommand(app, "note", "Write a note to a stop, or read it", *words);
  auto* text =
      command->add_option("text", words->text, "The note, in place of an earlier one; \"\" takes it away");
  command->callback([words, text, &chosen] {
    chosen.body = [words, text](Context& context) -> int {
      if (text->count() == 0) return printNote(context, *words);
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) {
        return snapshot->scanAt(words->scan).map([&](const ScanEntry* scan) {
          return noteEdit(scan->id, words->text);
        });
      });
    };
  });
}

void addColour(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<StopWords>();
  auto* command = addStopCommand(
      app, "colour", "Give a stop a colour of its own in every view and picture, or take it away", *words);
  command->add_option("colour", words->text, "Red, green and blue: #ff8800; or default")->required();
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) -> Result<ProjectEdit> {
        std::optional<std::uint32_t> colour;
        if (words->text != "default") {
          const auto rgb = rgbOfHex(words->text);
          if (!rgb)
            return fail(printable(words->text) + " is not a colour", "tiltmap colour",
                        "write six hexadecimal digits, such as #ff8800, or default");
          colour =
              static_cast<std::uint32_t>(rgb->r) << 16 | static_cast<std::uint32_t>(rgb->g) << 8 | rgb->b;
        }
        return snapshot->scanAt(words->scan).map([&](const ScanEntry* scan) {
          return colourEdit(*snapshot, {scan->id}, colour);
        });
      });
    };
  });
}

struct SurveyWords {
  std::string project;
  SurveyInfo survey;
  std::vector<std::pair<CLI::Option*, std::string SurveyInfo::*>> given;

  bool any() const {
    return std::ranges::any_of(given, [](const auto& entry) { return entry.first->count() > 0; });
  }
};

int printSurvey(Context& context, const std::string& project) {
  auto snapshot = readProject(project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const SurveyInfo& survey = (*snapshot)->survey();
  context.console.printJson({{"site", survey.site},
                             {"operator", survey.operator_name},
                             {"device", survey.device},
                             {"date", survey.date}});
  context.console.print("site:     " + survey.site + "\noperator: " + survey.operator_name +
                        "\ndevice:   " + survey.device + "\ndate:     " + survey.date);
  return kDone;
}

void addSurvey(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("survey", "Write down site, operator, device and date, or read them");
  auto words = std::make_shared<SurveyWords>();
  command->add_option("project", words->project, "The project")->required();
  const auto entry = [&](const char* flag, std::string SurveyInfo::*member, const char* help) {
    words->given.emplace_back(command->add_option(flag, words->survey.*member, help), member);
  };
  entry("--site", &SurveyInfo::site, "Where it was taken");
  entry("--operator", &SurveyInfo::operator_name, "By whom");
  entry("--device", &SurveyInfo::device, "With which scanner");
  entry("--date", &SurveyInfo::date, "When; 2031-04-05 is understood everywhere");
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      if (!words->any()) return printSurvey(context, words->project);
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) -> Result<ProjectEdit> {
        SurveyInfo survey = snapshot->survey();
        for (const auto& [option, member] : words->given)
          if (option->count() > 0) survey.*member = words->survey.*member;
        return surveyEdit(std::move(survey));
      });
    };
  });
}

void addDelete(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "delete",
      "Take stops out, with their poses, links and photographs; the file keeps them until it is compacted");
  auto words = std::make_shared<StopWords>();
  command->add_option("project", words->project, "The project")->required();
  command->add_option("scans", words->text, "Numbers of the stops, such as 3 or 0-5 or 0,2,7")->required();
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) {
        return parseIndexList(words->text, static_cast<int>(snapshot->scans().size()), "tiltmap delete")
            .map([&](const std::vector<int>& list) {
              std::vector<ScanId> scans;
              for (const int index : list)
                scans.push_back(snapshot->scans()[static_cast<std::size_t>(index)].id);
              return deleteEdit(*snapshot, std::move(scans));
            });
      });
    };
  });
}

void addRebase(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<StopWords>();
  auto* command = addStopCommand(
      app, "rebase", "Move the poses of every stage as a rigid whole until a stop is the world's origin",
      *words);
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) {
        return snapshot->scanAt(words->scan).and_then([&](const ScanEntry* scan) {
          return rebaseEdit(snapshot, scan->id, Pose());
        });
      });
    };
  });
}

}  // namespace

void addEdits(CLI::App& app, Chosen& chosen) {
  addRename(app, chosen);
  addNote(app, chosen);
  addColour(app, chosen);
  addSurvey(app, chosen);
  addDelete(app, chosen);
  addRebase(app, chosen);
}

}  // namespace tiltmap::cli
