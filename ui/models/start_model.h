// Where a registration starts: the odometry, or what a person set by hand.
#pragma once

#include <QObject>
#include <optional>
#include <vector>

#include "core/registration/manual_start.h"
#include "core/registration/register_pair.h"
#include "ui/models/background_worker.h"
#include "ui/models/prepared_pair.h"

namespace tiltmap::ui {

// The start of one pair of scans, and the helps to find it. No widgets. Poses are fixed_from_moving.
class StartModel : public QObject {
  Q_OBJECT

 public:
  // A place in both scans, in their own frames; one side may still be missing.
  struct PointPair {
    std::optional<Eigen::Vector3d> fixed, moving;
    bool complete() const { return fixed && moving; }
  };

  explicit StartModel(QObject* parent = nullptr);

  // Another pair of scans, or other settings for the same: what was computed for the old one goes. Without
  // one everything is empty. `keep`: the start and the picked points stay.
  void setScans(PreparedPairPtr scans, const Pose& odometry, bool keep);
  bool hasScans() const { return scans_ != nullptr; }

  const Pose& start() const { return start_; }
  bool byHand() const { return by_hand_; }
  void setStart(const Pose& start);
  void reset();  // to the odometry
  // Shift along the fixed scan's axes, metres; turn of the moving scan on the spot, radians, left positive.
  void nudge(const Eigen::Vector3d& shift_m, double turn_rad);

  // Where registering would end from here, computed anew after every change of the start. While that is busy
  // it is the one of a start a moment ago.
  bool ghostWanted() const { return ghost_wanted_; }
  void setGhostWanted(bool wanted);
  const std::optional<PairResult>& ghost() const { return ghost_; }
  bool ghostBusy() const { return ghost_running_; }

  // Points picked in both scans, three pairs or more.
  const std::vector<PointPair>& pointPairs() const { return point_pairs_; }
  // The side that the next point is expected of: the other one of a pair that lacks it, else the fixed.
  bool nextIsFixed() const;
  // Completes the last pair or begins one. A second point of the same side replaces the first.
  void addPoint(bool of_fixed, const Eigen::Vector3d& point);
  void removePointPair(std::size_t index);
  void clearPointPairs();
  // From the complete pairs; an Error that says what is missing.
  Result<PointPairFit> pointPairFit() const;
  bool usePointPairs();

  void sweepHeadings();
  const std::optional<HeadingSweep>& sweep() const { return sweep_; }
  bool sweepBusy() const { return sweep_worker_.busy(); }
  bool useBestHeading();

 Q_SIGNALS:
  void startChanged();
  void ghostChanged();
  void pointPairsChanged();
  void sweepChanged();
  void failed(const tiltmap::Error& error);

 private:
  void change(const Pose& start, bool by_hand);
  void computeGhost();
  void forgetGhost();
  void forgetSweep();

  PreparedPairPtr scans_;
  Pose odometry_, start_;
  bool by_hand_ = false;
  bool ghost_wanted_ = false, ghost_running_ = false;
  bool ghost_stale_ = false;  // the start has changed since the one that runs
  std::optional<PairResult> ghost_;
  std::vector<PointPair> point_pairs_;
  std::optional<HeadingSweep> sweep_;
  Pose swept_from_;
  BackgroundWorker ghost_worker_, sweep_worker_;
};

}  // namespace tiltmap::ui
