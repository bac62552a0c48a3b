#include "ui/models/workspace.h"

#include <algorithm>

#include "ui/models/log.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

Workspace::Workspace(Preferences& preferences, QObject* parent)
    : QObject(parent),
      preferences_(preferences),
      jobs_(session_),
      display_(session_),
      relaxation_(std::make_unique<RelaxationModel>(session_, jobs_, display_)),
      residuals_(session_),
      stepper_(session_, preferences) {
  connect(&session_, &ProjectSession::failed, &messages_, &Messages::error);
  connect(&jobs_, &JobQueue::failed, &messages_, &Messages::error);
  connect(&stepper_, &StepperModel::failed, &messages_, &Messages::error);
  connect(&jobs_, &JobQueue::finished, this, &Workspace::tellFinished);
  connect(&jobs_, &JobQueue::busyChanged, this, [this] { stepper_.setProjectBusy(jobs_.busy()); });
  connect(&session_, &ProjectSession::snapshotReplaced, this,
          [this] { selection_.keepOnly(session_.snapshot().get()); });
  connect(&session_, &ProjectSession::opened, this, [this] {
    selection_.clear();
    preferences_.addRecentFile(session_.path());
    logLine(LogLevel::Info,
            QString("opened %1%2").arg(session_.path(), session_.isWritable() ? "" : " for reading"));
  });
  connect(&session_, &ProjectSession::changed, this,
          [](const Change& change) { logLine(LogLevel::Info, "project: " + qt(change.title)); });
}

Workspace::~Workspace() = default;

JobRequest Workspace::withThreads(JobRequest request) const {
  const auto& infos = request.operation->parameters();
  const bool takes = std::ranges::any_of(infos, [](const auto& info) { return info.name == "threads"; });
  if (takes && !request.values.contains("threads"))
    request.values["threads"] = static_cast<long long>(preferences_.threads());
  return request;
}

std::optional<int> Workspace::start(JobRequest request) {
  return startAll({std::move(request)});
}

std::optional<int> Workspace::startAll(std::vector<JobRequest> requests) {
  for (JobRequest& request : requests) request = relaxation_->watched(withThreads(std::move(request)));
  const auto id = jobs_.startAll(requests);
  if (id) {
    for (std::size_t k = 0; k < requests.size(); ++k)
      relaxation_->started(*id + static_cast<int>(k), requests[k]);
    return *id;
  }
  messages_.error(id.error());
  return {};
}

void Workspace::tellFinished(int id) {
  const JobStatus* job = jobs_.find(id);
  if (!job) return;
  const QString line =
      QString("%1: %2 after %3 s").arg(job->title, jobPhaseName(job->phase)).arg(job->elapsed_s, 0, 'f', 1);
  if (job->phase == JobPhase::Accepted && job->warnings.empty())
    messages_.note(line + ".");
  else if (job->phase == JobPhase::Accepted)
    messages_.warnings(job->title, job->warnings);
  else
    logLine(LogLevel::Info, line);
  if (job->phase == JobPhase::Cancelled)
    messages_.note(job->title + (job->operation == "capture"
                                     ? ": stopped. Every line that was complete is kept."
                                     : ": cancelled. The project is as it was."));
}

}  // namespace tiltmap::ui
