// What the three methods of relaxation have in common, for Relaxation alone.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "core/multiview/relaxation.h"
#include "core/registration/registration.h"

namespace tiltmap {

class RelaxationEngine {
 public:
  RelaxationEngine(RelaxationInput input, const RelaxationSettings& settings, int threads);
  virtual ~RelaxationEngine() = default;
  virtual std::unique_ptr<RelaxationEngine> clone() const = 0;
  // One step; appends events and ends with Finished and finished_ set. Poses change only when it returns.
  virtual void step(RelaxationStep& report, const std::stop_token& stop) = 0;
  virtual std::vector<int> unlinked() const = 0;
  virtual std::vector<RelaxationLink> links() const = 0;
  // Without the step's number, which the engine does not know.
  virtual RelaxationState state() const = 0;
  // Must outlive the steps it watches; null: nobody does.
  void watchWith(const RelaxationWatcher* watcher, int step) { watcher_ = watcher, watched_step_ = step; }

  bool done() const { return finished_ || cancelled_; }
  bool cancelled() const { return cancelled_; }
  const std::vector<Pose>& poses() const { return poses_; }
  const std::vector<Pose>& startPoses() const { return input_.world_from_scan; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  RelaxationEngine(const RelaxationEngine&) = default;
  RelaxationEngine& operator=(const RelaxationEngine&) = delete;

  int count() const { return static_cast<int>(poses_.size()); }
  const PreparedScan& scan(int i) const { return *input_.scans[static_cast<std::size_t>(i)]; }
  const PreparedScanPtr& scanPtr(int i) const { return input_.scans[static_cast<std::size_t>(i)]; }
  const Pose& pose(int i) const { return poses_[static_cast<std::size_t>(i)]; }
  bool isPinned(int i) const { return pinned_[static_cast<std::size_t>(i)]; }
  bool isSettled(int i) const {
    return !input_.settled.empty() && input_.settled[static_cast<std::size_t>(i)];
  }
  bool isExcluded(int a, int b) const {
    return (isSettled(a) && isSettled(b)) || excluded_.contains(std::minmax(a, b));
  }
  bool isWatched() const { return watcher_ && *watcher_; }
  void tell(RelaxationState state) const;
  // state() with what is done now.
  void tellDoing(const std::string& doing) const;
  // For alignToMetascan: tells `now` with what the registration is at. Empty where nobody watches.
  std::function<void(const Registration&)> tellIterations(RelaxationState now, int scan,
                                                          const std::vector<int>& onto) const;
  void finish(RelaxationStep& report);
  void cancel(RelaxationStep& report);

  RelaxationInput input_;
  RelaxationSettings settings_;
  int threads_ = 0;
  std::vector<Pose> poses_;
  std::vector<char> pinned_;
  std::set<std::pair<int, int>> excluded_;  // lower first
  std::vector<std::string> warnings_;
  bool finished_ = false, cancelled_ = false;

 private:
  const RelaxationWatcher* watcher_ = nullptr;
  int watched_step_ = 0;
};

std::string namesOf(const std::vector<int>& scans);  // "2, 4"

std::unique_ptr<RelaxationEngine> makeJointRelaxation(RelaxationInput input,
                                                      const RelaxationSettings& settings, int threads);
std::unique_ptr<RelaxationEngine> makeActiveSetRelaxation(RelaxationInput input,
                                                          const RelaxationSettings& settings, int threads);
std::unique_ptr<RelaxationEngine> makeSequentialRelaxation(RelaxationInput input,
                                                           const RelaxationSettings& settings, int threads);

}  // namespace tiltmap
