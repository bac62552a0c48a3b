#include "ui/models/start_model.h"

#include <algorithm>
#include <utility>

namespace tiltmap::ui {

StartModel::StartModel(QObject* parent) : QObject(parent) {}

void StartModel::setScans(PreparedPairPtr scans, const Pose& odometry, bool keep) {
  scans_ = std::move(scans);
  odometry_ = odometry;
  forgetGhost();
  forgetSweep();
  if (!keep || !scans_) {
    point_pairs_.clear();
    Q_EMIT pointPairsChanged();
  }
  if (keep && scans_ && by_hand_)
    change(start_, true);
  else
    change(scans_ ? odometry_ : Pose(), false);
}

void StartModel::setStart(const Pose& start) {
  if (!scans_ || !start.isFinite()) return;
  change(start, true);
}

void StartModel::reset() {
  if (scans_) change(odometry_, false);
}

void StartModel::nudge(const Eigen::Vector3d& shift_m, double turn_rad) {
  const Pose turned = turn_rad == 0.0 ? start_ : turnedStart(start_, turn_rad);
  setStart(Pose(turned.quaternion(), turned.translation() + shift_m));
}

void StartModel::change(const Pose& start, bool by_hand) {
  start_ = start;
  by_hand_ = by_hand;
  Q_EMIT startChanged();
  computeGhost();
}

void StartModel::setGhostWanted(bool wanted) {
  if (wanted == ghost_wanted_) return;
  ghost_wanted_ = wanted;
  if (!wanted) forgetGhost();
  computeGhost();
}

void StartModel::forgetGhost() {
  ghost_worker_.cancel();
  ghost_running_ = ghost_stale_ = false;
  ghost_.reset();
}

void StartModel::computeGhost() {
  // While the start is dragged it changes faster than the scans can be registered: what runs is shown when it
  // comes, and the latest start is next. Cancelling for each change would show nothing before the end.
  ghost_stale_ = ghost_running_;
  if (ghost_wanted_ && scans_ && !ghost_running_) {
    ghost_running_ = true;
    ghost_worker_.start([this, scans = scans_, start = start_](const std::stop_token& stop) {
      const auto prepared = scans->get();
      auto result =
          prepared ? registerPair(prepared->fixed, prepared->moving, start, scans->settings(), {{}, stop})
                   : Result<PairResult>(fail(prepared.error()));
      return [this, result = std::move(result)] {
        ghost_running_ = false;
        if (result)
          ghost_ = *result;
        else
          Q_EMIT failed(result.error());
        if (std::exchange(ghost_stale_, false)) return computeGhost();
        Q_EMIT ghostChanged();
      };
    });
  }
  Q_EMIT ghostChanged();
}

bool StartModel::nextIsFixed() const {
  return point_pairs_.empty() || point_pairs_.back().complete() || !point_pairs_.back().fixed;
}

void StartModel::addPoint(bool of_fixed, const Eigen::Vector3d& point) {
  if (!scans_ || !point.allFinite()) return;
  if (point_pairs_.empty() || point_pairs_.back().complete()) point_pairs_.emplace_back();
  (of_fixed ? point_pairs_.back().fixed : point_pairs_.back().moving) = point;
  Q_EMIT pointPairsChanged();
}

void StartModel::removePointPair(std::size_t index) {
  if (index >= point_pairs_.size()) return;
  point_pairs_.erase(point_pairs_.begin() + static_cast<std::ptrdiff_t>(index));
  Q_EMIT pointPairsChanged();
}

void StartModel::clearPointPairs() {
  if (point_pairs_.empty()) return;
  point_pairs_.clear();
  Q_EMIT pointPairsChanged();
}

Result<PointPairFit> StartModel::pointPairFit() const {
  std::vector<Eigen::Vector3d> fixed, moving;
  for (const PointPair& pair : point_pairs_) {
    if (!pair.complete()) continue;
    fixed.push_back(*pair.fixed);
    moving.push_back(*pair.moving);
  }
  return fitPointPairs(fixed, moving);
}

bool StartModel::usePointPairs() {
  const auto fit = pointPairFit();
  if (!fit || !scans_) return false;
  setStart(fit->fixed_from_moving);
  return true;
}

void StartModel::forgetSweep() {
  sweep_worker_.cancel();
  sweep_.reset();
  Q_EMIT sweepChanged();
}

void StartModel::sweepHeadings() {
  if (!scans_) return;
  sweep_.reset();
  swept_from_ = start_;
  sweep_worker_.start([this, scans = scans_, start = start_](const std::stop_token& stop) {
    const auto prepared = scans->get();
    auto found = prepared ? tiltmap::sweepHeadings(*prepared->fixed, *prepared->moving, start,
                                                   scans->settings(), {}, {{}, stop})
                          : Result<HeadingSweep>(fail(prepared.error()));
    return [this, found = std::move(found)] {
      if (found)
        sweep_ = *found;
      else
        Q_EMIT failed(found.error());
      Q_EMIT sweepChanged();
    };
  });
  Q_EMIT sweepChanged();
}

bool StartModel::useBestHeading() {
  if (!sweep_ || !scans_) return false;
  setStart(turnedStart(swept_from_, sweep_->bestScore().turned_rad));
  return true;
}

}  // namespace tiltmap::ui
