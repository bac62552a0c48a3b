// Running an operation of the project from a command: a job, its progress, Ctrl-C, and accepting the result.
#pragma once

#include <string>

#include "app/cli/command.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "core/project/stage_choice.h"

namespace tiltmap::cli {

// The operation's result once the project has accepted it. Warnings are in the result, not yet shown.
Result<OperationResult> runOperation(Context& context, Project& project, const std::string& operation,
                                     const std::string& preset, const ParameterValues& values);

// The same as a whole command: opens the project, runs, shows warnings, prints `text(report)` or the report
// as JSON (what `as_json` makes of it, where given) with its warnings, and returns the exit code.
int operationCommand(Context& context, const std::string& project_path, const std::string& operation,
                     const std::string& preset, const ParameterValues& values,
                     const std::function<std::string(const nlohmann::json&)>& text,
                     Access access = Access::ReadWrite,
                     const std::function<nlohmann::json(const nlohmann::json&)>& as_json = {});

// A whole command for an operation that finds something out, and changes the project only with --apply (its
// parameters have `apply` and `out`): named like the operation, with the project and its parameters as flags.
void addApplyingCommand(CLI::App& app, Chosen& chosen, const std::string& operation, const std::string& help,
                        const std::function<std::string(const nlohmann::json&)>& text);

// A command that makes one edit: opens the project, applies what `make` says, prints what was done.
// `warnings` may be filled by `make`. JSON: {"done": title, "revision": n, "warnings": [..]}.
int editCommand(Context& context, const std::string& project_path,
                const std::function<Result<ProjectEdit>(const SnapshotPtr&)>& make,
                const std::vector<std::string>* warnings = nullptr);

// Refuses a file name that a project has or may have: results of another kind never replace one.
Status checkOutput(const std::string& file, const std::string& project_path);

// A reading command's snapshot.
Result<SnapshotPtr> readProject(const std::string& path);

}  // namespace tiltmap::cli
