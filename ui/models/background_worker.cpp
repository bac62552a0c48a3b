#include "ui/models/background_worker.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace tiltmap::ui {

struct BackgroundWorker::Shared {
  std::mutex mutex;
  std::condition_variable_any wanted;
  std::optional<Task> next;
  std::uint64_t generation = 0;  // of the latest start or cancel
  std::stop_source running;
  std::jthread thread;  // last: its end must find the others
};

BackgroundWorker::BackgroundWorker(QObject* parent) : QObject(parent), shared_(std::make_unique<Shared>()) {}

BackgroundWorker::~BackgroundWorker() {
  if (!shared_->thread.joinable()) return;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->next.reset();
    shared_->running.request_stop();
  }
  shared_->thread.request_stop();
  shared_->thread.join();
}

void BackgroundWorker::cancel() {
  const std::lock_guard lock(shared_->mutex);
  ++shared_->generation;
  shared_->next.reset();
  shared_->running.request_stop();
  busy_ = false;
}

void BackgroundWorker::start(Task task) {
  {
    const std::lock_guard lock(shared_->mutex);
    ++shared_->generation;
    shared_->next = std::move(task);
    shared_->running.request_stop();
    busy_ = true;
  }
  shared_->wanted.notify_one();
  if (shared_->thread.joinable()) return;
  shared_->thread = std::jthread([this](const std::stop_token& stop) {
    Shared& shared = *shared_;
    for (;;) {
      Task work;
      std::uint64_t generation = 0;
      std::stop_token token;
      {
        std::unique_lock lock(shared.mutex);
        if (!shared.wanted.wait(lock, stop, [&shared] { return shared.next.has_value(); })) return;
        work = std::move(*shared.next);
        shared.next.reset();
        generation = shared.generation;
        shared.running = std::stop_source();
        token = shared.running.get_token();
      }
      Done done = work(token);
      deliveries_.post([this, generation, done = std::move(done)] {
        {
          const std::lock_guard lock(shared_->mutex);
          if (generation != shared_->generation) return;
        }
        busy_ = false;
        if (done) done();
      });
    }
  });
}

}  // namespace tiltmap::ui
