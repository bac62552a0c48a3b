#include "core/project/operations/relaxation_feed.h"

#include <utility>

namespace tiltmap {

RelaxationNews RelaxationFeed::take() {
  const std::lock_guard lock(mutex_);
  told_ = false;
  return std::exchange(news_, {});
}

void RelaxationFeed::pause() {
  const std::lock_guard lock(mutex_);
  paused_ = true;
}

void RelaxationFeed::resume() {
  {
    const std::lock_guard lock(mutex_);
    paused_ = hold_after_step_ = false;
    hold_at_ = 0;
  }
  resumed_.notify_all();
}

void RelaxationFeed::stepOn() {
  {
    const std::lock_guard lock(mutex_);
    paused_ = false;
    hold_after_step_ = true;
    hold_at_ = 0;
  }
  resumed_.notify_all();
}

void RelaxationFeed::holdAt(int step) {
  const std::lock_guard lock(mutex_);
  hold_at_ = step;
}

bool RelaxationFeed::isPaused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

bool RelaxationFeed::isWaiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_ > 0;
}

// Outside the lock: the notified thread may ask for the news at once.
void RelaxationFeed::notify(std::unique_lock<std::mutex>& lock) {
  const bool first = !std::exchange(told_, true);
  lock.unlock();
  if (first && notify_) notify_();
}

void RelaxationFeed::began(RelaxationBeginning beginning) {
  std::unique_lock lock(mutex_);
  news_.began = std::move(beginning);
  news_.frames.clear();  // of an earlier start
  notify(lock);
}

void RelaxationFeed::at(const RelaxationState& state, const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex_);
    news_.now = state;
    if (hold_at_ > 0 && state.step >= hold_at_ && state.iteration > 0) {
      paused_ = true;
      hold_at_ = 0;
    }
    notify(lock);
  }
  waitWhilePaused(stop);
}

void RelaxationFeed::stepped(RelaxationFrame frame, const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex_);
    news_.now = frame.state;
    if (hold_after_step_ || (hold_at_ > 0 && frame.step.number >= hold_at_)) {
      paused_ = true;
      hold_after_step_ = false;
      hold_at_ = 0;
    }
    news_.frames.push_back(std::move(frame));
    notify(lock);
  }
  waitWhilePaused(stop);
}

void RelaxationFeed::waitWhilePaused(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (!paused_ || stop.stop_requested()) return;
  ++waiting_;
  notify(lock);  // that it waits now is news
  lock.lock();
  resumed_.wait(lock, stop, [this] { return !paused_; });
  --waiting_;
  notify(lock);
}

}  // namespace tiltmap
