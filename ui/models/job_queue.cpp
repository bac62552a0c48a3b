#include "ui/models/job_queue.h"

#include <algorithm>

#include "ui/models/project_session.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

using Clock = std::chrono::steady_clock;

// Below this a remainder computed from the fraction says more about start-up than about the work.
constexpr double kEnoughToTell = 0.03;
constexpr double kEnoughSeconds = 0.5;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

QString jobPhaseName(JobPhase phase) {
  switch (phase) {
    case JobPhase::Queued:
      return "queued";
    case JobPhase::Running:
      return "running";
    case JobPhase::Waiting:
      return "waiting to be accepted";
    case JobPhase::Failed:
      return "failed";
    case JobPhase::Cancelled:
      return "cancelled";
    case JobPhase::Accepted:
      return "done";
    case JobPhase::Discarded:
      return "discarded";
  }
  return {};
}

JobQueue::JobQueue(ProjectSession& session, QObject* parent) : QObject(parent), session_(session) {
  connect(&session, &ProjectSession::aboutToClose, this, &JobQueue::cancelAll);
}

JobQueue::~JobQueue() {
  // Joins the worker while poll() can still be posted to; what is posted dies with the object.
  entries_.clear();
}

JobQueue::Entry* JobQueue::entry(int id) {
  const auto found = std::ranges::find_if(entries_, [id](const Entry& e) { return e.status.id == id; });
  return found == entries_.end() ? nullptr : &*found;
}

JobQueue::Entry* JobQueue::active() {
  const auto found = std::ranges::find_if(entries_, [](const Entry& e) {
    return e.status.phase == JobPhase::Running || e.status.phase == JobPhase::Waiting;
  });
  return found == entries_.end() ? nullptr : &*found;
}

Result<int> JobQueue::start(const JobRequest& request) {
  return startAll({request});
}

Result<int> JobQueue::startAll(const std::vector<JobRequest>& requests) {
  if (requests.empty()) throw std::invalid_argument("JobQueue::startAll: no request");
  const bool idle = !busy();
  const int first = next_id_;
  for (const JobRequest& request : requests) {
    Entry& added = entries_.emplace_back();
    added.request = request;
    added.batch = first;
    added.status.id = next_id_++;
    added.status.operation = qt(request.operation->id());
    added.status.title = request.title.isEmpty() ? qt(request.operation->title()) : request.title;
    added.status.message = "waiting for its turn";
  }
  if (idle) {
    if (Status status = begin(*entry(first)); !status) {
      // As if it had never been asked for.
      while (!entries_.empty() && entries_.back().batch == first) entries_.pop_back();
      return fail(status.error());
    }
  }
  for (const Entry& added : entries_)
    if (added.batch == first) Q_EMIT changed(added.status.id);
  noteBusy();
  return first;
}

Status JobQueue::begin(Entry& e) {
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot) return fail("no project is open", "", "open or make a project first");
  auto posted = poll_posted_;
  // On the worker: one call of poll() at a time waits in the event loop, however often progress comes.
  const auto notify = [this, posted] {
    if (!posted->exchange(true)) deliveries_.post([this] { poll(); });
  };
  // The worker may notify before start() returns: poll() finds it by its phase.
  auto job = Job::start(*e.request.operation, snapshot, utf8(e.request.preset), e.request.values, notify);
  if (!job) return fail(job.error());
  e.job = std::move(*job);
  e.started = Clock::now();
  e.status.phase = JobPhase::Running;
  e.status.message.clear();
  return {};
}

void JobQueue::startNext() {
  while (!active()) {
    const auto next =
        std::ranges::find_if(entries_, [](const Entry& e) { return e.status.phase == JobPhase::Queued; });
    if (next == entries_.end()) break;
    const int id = next->status.id;
    if (Status status = begin(*next); !status) {
      next->status.error = status.error();
      end(*next, JobPhase::Failed);
      Q_EMIT failed(status.error());
    } else {
      Q_EMIT changed(id);
    }
  }
  noteBusy();
}

void JobQueue::readProgress(Entry& e) {
  const Progress progress = e.job->progress();
  e.status.fraction = progress.fraction;
  e.status.message = qt(progress.message);
  e.status.elapsed_s = secondsSince(e.started);
  if (progress.fraction >= kEnoughToTell && e.status.elapsed_s >= kEnoughSeconds)
    e.status.left_s = e.status.elapsed_s * (1.0 - progress.fraction) / progress.fraction;
  else
    e.status.left_s.reset();
}

void JobQueue::poll() {
  poll_posted_->store(false);
  Entry* e = active();
  if (!e || e->status.phase != JobPhase::Running || !e->job) return;
  session_.serve(*e->job);
  readProgress(*e);
  if (e->job->finished())
    conclude(*e);
  else
    Q_EMIT changed(e->status.id);
}

