#include "core/project/job.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <thread>

#include "core/base/version.h"
#include "core/project/live_project.h"

namespace tiltmap {

struct Job::State {
  const Operation* operation = nullptr;
  SnapshotPtr snapshot;
  Notify notify;

  mutable std::mutex mutex;
  mutable std::condition_variable ended;
  JobRecord record;  // its state is the job's
  Progress progress;
  std::optional<Result<OperationResult>> result;  // set once by the worker; read by others only when finished
  // What the worker wants stored; called with null when nobody is going to store it any more.
  std::deque<std::function<void(Project*)>> wishes;
  bool abandoned = false;

  std::jthread worker;  // last: joined before what it uses goes

  void run(const std::stop_token& stop);
  void finish(Result<OperationResult> outcome);
  void wish(std::function<void(Project*)> what);
  void abandon();
};

namespace {

// The worker's side of Job::serve.
class ServedProject : public LiveProject {
 public:
  using Wish = std::function<void(std::function<void(Project*)>)>;
  explicit ServedProject(Wish wish) : wish_(std::move(wish)) {}
  Result<Change> apply(ProjectEdit edit) override {
    auto promise = std::make_shared<std::promise<Result<Change>>>();
    auto future = promise->get_future();
    wish_([promise, edit = std::move(edit)](Project* project) {
      promise->set_value(project ? project->apply(edit) : Result<Change>(fail(closed())));
    });
    return future.get();
  }
  std::future<Status> appendLine(ScanId scan, int row, ScanLine line) override {
    auto promise = std::make_shared<std::promise<Status>>();
    auto future = promise->get_future();
    wish_([promise, scan, row, line = std::move(line)](Project* project) {
      promise->set_value(project ? project->appendLine(scan, row, line) : Status(fail(closed())));
    });
    return future;
  }

