#include "ui/models/deliveries.h"

#include <QCoreApplication>
#include <QEvent>
#include <utility>

namespace tiltmap::ui {

void Deliveries::post(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  QCoreApplication::postEvent(this, new QEvent(QEvent::User));
}

void Deliveries::customEvent(QEvent* /*event*/) {
  std::function<void()> work;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return;
    work = std::move(waiting_.front());
    waiting_.pop_front();
  }
  work();  // may destroy this
}

}  // namespace tiltmap::ui
