// One piece of work at a time, off the window's thread; the latest wanted is the one that counts.
#pragma once

#include <QObject>
#include <functional>
#include <memory>
#include <stop_token>

#include "ui/models/deliveries.h"

namespace tiltmap::ui {

// Lives on the window's thread. The destructor asks what runs to stop, and waits for it.
class BackgroundWorker : public QObject {
  Q_OBJECT

 public:
  // Runs on the window's thread when the work is done, unless something newer was wanted meanwhile.
  using Done = std::function<void()>;
  // Runs on the worker's thread; should look at the token where it may take long. May return nothing.
  using Task = std::function<Done(const std::stop_token&)>;

  explicit BackgroundWorker(QObject* parent = nullptr);
  ~BackgroundWorker() override;

  // Takes the place of what waits, and asks what runs to stop: its end is not told.
  void start(Task task);
  // Nothing is wanted any more.
  void cancel();
  // Something was started whose end has not been told.
  bool busy() const { return busy_; }

 private:
  struct Shared;
  Deliveries deliveries_;  // from the worker
  std::unique_ptr<Shared> shared_;
  bool busy_ = false;
};

}  // namespace tiltmap::ui
