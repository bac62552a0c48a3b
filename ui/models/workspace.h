// Everything that the panels of one window share.
#pragma once

#include <QObject>

#include "ui/models/job_queue.h"
#include "ui/models/link_opinions.h"
#include "ui/models/messages.h"
#include "ui/models/preferences.h"
#include "ui/models/project_session.h"
#include "ui/models/residuals.h"
#include "ui/models/scan_display.h"
#include "ui/models/selection.h"
#include "ui/models/stepper_model.h"

namespace tiltmap::ui {

class RelaxationModel;

// Wires them: errors become messages, finished jobs are told, the selection forgets what is gone. No widgets.
class Workspace : public QObject {
  Q_OBJECT

 public:
  explicit Workspace(Preferences& preferences, QObject* parent = nullptr);
  ~Workspace() override;

  Preferences& preferences() { return preferences_; }
  const Preferences& preferences() const { return preferences_; }
  ProjectSession& session() { return session_; }
  const ProjectSession& session() const { return session_; }
  SnapshotPtr snapshot() const { return session_.snapshot(); }
  JobQueue& jobs() { return jobs_; }
  const JobQueue& jobs() const { return jobs_; }
  Selection& selection() { return selection_; }
  const Selection& selection() const { return selection_; }
  ScanDisplay& display() { return display_; }
  const ScanDisplay& display() const { return display_; }
  Messages& messages() { return messages_; }
  Residuals& residuals() { return residuals_; }
  // Every relaxation of this window, whoever started it.
  RelaxationModel& relaxation() { return *relaxation_; }
  StepperModel& stepper() { return stepper_; }
  const StepperModel& stepper() const { return stepper_; }
  LinkOpinions& linkOpinions() { return link_opinions_; }

  // Starts an operation with the number of threads that the user prefers, unless `values` says otherwise. A
  // refusal is shown as a message; the job's id else.
  std::optional<int> start(JobRequest request);
  std::optional<int> startAll(std::vector<JobRequest> requests);

 private:
  JobRequest withThreads(JobRequest request) const;
  void tellFinished(int id);

  Preferences& preferences_;
  ProjectSession session_;
  JobQueue jobs_;
  Selection selection_;
  ScanDisplay display_;
  std::unique_ptr<RelaxationModel> relaxation_;
  Messages messages_;
  Residuals residuals_;
  StepperModel stepper_;
  LinkOpinions link_opinions_;
};

}  // namespace tiltmap::ui
