// What an operation may store while it still runs: a capture's lines cannot wait for its end.
#pragma once

#include <future>
#include <utility>

#include "core/project/project.h"

namespace tiltmap {

// Used on the worker's thread; whoever owns the project does the storing (Job::serve). Once nobody owns it
// any more every call fails.
class LiveProject {
 public:
  virtual ~LiveProject() = default;
  // Returns when it is stored.
  virtual Result<Change> apply(ProjectEdit edit) = 0;
  // Returns at once; the line is durable when the future says so.
  virtual std::future<Status> appendLine(ScanId scan, int row, ScanLine line) = 0;
};

// For callers on the project's own thread.
class OwnLiveProject : public LiveProject {
 public:
  explicit OwnLiveProject(Project& project) : project_(project) {}
  Result<Change> apply(ProjectEdit edit) override { return project_.apply(edit); }
  std::future<Status> appendLine(ScanId scan, int row, ScanLine line) override {
    std::promise<Status> promise;
    promise.set_value(project_.appendLine(scan, row, line));
    return promise.get_future();
  }

 private:
  Project& project_;
};

}  // namespace tiltmap
