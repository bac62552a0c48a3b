// The scan that is being captured against the map: where it belongs while it comes, and the light at its end.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <memory>
#include <optional>

#include "core/geometry/pose.h"
#include "core/project/project_snapshot.h"
#include "ui/models/background_worker.h"

namespace tiltmap::ui {

class ProjectSession;

// What an operator is told when a stop has been captured.
enum class CaptureLight { MoveOn, Rescan, Closer };
QString captureLightName(CaptureLight light);  // "Move on", "Rescan", "Closer"

// Registers on a thread of its own, one thing at a time; what is shown is the latest that was finished. Lives
// on the window's thread.
class CaptureVerdict : public QObject {
  Q_OBJECT

 public:
  explicit CaptureVerdict(const ProjectSession& session, QObject* parent = nullptr);

  struct Estimate {
    bool sure = false;    // held by the lines so far
    bool placed = false;  // world_from_scan is by registration, not the odometry
    Pose world_from_scan;
    double overlap = 0.0;  // 0 to 1
    int lines = 0;
    QString sentence;
    double milliseconds = 0.0;  // of computing
  };
  struct Judgement {
    CaptureLight light = CaptureLight::Rescan;
    QString reason, weak_directions;
    QString figures;  // of the stop it is placed by, as links are judged; a line each
    double overlap = 0.0;
    bool placed = false;
    Pose world_from_scan;
    double after_last_line_s = 0.0;  // until it was told
  };

  // A sweep of this scan begins; what was known of another is forgotten.
  void begin(ScanId scan);
  // More lines of it are in the project.
  void linesCame(int so_far);
  // All of them are.
  void complete();
  void forget();

  std::optional<ScanId> scan() const { return scan_; }
  bool isJudging() const { return completed_ && !judgement_; }
  const std::optional<Estimate>& estimate() const { return estimate_; }
  const std::optional<Judgement>& judgement() const { return judgement_; }

 Q_SIGNALS:
  void changed();

 private:
  struct Work;
  void startNext();

  const ProjectSession& session_;
  std::optional<ScanId> scan_;
  int lines_ = 0, tried_ = 0;  // that came; that were registered last
  bool completed_ = false, judging_ = false;
  QElapsedTimer since_last_line_;
  std::optional<Estimate> estimate_;
  std::optional<Judgement> judgement_;
  std::shared_ptr<Work> work_;  // of the worker while it is busy
  BackgroundWorker worker_;     // last: what runs ends before the rest goes
};

}  // namespace tiltmap::ui
