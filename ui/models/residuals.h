// The residuals of a project's scans, computed in the background when somebody asks to see them.
#pragma once

#include <QObject>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/project_snapshot.h"
#include "ui/models/deliveries.h"

namespace tiltmap::ui {

class ProjectSession;

using ResidualsPtr = std::shared_ptr<const std::vector<float>>;

// Lives on the window's thread; one worker at a time computes what was asked for last.
class Residuals : public QObject {
  Q_OBJECT

 public:
  explicit Residuals(const ProjectSession& session, QObject* parent = nullptr);
  ~Residuals() override;

  // One a cell, NaN where nothing overlaps; nothing while they are being computed, which begins now
  // (changed() tells when there is more), and where they cannot be: see trouble().
  ResidualsPtr of(ScanId scan, Stage stage);
  // Of all scans that have some by now; those that have none are begun.
  std::map<ScanId, ResidualsPtr> ofAll(Stage stage);
  std::string trouble(ScanId scan, Stage stage);

  bool isComputing() const { return worker_ != nullptr; }
  int wanted() const;  // scans that are still to come

 Q_SIGNALS:
  void changed();
  void computingChanged();

 private:
  struct Key {
    ScanId scan = 0;
    std::uint64_t fingerprint = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Task {
    Stage stage = Stage::Odometry;
    Key key;
    bool operator==(const Task&) const = default;
  };
  struct Worker;
  void stop();
  std::optional<Key> keyOf(ScanId scan, Stage stage);
  void begin(const Task& task);
  void startWorker();
  void take(const Worker* from, const Task& task, const ResidualsPtr& values, const std::string& trouble);
  void conclude(const Worker* from);

  Deliveries deliveries_;  // from the worker
  const ProjectSession& session_;
  std::map<Stage, std::map<ScanId, std::uint64_t>> fingerprints_;  // of the snapshot that is shown
  std::map<Key, ResidualsPtr> known_;
  std::map<Key, std::string> troubles_;
  std::vector<Task> queue_;
  std::shared_ptr<Worker> worker_;
};

}  // namespace tiltmap::ui
