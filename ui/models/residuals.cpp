#include "ui/models/residuals.h"

#include <QTimer>
#include <algorithm>
#include <thread>

#include "core/products/residuals.h"
#include "ui/models/project_session.h"

namespace tiltmap::ui {

namespace {

// Several stages and some undone edits may be looked at in turn without computing anew; more is let go.
constexpr std::size_t kCellsKept = 60'000'000;

}  // namespace

struct Residuals::Worker {
  std::vector<Task> work;
  std::jthread thread;  // the last: joined first
};

Residuals::Residuals(const ProjectSession& session, QObject* parent) : QObject(parent), session_(session) {
  connect(&session, &ProjectSession::closed, this, [this] {
    stop();
    known_.clear();
    troubles_.clear();
  });
  connect(&session, &ProjectSession::snapshotReplaced, this, [this] {
    // Whoever shows residuals asks again; what stayed the same is found by its fingerprint.
    stop();
    Q_EMIT changed();
  });
}

Residuals::~Residuals() {
  if (worker_) worker_->thread.request_stop();
}

void Residuals::stop() {
  const bool was = isComputing();
  if (worker_) worker_->thread.request_stop();
  worker_ = nullptr;  // waits, some milliseconds
  queue_.clear();
  fingerprints_.clear();
  if (was) Q_EMIT computingChanged();
}

std::optional<Residuals::Key> Residuals::keyOf(ScanId scan, Stage stage) {
  auto& fingerprints = fingerprints_[stage];
  const SnapshotPtr snapshot = session_.snapshot();
  if (fingerprints.empty() && snapshot) {
    const std::vector<Pose> poses = snapshot->filledPoses(stage);
    for (std::size_t i = 0; i < poses.size(); ++i)
      fingerprints[snapshot->scans()[i].id] = ProjectResiduals::fingerprint(*snapshot, poses, i);
  }
  const auto found = fingerprints.find(scan);
  if (found == fingerprints.end()) return {};
  return Key{scan, found->second};
}

ResidualsPtr Residuals::of(ScanId scan, Stage stage) {
  const auto key = keyOf(scan, stage);
  if (!key) return nullptr;
  const auto found = known_.find(*key);
  if (found != known_.end()) return found->second;
  if (!troubles_.contains(*key)) begin({stage, *key});
  return nullptr;
}

std::map<ScanId, ResidualsPtr> Residuals::ofAll(Stage stage) {
  std::map<ScanId, ResidualsPtr> result;
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot) return result;
  for (const ScanEntry& scan : snapshot->scans())
    if (auto values = of(scan.id, stage)) result[scan.id] = std::move(values);
  return result;
}

std::string Residuals::trouble(ScanId scan, Stage stage) {
  const auto key = keyOf(scan, stage);
  const auto found = key ? troubles_.find(*key) : troubles_.end();
  return found == troubles_.end() ? std::string() : found->second;
}

int Residuals::wanted() const {
  return static_cast<int>(queue_.size());
}

void Residuals::begin(const Task& task) {
  if (std::ranges::find(queue_, task) != queue_.end()) return;
  queue_.push_back(task);
  // All that are asked for in this turn of the event loop go to one worker.
  if (!worker_ && queue_.size() == 1) QTimer::singleShot(0, this, &Residuals::startWorker);
}

void Residuals::startWorker() {
  const SnapshotPtr snapshot = session_.snapshot();
  if (worker_ || queue_.empty() || !snapshot) return;
  worker_ = std::make_shared<Worker>();
  worker_->work = queue_;
  std::ranges::stable_sort(worker_->work, {}, &Task::stage);
  // The thread ends before its worker does, so that a plain pointer serves as the worker's name.
  Worker* worker = worker_.get();
  worker_->thread = std::jthread([this, worker, snapshot](std::stop_token stop_token) {
    std::optional<ProjectResiduals> residuals;
    std::optional<Stage> stage;
    for (const Task& task : worker->work) {
      const auto index = snapshot->indexOf(task.key.scan);
      if (stop_token.stop_requested() || !index) break;
      // One thread: the window wants the other cores.
      if (stage != task.stage) residuals.emplace(snapshot, task.stage, ResidualSettings(), 1);
      stage = task.stage;
      auto values = residuals->of(*index, {{}, stop_token});
      if (!values && stop_token.stop_requested()) break;
      ResidualsPtr kept = values ? std::make_shared<const std::vector<float>>(std::move(*values)) : nullptr;
      std::string trouble = values ? std::string() : values.error().what;
      deliveries_.post([=, this] { take(worker, task, kept, trouble); });
    }
    deliveries_.post([=, this] { conclude(worker); });
  });
  Q_EMIT computingChanged();
}

void Residuals::take(const Worker* from, const Task& task, const ResidualsPtr& values,
                     const std::string& trouble) {
  if (from != worker_.get()) return;
  std::erase(queue_, task);
  if (values)
    known_[task.key] = values;
  else
    troubles_[task.key] = trouble;
  std::size_t cells = 0;
  for (const auto& [key, kept] : known_) cells += kept->size();
  if (cells > kCellsKept)
    std::erase_if(known_, [&](const auto& entry) {
      return std::ranges::none_of(fingerprints_, [&](const auto& stage) {
        const auto now = stage.second.find(entry.first.scan);
        return now != stage.second.end() && now->second == entry.first.fingerprint;
      });
    });
  Q_EMIT changed();
}

void Residuals::conclude(const Worker* from) {
  if (from != worker_.get()) return;
  worker_ = nullptr;
  if (!queue_.empty())
    startWorker();  // asked for in the meantime
  else
    Q_EMIT computingChanged();
}

}  // namespace tiltmap::ui
