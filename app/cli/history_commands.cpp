// tiltmap undo|redo|history P.tiltmap
#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

namespace {

int step(Context& context, const std::string& path, bool back) {
  auto project = Project::open(path, Access::ReadWrite);
  if (!project) return context.console.failed(project.error());
  auto change = back ? (*project)->undo() : (*project)->redo();
  if (!change) return context.console.failed(change.error());
  const std::string word = back ? "undone" : "redone";
  context.console.printJson({{word, change->title}, {"revision", change->revision}});
  context.console.print(word + ": " + change->title);
  return kDone;
}

int history(Context& context, const std::string& path) {
  auto snapshot = readProject(path);
  if (!snapshot) return context.console.failed(snapshot.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (const HistoryEntry& entry : (*snapshot)->history()) {
    const char* state = entry.fixed ? "fixed" : entry.undone ? "undone" : "done";
    list.push_back({{"id", entry.id},
                    {"title", entry.title},
                    {"time", entry.time},
                    {"program_version", entry.program_version},
                    {"state", state}});
    text += entry.time + "  " + entry.title +
            (entry.undone  ? "  (undone)"
             : entry.fixed ? "  (fixed)"
                           : "") +
            "\n";
  }
  context.console.printJson({{"history", list}});
  context.console.print(text.empty() ? "nothing was done yet" : text);
  return kDone;
}

}  // namespace

void addHistory(CLI::App& app, Chosen& chosen) {
  const auto add = [&](const char* name, const char* help, auto body) {
    auto* command = app.add_subcommand(name, help);
    auto path = std::make_shared<std::string>();
    command->add_option("project", *path, "The project")->required();
    command->callback([path, body, &chosen] {
      chosen.body = [path, body](Context& context) -> int { return body(context, *path); };
    });
  };
  add("undo", "Take the last edit back",
      [](Context& c, const std::string& path) { return step(c, path, true); });
  add("redo", "Bring back what was undone last",
      [](Context& c, const std::string& path) { return step(c, path, false); });
  add("history", "What was done to the project, in order", history);
}

}  // namespace tiltmap::cli
