// The thesis' relaxation: figure 6.1 with the registration's own components as its ICP.
#include <map>

#include "core/base/parallel.h"
#include "core/multiview/active_set.h"
#include "core/multiview/metascan.h"
#include "core/multiview/relaxation_engine.h"
#include "core/registration/registration.h"

namespace tiltmap {

namespace {

std::size_t countWithin(const SurfaceElements& from, const KdTree& to, const Pose& to_from_from,
                        double distance_m) {
  const Eigen::Matrix3d rotation = to_from_from.rotation();
  const Eigen::Vector3d shift = to_from_from.translation();
  std::size_t count = 0;
  KdTree::Neighbour found;
  for (const Eigen::Vector3d& p : from.position)
    if (to.nearestWithin(rotation * p + shift, distance_m, found)) ++count;
  return count;
}

class ActiveSetRelaxation : public RelaxationEngine {
 public:
  ActiveSetRelaxation(RelaxationInput input, const RelaxationSettings& settings, int threads)
      : RelaxationEngine(std::move(input), settings, threads), order_(pinned_, settings) {}

  std::unique_ptr<RelaxationEngine> clone() const override {
    return std::unique_ptr<RelaxationEngine>(new ActiveSetRelaxation(*this));
  }

  void step(RelaxationStep& report, const std::stop_token& stop) override {
    const std::vector<Pose> before = poses_;
    const ActiveSet order_before = order_;
    if (counts_.empty()) buildTrees();
    tellDoing("counting neighbours");
    recount(stop);
    const ActiveSetActions actions{[this](int a, int b) { return areNeighbours(a, b); },
                                   [&](int scan, const std::vector<int>& members, RelaxationStep& events) {
                                     return align(scan, members, events, stop);
                                   }};
    if (!stop.stop_requested()) order_.step(actions, report);
    if (stop.stop_requested()) {
      poses_ = before;
      order_ = order_before;
      report.events.clear();
      cancel(report);
      return;
    }
    report.fraction = static_cast<double>(order_.active().size()) / static_cast<double>(count());
    if (order_.done()) end(report);
  }

  std::vector<int> unlinked() const override { return order_.unlinked(); }

  RelaxationState state() const override {
    RelaxationState now;
    now.active = order_.active();
    now.waiting = order_.waiting();
    now.queue.assign(order_.queue().begin(), order_.queue().end());
    return now;
  }

  std::vector<RelaxationLink> links() const override {
    std::vector<RelaxationLink> list;
    for (const auto& [key, found] : counts_) {
      if (found.pairs <= static_cast<std::size_t>(settings_.neighbour_pairs)) continue;
      RelaxationLink link;
      link.fixed = key.first;
      link.moving = key.second;
      link.fixed_from_moving = pose(key.first).inverse() * pose(key.second);
      link.pairs = found.pairs;
      const std::size_t larger = std::max(scan(key.first).elements.size(), scan(key.second).elements.size());
      link.overlap = larger > 0 ? static_cast<double>(found.pairs) / static_cast<double>(larger) : 0.0;
      list.push_back(link);
    }
    return list;
  }

 private:
  struct Count {
    Pose first_from_second;  // where it was counted
    std::size_t pairs = 0;
    bool valid = false;
  };

  bool areNeighbours(int a, int b) const {
    const auto found = counts_.find({std::min(a, b), std::max(a, b)});
    return !isExcluded(a, b) && found != counts_.end() && found->second.valid &&
           found->second.pairs > static_cast<std::size_t>(settings_.neighbour_pairs);
  }

  // The pair choice may want no tree, or another search; neighbours are counted by distance alone.
  void buildTrees() {
    trees_.resize(static_cast<std::size_t>(count()));
    parallelFor(trees_.size(), threads_, [&](std::size_t i) {
      const SurfaceElements& elements = input_.scans[i]->elements;
      if (!elements.empty()) trees_[i] = std::make_shared<const KdTree>(elements.position);
    });
    for (int a = 0; a < count(); ++a)
      for (int b = a + 1; b < count(); ++b) counts_[{a, b}];
  }

  // Counts again where a pair of scans has moved against each other since.
  void recount(const std::stop_token& stop) {
    std::vector<std::pair<const std::pair<int, int>, Count>*> changed;
    for (auto& entry : counts_) {
      const Pose relative = pose(entry.first.first).inverse() * pose(entry.first.second);
      const PoseDifference moved = difference(relative, entry.second.first_from_second);
      if (!entry.second.valid || moved.translation_m > kCountedAnew_m ||
          moved.rotation_rad > kCountedAnew_rad)
        changed.push_back(&entry);
    }
    parallelFor(changed.size(), threads_, [&](std::size_t k) {
      if (stop.stop_requested()) return;
      const auto [a, b] = changed[k]->first;
      Count& found = changed[k]->second;
      const auto first = static_cast<std::size_t>(a), second = static_cast<std::size_t>(b);
      found.first_from_second = poses_[first].inverse() * poses_[second];
      found.valid = true;
      found.pairs = 0;
      if (!trees_[first] || !trees_[second]) return;
      // Symmetric: the smaller number of the two ways round.
      found.pairs = std::min(countWithin(scan(b).elements, *trees_[first], found.first_from_second,
                                         settings_.neighbour_distance_m),
                             countWithin(scan(a).elements, *trees_[second], found.first_from_second.inverse(),
                                         settings_.neighbour_distance_m));
    });
  }

  PoseDifference align(int scan, const std::vector<int>& members, RelaxationStep& report,
                       const std::stop_token& stop) {
    const auto index = static_cast<std::size_t>(scan);
    RelaxationState now;
    if (isWatched()) now = state();
    const MetascanAlignment found =
        alignToMetascan(input_.scans, poses_, members, scan, poses_[index], settings_.registration, stop,
                        tellIterations(std::move(now), scan, members));
    RelaxationEvent event;
    event.kind = RelaxationEventKind::Aligned;
    event.scan = scan;
    event.pairs = found.pairs;
    event.rms_m = found.rms_m;
    event.text = stopReasonName(found.reason);
    report.events.push_back(event);
    if (!isSuccess(found.reason) && found.reason != StopReason::Cancelled)
      warnings_.push_back("scan " + std::to_string(scan) + " could not be aligned with its neighbours (" +
                          stopReasonName(found.reason) + ") and stayed where it was");
    poses_[index] = found.world_from_scan;
    return found.moved;
  }

  void end(RelaxationStep& report) {
    for (const int scan : order_.unlinked())
      warnings_.push_back("scan " + std::to_string(scan) + " has no neighbour (more than " +
                          std::to_string(settings_.neighbour_pairs) +
                          " pairs of points close together) and keeps its pose");
    for (const int scan : order_.bounded())
      warnings_.push_back("scan " + std::to_string(scan) + " was visited " +
                          std::to_string(settings_.max_visits) +
                          " times and was still to be aligned again: the poses may not have settled");
    report.fraction = 1.0;
    finish(report);
  }

  // Smaller motions change no count worth looking at.
  static constexpr double kCountedAnew_m = 0.01;
  static constexpr double kCountedAnew_rad = 0.05 * kDegree;
  ActiveSet order_;
  std::vector<std::shared_ptr<const KdTree>> trees_;
  std::map<std::pair<int, int>, Count> counts_;
};

}  // namespace

std::unique_ptr<RelaxationEngine> makeActiveSetRelaxation(RelaxationInput input,
                                                          const RelaxationSettings& settings, int threads) {
  return std::make_unique<ActiveSetRelaxation>(std::move(input), settings, threads);
}

}  // namespace tiltmap
