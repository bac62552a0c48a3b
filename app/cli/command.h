// The shape of a command: it adds its words to the parser and says what to run.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "app/cli/console.h"
#include "core/base/parameter.h"

namespace tiltmap::cli {

struct Context {
  Console& console;
  std::stop_token stop;

  JobControl job() const { return console.job(stop); }
};

// Returns the exit code (console.h).
using CommandBody = std::function<int(Context&)>;

// What the parser leaves behind: the body of the command that was named.
struct Chosen {
  CommandBody body;
};

// Flags made from an operation's parameter descriptions: --name VALUE, with unit, range, default and help.
class ParameterFlags {
 public:
  static std::shared_ptr<ParameterFlags> addTo(CLI::App& command, const std::vector<ParameterInfo>& infos);
  // Only what was given on the command line.
  Result<ParameterValues> values() const;

 private:
  std::vector<ParameterInfo> infos_;
  std::vector<std::string> texts_;
  std::vector<CLI::Option*> options_;
};

// "parameter name (unit), range, default": one line for lists and help.
std::string parameterSummary(const ParameterInfo& info);

// One function a command; each lives in the file of its name.
void addNew(CLI::App& app, Chosen& chosen);
void addSimulate(CLI::App& app, Chosen& chosen);
void addImport(CLI::App& app, Chosen& chosen);
void addInfo(CLI::App& app, Chosen& chosen);
void addRegister(CLI::App& app, Chosen& chosen);
void addRelax(CLI::App& app, Chosen& chosen);
void addBodyMask(CLI::App& app, Chosen& chosen);
void addCalibrate(CLI::App& app, Chosen& chosen);
void addPoses(CLI::App& app, Chosen& chosen);
void addEvaluate(CLI::App& app, Chosen& chosen);
void addExport(CLI::App& app, Chosen& chosen);
void addParameters(CLI::App& app, Chosen& chosen);
void addDevices(CLI::App& app, Chosen& chosen);
void addDemo(CLI::App& app, Chosen& chosen);
void addHistory(CLI::App& app, Chosen& chosen);  // undo, redo, history
void addEdits(CLI::App& app, Chosen& chosen);    // rename, note, survey, delete, rebase
void addPhoto(CLI::App& app, Chosen& chosen);
void addLink(CLI::App& app, Chosen& chosen);
void addSite(CLI::App& app, Chosen& chosen);  // pin, aerial
void addFiles(CLI::App& app, Chosen& chosen);  // copy, merge, compact, verify
void addScreenshot(CLI::App& app, Chosen& chosen);
void addCapture(CLI::App& app, Chosen& chosen);
void addEmulate(CLI::App& app, Chosen& chosen);
void addGui(CLI::App& app, Chosen& chosen);

// What the rooms beside core can do joins operations(); once, before anything else.
void registerOperations();

// The window, on a project where one is named; fails where there is no display.
int openWindow(Context& context, const std::string& project);

}  // namespace tiltmap::cli
