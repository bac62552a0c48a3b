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
    paused_ = false;
  }
  resumed_.notify_all();
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
  notify(lock);
}

void RelaxationFeed::at(const RelaxationState& state, const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex_);
    news_.now = state;
    notify(lock);
  }
  waitWhilePaused(stop);
}

void RelaxationFeed::stepped(RelaxationFrame frame, const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex_);
    news_.now = frame.state;
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
