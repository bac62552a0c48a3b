// What the program can do with a project, described once for command line, window, manual and report.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/parameter.h"
#include "core/base/progress.h"
#include "core/project/project_edit.h"

namespace tiltmap {

struct OperationResult {
  ProjectEdit edit;  // empty for an operation that changes nothing (export)
  std::vector<std::string> warnings;
  std::string report_json;  // one JSON object for scripts and the report; may be empty
};

class LiveProject;

// Stateless: any thread, several jobs at once. Values are in the units of the edge (see ParameterInfo) and
// need not be complete: a parameter that is not named has its default.
class Operation {
 public:
  virtual ~Operation() = default;

  virtual std::string id() const = 0;     // "register": the command's word
  virtual std::string title() const = 0;  // "Register pairs": the menu's
  virtual std::string help() const = 0;   // one paragraph
  virtual const std::vector<ParameterInfo>& parameters() const = 0;
  virtual std::vector<ParameterPreset> presets() const = 0;
  // Every parameter's value under the preset.
  virtual Result<ParameterValues> presetValues(const std::string& preset) const = 0;

  // Quick: whether it could run on this project with these values, and if not, what the user can do.
  virtual Status check(const ProjectSnapshot& snapshot, const ParameterValues& values) const = 0;
  // May take long; reports progress and ends soon after a stop is requested, with an Error whose what is
  // kCancelled.
  virtual Result<OperationResult> run(const SnapshotPtr& snapshot, const ParameterValues& values,
                                      const JobControl& control) const = 0;
  // The same for an operation that stores while it runs (a capture); others leave it as it is.
  virtual Result<OperationResult> runLive(const SnapshotPtr& snapshot, const ParameterValues& values,
                                          const JobControl& control, LiveProject&) const {
    return run(snapshot, values, control);
  }

  // The preset's values with `values` set on top: all parameters. Refuses unknown names (naming the nearest)
  // and values out of range.
  Result<ParameterValues> completed(const std::string& preset, const ParameterValues& values) const;
  // The same from a command line's words.
  Result<ParameterValues> parsed(const std::string& preset,
                                 const std::vector<std::pair<std::string, std::string>>& words) const;
};

// The usual way to write one: a plain settings structure and its ParameterTable.
template <class Settings>
class SettingsOperation : public Operation {
 public:
  // The table must live as long as the operation (a function's static).
  explicit SettingsOperation(const ParameterTable<Settings>& table) : table_(table) {}

  std::string id() const override { return table_.operation(); }
  const std::vector<ParameterInfo>& parameters() const override { return table_.infos(); }
  std::vector<ParameterPreset> presets() const override { return table_.presets(); }
  Result<ParameterValues> presetValues(const std::string& preset) const override {
    return table_.presetSettings(preset).map(
        [this](const Settings& settings) { return table_.values(settings); });
  }
  Status check(const ProjectSnapshot& snapshot, const ParameterValues& values) const override {
    Settings settings;
    if (Status status = table_.apply(values, settings); !status) return status;
    return checkSettings(snapshot, settings);
  }
  Result<OperationResult> run(const SnapshotPtr& snapshot, const ParameterValues& values,
                              const JobControl& control) const override {
    Settings settings;
    if (Status status = table_.apply(values, settings); !status) return fail(status.error());
    return runSettings(snapshot, settings, control);
  }

 protected:
  virtual Status checkSettings(const ProjectSnapshot& snapshot, const Settings& settings) const = 0;
  virtual Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const Settings& settings,
                                              const JobControl& control) const = 0;

 private:
  const ParameterTable<Settings>& table_;
};

class OperationRegistry {
 public:
  // Throws std::logic_error for a second operation of the same id.
  void add(std::unique_ptr<Operation> operation);
  std::vector<const Operation*> all() const;  // in the order added
  const Operation* find(const std::string& id) const;
  // With an error that names the nearest.
  Result<const Operation*> get(const std::string& id) const;

 private:
  std::vector<std::unique_ptr<Operation>> operations_;
};

// The program's operations (core/project/operations.cpp lists core's own).
const OperationRegistry& operations();
// For rooms that core does not know: adds one to operations(), before anybody looks at them on another thread.
void addOperation(std::unique_ptr<Operation> operation);

}  // namespace tiltmap
