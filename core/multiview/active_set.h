// The order of thesis figure 6.1: which scan becomes active, which is aligned next, and when it ends.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "core/geometry/pose.h"
#include "core/multiview/relaxation.h"

namespace tiltmap {

// What the order needs to know, supplied by whoever holds the scans.
struct ActiveSetActions {
  // Whether two different scans are neighbours at the present poses; symmetric.
  std::function<bool(int, int)> areNeighbours;
  // Aligns a scan with the union of its active neighbours (ascending, never empty) and tells how far it
  // moved. Appends its own Aligned or Kept event.
  std::function<PoseDifference(int scan, const std::vector<int>& neighbours, RelaxationStep&)> align;
};

// Pulli's active and static sets and the queue, without any geometry. A value; the actions are passed to each
// step, so that a copy does not depend on whom it was copied from.
class ActiveSet {
 public:
  // `fixed[i]`: scan i never moves. `settings` gives the thresholds and the bound on visits.
  ActiveSet(std::vector<char> fixed, const RelaxationSettings& settings);

  bool done() const { return done_; }
  // Takes one scan from the queue; where the queue is empty, a scan first comes into the active set. Ends
  // with done() once the static set and the queue are empty.
  void step(const ActiveSetActions& actions, RelaxationStep& report);

  // In the order in which they came in.
  const std::vector<int>& active() const { return active_; }
  const std::vector<int>& waiting() const { return static_; }  // ascending
  const std::deque<int>& queue() const { return queue_; }
  // Ascending: scans that had no neighbour in the active set when they came in. They keep their poses.
  std::vector<int> unlinked() const;
  int visits(int scan) const { return visits_[static_cast<std::size_t>(scan)]; }
  // Scans that reached the bound on visits.
  const std::vector<int>& bounded() const { return bounded_; }

 private:
  // The static scan with the most neighbours among `others` (itself left out), the lowest index of equals;
  // -1 where no scan is static.
  int mostNeighbours(const std::vector<int>& others, const ActiveSetActions& actions, int& count) const;
  std::vector<int> neighboursAmong(int scan, const std::vector<int>& others,
                                   const ActiveSetActions& actions) const;
  void activate(const ActiveSetActions& actions, RelaxationStep& report);
  void visit(const ActiveSetActions& actions, RelaxationStep& report);
  void enqueue(int scan, int cause, RelaxationStep& report);

  std::vector<char> fixed_;     // never moves
  std::vector<char> unlinked_;  // came in without a neighbour; the very first scan does not count
  double threshold_m_ = 0.0, threshold_rad_ = 0.0;
  int max_visits_ = 0;
  std::vector<int> static_, active_;
  std::deque<int> queue_;
  std::vector<int> visits_;
  std::vector<int> bounded_;
  bool done_ = false;
};

}  // namespace tiltmap
