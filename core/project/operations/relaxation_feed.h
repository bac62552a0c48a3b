// From a relaxation that runs on a worker to whoever shows it, and the pause that runs the other way.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/multiview/relaxation.h"
#include "core/project/link.h"

namespace tiltmap {

// Said before the first step, and again where the work starts over. Scans by index from here on.
struct RelaxationBeginning {
  std::string method;                 // "joint", "active-set", "sequential"
  std::vector<ScanId> scans;          // the project's, in its order
  std::vector<Pose> world_from_scan;  // the starts
  std::vector<int> pins;              // scan 0 and the pinned ones, ascending
};

// After each step.
struct RelaxationFrame {
  RelaxationStep step;
  RelaxationState state;
  std::vector<Pose> world_from_scan;
  std::vector<RelaxationLink> links;
};

// What has happened since it was asked for last.
struct RelaxationNews {
  std::optional<RelaxationBeginning> began;
  std::vector<RelaxationFrame> frames;
  std::optional<RelaxationState> now;  // the latest only: it may change a thousand times a second

  bool empty() const { return !began && frames.empty() && !now; }
};

// Any thread may call anything. One feed for one run.
class RelaxationFeed {
 public:
  // Called on the worker when there is news and none was waiting; must return quickly (post to an event
  // loop). Not called again before take().
  using Notify = std::function<void()>;
  explicit RelaxationFeed(Notify notify = {}) : notify_(std::move(notify)) {}

  // Whoever shows it.
  RelaxationNews take();
  // Takes effect at the next iteration of a registration, the next scan that is prepared or the next part of
  // a joint step, whichever comes first; what is computed does not depend on it. A stop ends the pause.
  void pause();
  void resume();
  // Goes on, and pauses again after the next whole step.
  void stepOn();
  // Pauses by itself within this step (1: the first): where a registration in it has made its first
  // iteration, else at its end. Said before the run it holds at the same place every time.
  void holdAt(int step);
  bool isPaused() const;
  // The worker has noticed the pause and waits.
  bool isWaiting() const;

  // The worker. Each returns only when there is no pause (any more) or a stop is requested.
  void began(RelaxationBeginning beginning);
  void at(const RelaxationState& state, const std::stop_token& stop);
  void stepped(RelaxationFrame frame, const std::stop_token& stop);
  void waitWhilePaused(const std::stop_token& stop);

 private:
  void notify(std::unique_lock<std::mutex>& lock);

  mutable std::mutex mutex_;
  std::condition_variable_any resumed_;
  RelaxationNews news_;
  bool told_ = false;  // that there is news
  bool paused_ = false;
  bool hold_after_step_ = false;
  int hold_at_ = 0;  // a step; 0: none
  int waiting_ = 0;  // threads that do
  Notify notify_;
};

}  // namespace tiltmap
