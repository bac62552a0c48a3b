// From a worker's thread to the window's.
#pragma once

#include <QObject>
#include <deque>
#include <functional>
#include <mutex>

namespace tiltmap::ui {

// Lives on the window's thread, and belongs to who is told: what has not arrived when it is destroyed is
// dropped. Unlike a queued call of Qt's, what is delivered changes hands under a lock of our own: the thread
// sanitizer cannot see Qt's.
class Deliveries : public QObject {
 public:
  using QObject::QObject;

  // From any thread, while this exists: runs in the window's event loop, in the order of posting.
  void post(std::function<void()> work);

 protected:
  void customEvent(QEvent* event) override;

 private:
  std::mutex mutex_;
  std::deque<std::function<void()>> waiting_;
};

}  // namespace tiltmap::ui