 private:
  static Error closed() {
    return {"the project is being closed", "", "open it again and go on; everything stored so far is there"};
  }
  Wish wish_;
};

// An operation's defect must not end the program and lose the other jobs' results.
Result<OperationResult> runGuarded(const Operation& operation, const SnapshotPtr& snapshot,
                                   const ParameterValues& values, const JobControl& control,
                                   LiveProject& live) {
  try {
    return operation.runLive(snapshot, values, control, live);
  } catch (const std::bad_alloc&) {
    return fail("there is not enough memory", operation.title(),
                "close other programs or work on fewer scans");
  } catch (const std::exception& exception) {
    return fail("the operation failed in a way it should not: " + std::string(exception.what()),
                operation.title(), "please report this as a defect; the project is as it was before");
  }
}

}  // namespace

void Job::State::run(const std::stop_token& stop) {
  JobControl control;
  control.stop = stop;
  control.report = [this](const Progress& latest) {
    {
      const std::lock_guard lock(mutex);
      progress = latest;
    }
    if (notify) notify();
  };
  ServedProject live([this](std::function<void(Project*)> what) { wish(std::move(what)); });
  // Written before the worker starts and only read while it runs.
  finish(runGuarded(*operation, snapshot, record.values, control, live));
}

void Job::State::wish(std::function<void(Project*)> what) {
  {
    const std::lock_guard lock(mutex);
    if (!abandoned) {
      wishes.push_back(std::move(what));
      what = nullptr;
    }
  }
  if (what) return what(nullptr);
  ended.notify_all();
  if (notify) notify();
}

void Job::State::abandon() {
  std::deque<std::function<void(Project*)>> left;
  {
    const std::lock_guard lock(mutex);
    abandoned = true;
    left.swap(wishes);
  }
  for (const auto& what : left) what(nullptr);
}

void Job::State::finish(Result<OperationResult> outcome) {
  {
    const std::lock_guard lock(mutex);
    record.finished = utcNow();
    if (outcome) {
      record.state = JobState::Waiting;
      record.warnings = outcome->warnings;
      progress.fraction = 1.0;
    } else {
      record.state = outcome.error().what == kCancelled ? JobState::Cancelled : JobState::Failed;
    }
    result.emplace(std::move(outcome));
  }
  ended.notify_all();
  if (notify) notify();
}

Job::Job(std::unique_ptr<State> state) : state_(std::move(state)) {}
Job::~Job() {
  state_->worker.request_stop();
  // A worker that waits for something to be stored would never end.
  state_->abandon();
}

Result<std::unique_ptr<Job>> Job::start(const Operation& operation, SnapshotPtr snapshot,
                                        const std::string& preset, const ParameterValues& values,
                                        Notify notify) {
  auto complete = operation.completed(preset, values);
  if (!complete) return fail(complete.error());
  if (Status status = operation.check(*snapshot, *complete); !status) return fail(status.error());
  auto state = std::make_unique<State>();
  state->operation = &operation;
  state->snapshot = std::move(snapshot);
  state->notify = std::move(notify);
  state->record.operation = operation.id();
  state->record.preset = preset;
  state->record.values = std::move(*complete);
  state->record.program_version = programVersion();
  state->record.started = utcNow();
  State* shared = state.get();
  state->worker = std::jthread([shared](const std::stop_token& stop) { shared->run(stop); });
  return std::unique_ptr<Job>(new Job(std::move(state)));
}

JobState Job::state() const {
  const std::lock_guard lock(state_->mutex);
  return state_->record.state;
}
bool Job::finished() const {
  return state() != JobState::Running;
}
Progress Job::progress() const {
  const std::lock_guard lock(state_->mutex);
  return state_->progress;
}
JobRecord Job::record() const {
  const std::lock_guard lock(state_->mutex);
  return state_->record;
}
void Job::cancel() {
  state_->worker.request_stop();
}

void Job::wait() const {
  std::unique_lock lock(state_->mutex);
  state_->ended.wait(lock, [this] { return state_->record.state != JobState::Running; });
}
bool Job::waitFor(std::chrono::milliseconds time) const {
  std::unique_lock lock(state_->mutex);
  state_->ended.wait_for(
      lock, time, [this] { return state_->record.state != JobState::Running || !state_->wishes.empty(); });
  return state_->record.state != JobState::Running;
}

bool Job::serve(Project& project) {
  // What comes meanwhile has been told and is served next time: who owns the project has other things to do.
  std::size_t left = 0;
  {
    const std::lock_guard lock(state_->mutex);
    left = state_->wishes.size();
  }
  const bool any = left > 0;
  for (; left > 0; --left) {
    std::function<void(Project*)> what;
    {
      const std::lock_guard lock(state_->mutex);
      what = std::move(state_->wishes.front());
      state_->wishes.pop_front();
    }
    what(&project);
  }
  return any;
}

const Result<OperationResult>& Job::result() const {
  const std::lock_guard lock(state_->mutex);
  if (!state_->result) throw std::logic_error("Job::result: the job is still running");
  return *state_->result;
}

Result<Change> Job::accept(Project& project) {
  const JobRecord now = record();
  if (now.state != JobState::Waiting)
    return fail("there is no result to accept: the job is " + jobStateName(now.state),
                state_->operation->title(), "run it again");
  const SnapshotPtr current = project.snapshot();
  if (current->projectId() != state_->snapshot->projectId())
    return fail("the result was computed for another project", state_->snapshot->path().string(),
                "accept it there");
  Change change;
  change.revision = current->revision();
  if (ProjectEdit edit = result()->edit; !edit.empty()) {
    if (edit.title.empty()) edit.title = state_->operation->title();
    JobRecord stored = now;
    stored.state = JobState::Accepted;
    edit.jobs.push_back(std::move(stored));
    auto applied = project.apply(edit);
    if (!applied) return applied;
    change = std::move(*applied);
  }
  const std::lock_guard lock(state_->mutex);
  state_->record.state = JobState::Accepted;
  return change;
}

void Job::discard() {
  const std::lock_guard lock(state_->mutex);
  if (state_->record.state == JobState::Waiting) state_->record.state = JobState::Discarded;
}

}  // namespace tiltmap
