#include "app/cli/operation_runner.h"

#include <filesystem>

#include "core/project/job.h"

namespace tiltmap::cli {

Result<OperationResult> runOperation(Context& context, Project& project, const std::string& operation,
                                     const std::string& preset, const ParameterValues& values) {
  auto found = operations().get(operation);
  if (!found) return fail(found.error());
  const std::int64_t before = project.snapshot()->revision();
  auto job = Job::start(**found, project.snapshot(), preset, values);
  if (!job) return fail(job.error());
  const JobControl control = context.job();
  while (!(*job)->waitFor(std::chrono::milliseconds(40))) {
    if (context.stop.stop_requested()) (*job)->cancel();
    (*job)->serve(project);
    const Progress progress = (*job)->progress();
    control.tell(progress.fraction, progress.message);
  }
  (*job)->serve(project);
  context.console.endProgress();
  const auto& result = (*job)->result();
  if (!result) {
    if (result.error().what == kCancelled && project.snapshot()->revision() != before)
      return fail("cancelled; what was stored until then is kept", project.path().string(),
                  result.error().remedy);
    if (result.error().what == kCancelled)
      return fail("cancelled; the project is as it was", project.path().string(),
                  "run the command again when you like");
    return fail(result.error());
  }
  OperationResult outcome = *result;
  if (auto change = (*job)->accept(project); !change) return fail(change.error());
  return outcome;
}

int operationCommand(Context& context, const std::string& project_path, const std::string& operation,
                     const std::string& preset, const ParameterValues& values,
                     const std::function<std::string(const nlohmann::json&)>& text, Access access,
                     const std::function<nlohmann::json(const nlohmann::json&)>& as_json) {
  auto project = Project::open(project_path, access);
  if (!project) return context.console.failed(project.error());
  auto outcome = runOperation(context, **project, operation, preset, values);
  if (!outcome) return context.console.failed(outcome.error());
  for (const std::string& warning : outcome->warnings) context.console.warn(warning);
  nlohmann::json report =
      outcome->report_json.empty() ? nlohmann::json::object() : nlohmann::json::parse(outcome->report_json);
  report["warnings"] = warningsJson(outcome->warnings);
  context.console.printJson(as_json ? as_json(report) : report);
  context.console.print(text(report));
  return kDone;
}

int editCommand(Context& context, const std::string& project_path,
                const std::function<Result<ProjectEdit>(const SnapshotPtr&)>& make,
                const std::vector<std::string>* warnings) {
  auto project = Project::open(project_path, Access::ReadWrite);
  if (!project) return context.console.failed(project.error());
  const auto edit = make((*project)->snapshot());
  if (!edit) return context.console.failed(edit.error());
  const auto change = (*project)->apply(*edit);
  if (!change) return context.console.failed(change.error());
  const std::vector<std::string> remarks = warnings ? *warnings : std::vector<std::string>();
  for (const std::string& warning : remarks) context.console.warn(warning);
  context.console.printJson(
      {{"done", edit->title}, {"revision", change->revision}, {"warnings", warningsJson(remarks)}});
  context.console.print("done: " + edit->title);
  return kDone;
}

Status checkOutput(const std::string& file, const std::string& project_path) {
  std::error_code ignored;
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension.starts_with(".tiltmap") || std::filesystem::equivalent(file, project_path, ignored))
    return fail("this is the name of a project, which is never replaced", file, "choose another name");
  return {};
}

Result<SnapshotPtr> readProject(const std::string& path) {
  return Project::open(path, Access::ReadOnly).map([](const std::unique_ptr<Project>& project) {
    return project->snapshot();
  });
}

void addApplyingCommand(CLI::App& app, Chosen& chosen, const std::string& operation, const std::string& help,
                        const std::function<std::string(const nlohmann::json&)>& text) {
  auto* command = app.add_subcommand(operation, help);
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The project")->required();
  auto flags = ParameterFlags::addTo(*command, operations().find(operation)->parameters());
  command->callback([path, flags, operation, text, &chosen] {
    chosen.body = [path, flags, operation, text](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      if (const auto out = values->find("out"); out != values->end())
        if (Status status = checkOutput(std::get<std::string>(out->second), *path); !status)
          return context.console.failed(status.error());
      const auto apply = values->find("apply");
      const bool writes = apply != values->end() && std::get<bool>(apply->second);
      return operationCommand(context, *path, operation, "default", *values, text,
                              writes ? Access::ReadWrite : Access::ReadOnly);
    };
  });
}

}  // namespace tiltmap::cli
