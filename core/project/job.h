// A running operation: started on a snapshot, watched, stopped, and its result accepted or discarded.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "core/project/operation.h"
#include "core/project/project.h"

namespace tiltmap {

// Owned by the thread that owns the project. The operation runs on a worker thread of its own and sees the
// snapshot only; nothing of the project changes before accept(). Destroying a running job cancels it and
// waits.
class Job {
 public:
  // Called on the worker thread after progress, when something is to be stored and once at the end; must return
  // quickly (post to an event loop).
  using Notify = std::function<void()>;

  // Checks names, values and the project first and starts nothing when they are refused.
  static Result<std::unique_ptr<Job>> start(const Operation& operation, SnapshotPtr snapshot,
                                            const std::string& preset, const ParameterValues& values,
                                            Notify notify = {});
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  // Any thread.
  JobState state() const;
  bool finished() const;      // the worker is through, one way or another
  Progress progress() const;  // the latest
  void cancel();
  void wait() const;
  // True when finished. Ends early when the operation wants something stored: serve() does it.
  bool waitFor(std::chrono::milliseconds time) const;

  // Stores what the operation has asked for meanwhile (LiveProject), on the thread that owns the project. To
  // be called when Notify tells of something; a capture waits for it. True when there was anything.
  bool serve(Project& project);

  // After finished(): what came of it. Before: throws std::logic_error.
  const Result<OperationResult>& result() const;
  JobRecord record() const;

  // Applies the result's edit together with the job's record. Only once, only while Waiting; when the project
  // refuses the edit the job goes on waiting, and can be discarded. An operation without an edit leaves the
  // file alone.
  Result<Change> accept(Project& project);
  void discard();

 private:
  struct State;
  explicit Job(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tiltmap
