// An operation that a test holds in its hand: it goes on when it is told to.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

#include "core/project/operation.h"

namespace tiltmap::test {

// Renames the first scan when it is let go; ends early when cancelled.
class HeldOperation : public Operation {
 public:
  explicit HeldOperation(std::string new_name = "renamed") : new_name_(std::move(new_name)) {}

  std::string id() const override { return "held"; }
  std::string title() const override { return "Held work"; }
  std::string help() const override { return "Waits until it is let go."; }
  const std::vector<ParameterInfo>& parameters() const override { return infos_; }
  std::vector<ParameterPreset> presets() const override { return {{"default", ""}}; }
  Result<ParameterValues> presetValues(const std::string&) const override { return ParameterValues(); }
  Status check(const ProjectSnapshot& snapshot, const ParameterValues&) const override {
    if (snapshot.scans().empty()) return fail("there is no scan", "", "import one");
    return {};
  }
  Result<OperationResult> run(const SnapshotPtr& snapshot, const ParameterValues&,
                              const JobControl& control) const override {
    ++runs;
    control.tell(0.5, "half way");
    while (!released && (deaf || !control.stopRequested()))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!deaf && control.stopRequested()) return fail(kCancelled, "", "");
    if (broken) return fail("the work failed", "here", "try another way");
    OperationResult result;
    result.edit = renameEdit(snapshot->scans().front().id, new_name_);
    result.warnings = warnings;
    return result;
  }

  std::atomic<bool> released = false;
  bool broken = false;
  bool deaf = false;  // to cancelling
  std::vector<std::string> warnings;
  mutable std::atomic<int> runs = 0;

 private:
  std::string new_name_;
  std::vector<ParameterInfo> infos_;
};

}  // namespace tiltmap::test
