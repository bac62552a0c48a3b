#include "ui/scene/point_reader.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

namespace tiltmap::ui {

struct PointReader::Shared {
  struct Outcome {
    PointsWanted wanted;
    Result<ScanPoints> points;
  };
  Read read;
  std::mutex mutex;
  std::condition_variable_any something;
  std::deque<PointsWanted> queue;
  std::multiset<std::pair<std::uint64_t, PointsKey>> under_way;  // with the project's count
  std::vector<Outcome> outcomes;
  std::uint64_t project = 0;  // counts: outcomes of an earlier one are dropped
  bool told = false;          // the window's thread knows that there are outcomes
  std::vector<std::jthread> threads;

  std::size_t underWay() const {
    return static_cast<std::size_t>(
        std::ranges::count(under_way, project, &std::pair<std::uint64_t, PointsKey>::first));
  }
  static Result<ScanPoints> readWhole(const Read& read, const PointsWanted& wanted,
                                      const std::stop_token& stop) {
    try {
      return read(wanted, stop);
    } catch (const std::bad_alloc&) {
      return fail("there is not enough memory for its points", wanted.scan.name,
                  "close other programs, or show reduced points");
    }
  }
};

PointReader::PointReader(QObject* parent, Read read, int threads)
    : QObject(parent),
      shared_(std::make_shared<Shared>()),
      threads_(threads > 0 ? threads
                           : static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 8U))) {
  shared_->read = std::move(read);
}

PointReader::~PointReader() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->queue.clear();
  }
  for (std::jthread& thread : shared_->threads) thread.request_stop();
  shared_->threads.clear();
}

void PointReader::setRead(Read read) {
  const std::lock_guard lock(shared_->mutex);
  shared_->read = std::move(read);
}

void PointReader::startThreads() {
  if (!shared_->threads.empty()) return;
  for (int k = 0; k < threads_; ++k)
    shared_->threads.emplace_back([this, &shared = *shared_](const std::stop_token& stop) {
      for (;;) {
        std::uint64_t project = 0;
        PointsWanted wanted;
        Read read;
        {
          std::unique_lock lock(shared.mutex);
          if (!shared.something.wait(lock, stop, [&shared] { return !shared.queue.empty(); })) return;
          wanted = std::move(shared.queue.front());
          shared.queue.pop_front();
          project = shared.project;
          read = shared.read;
          shared.under_way.emplace(project, keyOf(wanted));
        }
        Result<ScanPoints> points = Shared::readWhole(read, wanted, stop);
        const std::lock_guard lock(shared.mutex);
        shared.under_way.erase(shared.under_way.find({project, keyOf(wanted)}));
        if (project != shared.project || stop.stop_requested()) continue;
        shared.outcomes.push_back({std::move(wanted), std::move(points)});
        if (std::exchange(shared.told, true)) continue;
        QMetaObject::invokeMethod(
            this, [this] { collect(); }, Qt::QueuedConnection);
      }
    });
}

void PointReader::want(const std::vector<PointsWanted>& scans) {
  std::size_t left = 0;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->queue.clear();
    std::set<PointsKey> coming;
    for (const auto& [project, key] : shared_->under_way)
      if (project == shared_->project) coming.insert(key);
    for (const Shared::Outcome& outcome : shared_->outcomes) coming.insert(keyOf(outcome.wanted));
    for (const auto* scans_here : {&waiting_, &ready_})
      for (const ScanPoints& points : *scans_here) coming.insert(keyOf(points));
    for (const PointsWanted& scan : scans)
      if (!unreadable_.contains(keyOf(scan)) && coming.insert(keyOf(scan)).second)
        shared_->queue.push_back(scan);
    left = shared_->queue.size() + shared_->underWay() + shared_->outcomes.size();
  }
  if (!isReading()) done_ = total_ = 0;
  total_ = done_ + static_cast<int>(left);
  if (left > 0) startThreads();
  if (left == 0 && !waiting_.empty())  // what was to come with others
    QMetaObject::invokeMethod(
        this, [this] { collect(); }, Qt::QueuedConnection);
  shared_->something.notify_all();
  Q_EMIT progressed();
}

void PointReader::forget() {
  {
    const std::lock_guard lock(shared_->mutex);
    ++shared_->project;
    shared_->queue.clear();
    shared_->outcomes.clear();
  }
  waiting_.clear();
  ready_.clear();
  unreadable_.clear();
  handed_over_ = 0;
  done_ = total_ = 0;
  Q_EMIT progressed();
}

std::vector<ScanPoints> PointReader::take() {
  return std::exchange(ready_, {});
}

void PointReader::collect() {
  std::vector<Shared::Outcome> outcomes;
  bool more = false;
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->told = false;
    outcomes.swap(shared_->outcomes);
    more = !shared_->queue.empty() || shared_->underWay() > 0;
  }
  if (outcomes.empty() && waiting_.empty()) return;
  std::vector<Trouble> troubles;
  for (Shared::Outcome& outcome : outcomes) {
    done_ = std::min(done_ + 1, total_);
    if (outcome.points) {
      waiting_.push_back(std::move(*outcome.points));
    } else if (unreadable_.insert(keyOf(outcome.wanted)).second) {
      troubles.push_back({outcome.wanted.scan.name, outcome.points.error()});
    }
  }
  if (!more) done_ = total_;
  std::size_t points = 0;
  for (const ScanPoints& scan : waiting_) points += scan.size();
  if (!waiting_.empty() && (!more || 2 * points >= handed_over_)) {
    handed_over_ += points;
    std::ranges::move(waiting_, std::back_inserter(ready_));
    waiting_.clear();
    Q_EMIT arrived();
  }
  for (const Trouble& trouble : troubles) Q_EMIT failed(trouble);
  Q_EMIT progressed();
}

}  // namespace tiltmap::ui
