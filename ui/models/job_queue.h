// The work of one window: operations run one after the other, their results accepted as edits.
#pragma once

#include <QObject>
#include <QString>
#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/project/job.h"
#include "ui/models/deliveries.h"

namespace tiltmap::ui {

class ProjectSession;

struct JobRequest {
  const Operation* operation = nullptr;
  QString preset = "default";
  ParameterValues values;
  QString title;  // empty: the operation's
  // Wait for accept() or discard() instead of storing the result at once. The jobs behind it wait too: they
  // would be computed from poses that may be about to change.
  bool ask = false;
  std::shared_ptr<const void> keep;  // lives as long as the work: what owns `operation`, for one made for it
};

enum class JobPhase { Queued, Running, Waiting, Failed, Cancelled, Accepted, Discarded };

// What there is to show about a job.
struct JobStatus {
  int id = 0;
  QString title;
  QString operation;  // Operation::id()
  JobPhase phase = JobPhase::Queued;
  double fraction = 0.0;  // 0 to 1; negative where the length of the work is not known
  QString message;
  double elapsed_s = 0.0;
  std::optional<double> left_s;  // once enough is done to tell
  std::optional<Error> error;
  std::vector<std::string> warnings;
  std::string report_json;

  bool over() const { return phase >= JobPhase::Failed; }
};

QString jobPhaseName(JobPhase phase);  // "queued", "running", ...

// Lives on the window's thread. Closing the project cancels everything and waits for it (an operation looks
// at its stop token every 50 ms).
class JobQueue : public QObject {
  Q_OBJECT

 public:
  explicit JobQueue(ProjectSession& session, QObject* parent = nullptr);
  ~JobQueue() override;

  // The job's id. With nothing before it in the queue it starts now, and what the operation's check refuses
  // is returned; behind others it is checked when its turn comes.
  Result<int> start(const JobRequest& request);
  // Several that need each other: when one does not succeed, those after it are cancelled.
  Result<int> startAll(const std::vector<JobRequest>& requests);

  void cancel(int id);
  void cancelAll();
  void accept(int id);
  void discard(int id);

  // Anything running, queued or waiting to be accepted.
  bool busy() const;
  // What is being computed, or waits to be accepted; nothing where the queue is idle.
  const JobStatus* current() const;
  int queued() const;
  // In the order started, the finished ones of this session included.
  std::vector<JobStatus> jobs() const;
  const JobStatus* find(int id) const;
  // The result of a job that is Waiting, to be shown before it is accepted; nothing otherwise.
  const OperationResult* waitingResult(int id) const;

  // Returns when nothing runs or is queued any more, or nothing moves before a decision is made. For tests
  // and for the end of the program; runs no event loop.
  void waitForAll();

 Q_SIGNALS:
  void changed(int id);   // progress or phase
  void finished(int id);  // over() from now on
  void busyChanged();
  void failed(const tiltmap::Error& error);

 private:
  struct Entry {
    JobRequest request;
    JobStatus status;
    int batch = 0;
    bool cancelled = false;  // asked for: a result that comes all the same is not wanted
    std::unique_ptr<Job> job;
    std::chrono::steady_clock::time_point started;
  };

  Entry* entry(int id);
  Entry* active();
  Status begin(Entry& entry);
  void startNext();
  void poll();
  void readProgress(Entry& entry);
  void conclude(Entry& entry);
  void acceptNow(Entry& entry);
  void end(Entry& entry, JobPhase phase);
  void noteBusy();

  Deliveries deliveries_;  // from the jobs
  ProjectSession& session_;
  std::deque<Entry> entries_;  // addresses stay
  int next_id_ = 1;
  bool was_busy_ = false;
  std::shared_ptr<std::atomic<bool>> poll_posted_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace tiltmap::ui