void JobQueue::conclude(Entry& e) {
  e.status.left_s.reset();
  const auto& result = e.job->result();
  if (!result) {
    const Error error = result.error();
    const bool cancelled = e.job->state() == JobState::Cancelled;
    if (!cancelled) e.status.error = error;
    end(e, cancelled ? JobPhase::Cancelled : JobPhase::Failed);
    if (!cancelled) Q_EMIT failed(error);
    return startNext();
  }
  if (e.cancelled) {
    e.job->discard();
    end(e, JobPhase::Cancelled);
    return startNext();
  }
  e.status.fraction = 1.0;
  e.status.warnings = result->warnings;
  e.status.report_json = result->report_json;
  if (e.request.ask && !result->edit.empty()) {
    e.status.phase = JobPhase::Waiting;
    e.status.message = "accept or discard the result";
    Q_EMIT changed(e.status.id);
    return noteBusy();
  }
  acceptNow(e);
}

void JobQueue::acceptNow(Entry& e) {
  if (Status status = session_.accept(*e.job); !status) {
    // The session has told why. Without an asker nobody could decide later.
    if (e.request.ask) return;
    e.job->discard();
    e.status.error = status.error();
    end(e, JobPhase::Failed);
  } else {
    end(e, JobPhase::Accepted);
  }
  startNext();
}

void JobQueue::end(Entry& e, JobPhase phase) {
  e.status.phase = phase;
  e.status.left_s.reset();
  e.status.message = jobPhaseName(phase);
  e.job.reset();  // with the matrices that its result may hold
  const int id = e.status.id, batch = e.batch;
  Q_EMIT changed(id);
  Q_EMIT finished(id);
  if (phase == JobPhase::Accepted) return;
  for (Entry& other : entries_)
    if (other.batch == batch && other.status.phase == JobPhase::Queued) end(other, JobPhase::Cancelled);
}

void JobQueue::cancel(int id) {
  Entry* e = entry(id);
  if (!e) return;
  if (e->status.phase == JobPhase::Running) {
    e->job->cancel();
    e->cancelled = true;
    e->status.message = "cancelling";
    Q_EMIT changed(id);
  } else if (e->status.phase == JobPhase::Queued) {
    end(*e, JobPhase::Cancelled);
    noteBusy();
  } else if (e->status.phase == JobPhase::Waiting) {
    discard(id);
  }
}

void JobQueue::cancelAll() {
  for (Entry& e : entries_)
    if (e.status.phase == JobPhase::Queued) end(e, JobPhase::Cancelled);
  if (Entry* e = active()) {
    if (e->status.phase == JobPhase::Running) {
      e->job->cancel();
      while (!e->job->waitFor(std::chrono::milliseconds(50))) session_.serve(*e->job);
      session_.serve(*e->job);
      // What was finished in the last moment is not wanted any more either.
      e->job->discard();
      end(*e, JobPhase::Cancelled);
    } else {
      e->job->discard();
      end(*e, JobPhase::Discarded);
    }
  }
  noteBusy();
}

void JobQueue::accept(int id) {
  Entry* e = entry(id);
  if (e && e->status.phase == JobPhase::Waiting) acceptNow(*e);
}

void JobQueue::discard(int id) {
  Entry* e = entry(id);
  if (!e || e->status.phase != JobPhase::Waiting) return;
  e->job->discard();
  end(*e, JobPhase::Discarded);
  startNext();
}

bool JobQueue::busy() const {
  return std::ranges::any_of(entries_, [](const Entry& e) { return !e.status.over(); });
}

const JobStatus* JobQueue::current() const {
  for (const Entry& e : entries_)
    if (e.status.phase == JobPhase::Running || e.status.phase == JobPhase::Waiting) return &e.status;
  return nullptr;
}

int JobQueue::queued() const {
  return static_cast<int>(
      std::ranges::count(entries_, JobPhase::Queued, [](const Entry& e) { return e.status.phase; }));
}

std::vector<JobStatus> JobQueue::jobs() const {
  std::vector<JobStatus> list;
  for (const Entry& e : entries_) list.push_back(e.status);
  return list;
}

const JobStatus* JobQueue::find(int id) const {
  for (const Entry& e : entries_)
    if (e.status.id == id) return &e.status;
  return nullptr;
}

const OperationResult* JobQueue::waitingResult(int id) const {
  for (const Entry& e : entries_)
    if (e.status.id == id && e.status.phase == JobPhase::Waiting) return &*e.job->result();
  return nullptr;
}

void JobQueue::waitForAll() {
  while (Entry* e = active()) {
    if (e->status.phase == JobPhase::Waiting) return;
    (void)e->job->waitFor(std::chrono::milliseconds(50));
    poll();
  }
}

void JobQueue::noteBusy() {
  if (busy() == was_busy_) return;
  was_busy_ = busy();
  Q_EMIT busyChanged();
}

}  // namespace tiltmap::ui
