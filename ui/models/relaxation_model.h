// The relaxations of a window: what the one that runs is at, what it found, and the decision about it.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <memory>
#include <mutex>
#include <vector>

#include "core/project/operations/relaxation_feed.h"
#include "ui/models/deliveries.h"
#include "ui/models/job_queue.h"
#include "ui/models/scan_display.h"

namespace tiltmap::ui {

class ProjectSession;

QString relaxationRoleName(RelaxationRole role);  // "never moves", "active", "waiting", ...
QString relaxationRoleTip(RelaxationRole role);

// One step, as plots show it.
struct RelaxationRecord {
  int step = 0;
  double rms_m = 0.0;           // 0: not known at this step
  std::vector<double> moved_m;  // from the start, by index
};

// Lives on the window's thread, and outlives panels: a relaxation goes on whatever is shown. The worker is
// heard through a feed; nothing here is touched by another thread.
class RelaxationModel : public QObject {
  Q_OBJECT

 public:
  RelaxationModel(ProjectSession& session, JobQueue& jobs, ScanDisplay& display, QObject* parent = nullptr);
  ~RelaxationModel() override;

  // The same request, for a relaxation one whose run is watched; started() then says which job it became.
  JobRequest watched(JobRequest request);
  void started(int job, const JobRequest& request);

  // The latest one that began or was started; nothing before the first of this project.
  const JobStatus* job() const;
  bool isRunning() const;   // begun or preparing, paused or not
  bool isPaused() const;    // asked to; what is being computed may still end an iteration
  bool isHolding() const;   // paused and at rest
  bool isProposal() const;  // its result waits to be accepted
  void pause();
  void resume();
  void cancel();
  void accept();
  void discard();
  // Of a proposal: where the scans were, or where they would be.
  void showBefore(bool before);
  bool showsBefore() const { return before_shown_; }
  // Both at once, in the 3D view.
  void compareInView(ProposalCompare how);
  // Paused: to the end of one step more, and paused again.
  void stepOn();
  // Those that are started from now on pause by themselves within this step (1: the first), where a
  // registration in it has made its first iteration, else at its end. 0: they do not.
  void holdNextAt(int step) { hold_at_ = step; }

  QString method() const { return method_; }
  QString doing() const;  // "aligning scan 3 with 2, 4: iteration 5, 812 pairs, rms 12.1 mm"
  int step() const { return static_cast<int>(records_.size()); }
  const std::vector<ScanId>& scans() const { return scans_; }
  const std::vector<Pose>& startPoses() const { return start_; }
  const std::vector<Pose>& poses() const { return poses_; }  // by index; where it stands
  RelaxationRole role(int index) const;
  const std::vector<RelaxationRecord>& records() const { return records_; }
  const std::vector<RelaxationLink>& links() const { return links_; }
  const RelaxationState& state() const { return state_; }
  const QStringList& log() const { return log_; }

 Q_SIGNALS:
  void reset();    // another one: everything is new
  void changed();  // several times a second at most while it runs
  void logged(const QString& line);

 private:
  struct Run {
    std::shared_ptr<RelaxationFeed> feed;
    std::shared_ptr<Operation> operation;
    int job = 0;
  };
  // Between the worker and this object, which may go first.
  struct Mailbox {
    std::mutex mutex;
    RelaxationModel* model = nullptr;
  };

  Run* runOf(int job);
  Run* currentRun();
  const Run* currentRun() const;
  void readNews();
  void begin(int job, const RelaxationBeginning& beginning);
  void take(const RelaxationFrame& frame);
  void write(const QString& line);
  void jobChanged(int id);
  void showRoles();
  void showPoses();
  void forget();

  Deliveries deliveries_;  // from the jobs
  ProjectSession& session_;
  JobQueue& jobs_;
  ScanDisplay& display_;
  std::shared_ptr<Mailbox> mailbox_ = std::make_shared<Mailbox>();
  std::vector<Run> runs_;
  QTimer soon_;          // joins what comes quickly
  QElapsedTimer shown_;  // since poses were shown last; drawing them may take long
  qint64 wait_ms_ = 0;   // until they are shown again

  int job_ = 0;
  QString method_;
  std::vector<ScanId> scans_;
  std::vector<Pose> start_, poses_;
  std::vector<int> pins_;
  RelaxationState state_;
  std::vector<RelaxationRecord> records_;
  std::vector<RelaxationLink> links_;
  QStringList log_;
  bool before_shown_ = false;
  bool held_ = false;  // as it was told last
  int hold_at_ = 0;
};

}  // namespace tiltmap::ui
