#include "app/cli/command_line.h"

#include <algorithm>
#include <exception>
#include <iostream>

#include "app/cli/command.h"
#include "core/base/text.h"
#include "ui/window/gui_application.h"

namespace tiltmap::cli {

namespace {

void addOutputFlags(CLI::App& app, OutputFlags& flags) {
  app.add_flag("--json", flags.json, "One JSON object on standard output instead of text");
  app.add_flag("--quiet", flags.quiet, "Results and errors only: no progress, notes or warnings");
  app.add_flag("--verbose", flags.verbose, "More about what is done");
}

const CLI::App& namedCommand(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().back();
  return *command;
}

// Every word that the command would have understood.
std::vector<std::string> knownWords(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> known;
  for (const CLI::App* place : {&app, &command})
    for (const CLI::Option* option : place->get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
    known.push_back(sub->get_name());
  return known;
}

bool takesCommand(const CLI::App& command) {
  return !command.get_subcommands([](const CLI::App*) { return true; }).empty();
}

// "tiltmap photo add": the words that lead to a command.
std::string wordsOf(const CLI::App& command) {
  return command.get_parent() ? wordsOf(*command.get_parent()) + " " + command.get_name() : "tiltmap";
}

// What the parser says, and for a word that nobody knows the one that was probably meant.
Error unexpectedWords(const CLI::App& app, const CLI::ParseError& error,
                      const std::vector<std::string>& words) {
  const CLI::App& command = namedCommand(app);
  const std::vector<std::string> known = knownWords(app, command);
  std::string remedy;
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    const bool flag = name.starts_with("--");
    if ((!flag && !takesCommand(command)) || word == command.get_name() ||
        std::ranges::find(known, name) != known.end())
      continue;
    if (const auto nearest = nearestName(name, known)) remedy = "did you mean " + *nearest + "? ";
    break;
  }
  const bool top = &command == &app;
  return {error.what(), top ? "the command line" : wordsOf(command),
          remedy + "`" + wordsOf(command) + " --help` lists what there is"};
}

int parseError(const CLI::App& app, const CLI::ParseError& error, Console& console,
               const std::vector<std::string>& words) {
  if (error.get_exit_code() == 0) {  // --help, --version
    const bool version = dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr;
    std::cout << (version ? std::string(error.what()) + "\n" : namedCommand(app).help());
    return kDone;
  }
  return console.wrongUsage(unexpectedWords(app, error, words));
}

}  // namespace

int run(int argc, char** argv) {
  registerOperations();
  CLI::App app("Tiltmap: from the range matrices of a tilted laser scanner to one consistent 3D map",
               "tiltmap");
  app.set_version_flag("--version", "tiltmap " TILTMAP_VERSION);
  app.fallthrough();
  app.require_subcommand(0, 1);
  OutputFlags flags;
  addOutputFlags(app, flags);
  app.footer("`tiltmap COMMAND --help` tells the rest.");

  Chosen chosen;
  for (const auto add : {addNew, addSimulate, addCapture, addEmulate, addImport, addInfo, addRegister, addRelax, addCalibrate, addBodyMask, addPoses,
                         addEvaluate, addExport, addParameters, addHistory, addEdits, addPhoto, addLink,
                         addSite, addFiles, addDemo, addDevices, addScreenshot, addGui})
    add(app, chosen);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // The flags behind the mistake may not have been read: look for --json by hand.
    for (int i = 1; i < argc; ++i) flags.json |= std::string_view(argv[i]) == "--json";
    Console console(flags);
    return parseError(app, error, console, {argv + 1, argv + argc});
  }
  // Without words: the window where there is a display, else what words there are.
  if (!chosen.body && ui::displayThere())
    chosen.body = [](Context& context) { return openWindow(context, {}); };
  if (!chosen.body) {
    std::cout << app.help();
    return kDone;
  }
  const StopOnSignal signals;
  Console console(flags);
  Context context{console, signals.token()};
  try {
    return chosen.body(context);
  } catch (const std::bad_alloc&) {
    return console.failed(
        {"there is not enough memory for this", "", "close other programs or work on fewer scans"});
  } catch (const std::exception& error) {
    return console.failed(
        {std::string("an internal check failed: ") + error.what(), "",
         "the project keeps everything that was accepted; please report this with the command you gave"});
  }
}

}  // namespace tiltmap::cli
