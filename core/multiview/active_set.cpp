#include "core/multiview/active_set.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace tiltmap {

namespace {

RelaxationEvent eventOf(RelaxationEventKind kind, int scan, int other = -1, std::size_t pairs = 0) {
  RelaxationEvent event;
  event.kind = kind;
  event.scan = scan;
  event.other = other;
  event.pairs = pairs;
  return event;
}

}  // namespace

ActiveSet::ActiveSet(std::vector<char> fixed, const RelaxationSettings& settings)
    : fixed_(std::move(fixed)),
      unlinked_(fixed_.size(), 0),
      threshold_m_(settings.requeue_translation_m),
      threshold_rad_(settings.requeue_rotation_rad),
      max_visits_(settings.max_visits),
      static_(fixed_.size()),
      visits_(fixed_.size(), 0),
      done_(fixed_.empty()) {
  std::iota(static_.begin(), static_.end(), 0);
}

void ActiveSet::step(const ActiveSetActions& actions, RelaxationStep& report) {
  if (done_) throw std::logic_error("ActiveSet::step: the relaxation has ended");
  if (queue_.empty()) activate(actions, report);
  if (!queue_.empty()) visit(actions, report);
  done_ = static_.empty() && queue_.empty();
}

std::vector<int> ActiveSet::unlinked() const {
  std::vector<int> list;
  for (std::size_t i = 0; i < unlinked_.size(); ++i)
    if (unlinked_[i]) list.push_back(static_cast<int>(i));
  return list;
}

std::vector<int> ActiveSet::neighboursAmong(int scan, const std::vector<int>& others,
                                            const ActiveSetActions& actions) const {
  std::vector<int> list;
  for (const int other : others)
    if (other != scan && actions.areNeighbours(scan, other)) list.push_back(other);
  std::ranges::sort(list);
  return list;
}

int ActiveSet::mostNeighbours(const std::vector<int>& others, const ActiveSetActions& actions,
                              int& count) const {
  int best = -1;
  count = -1;
  for (const int scan : static_) {  // ascending, so the first of equals is the lowest
    const int found = static_cast<int>(neighboursAmong(scan, others, actions).size());
    if (found > count) count = found, best = scan;
  }
  return best;
}

void ActiveSet::activate(const ActiveSetActions& actions, RelaxationStep& report) {
  const bool first = active_.empty();
  int count = 0;
  const int scan = mostNeighbours(first ? static_ : active_, actions, count);
  std::erase(static_, scan);
  active_.push_back(scan);
  report.events.push_back(
      eventOf(RelaxationEventKind::Activated, scan, -1, first ? 0 : static_cast<std::size_t>(count)));
  if (count == 0) {
    unlinked_[static_cast<std::size_t>(scan)] = 1;
    report.events.push_back(eventOf(RelaxationEventKind::Unlinked, scan));
  } else if (!first) {
    enqueue(scan, -1, report);
  }
}

void ActiveSet::visit(const ActiveSetActions& actions, RelaxationStep& report) {
  const int scan = queue_.front();
  queue_.pop_front();
  ++visits_[static_cast<std::size_t>(scan)];
  const std::vector<int> neighbours = neighboursAmong(scan, active_, actions);
  bool pass_on = false;
  if (fixed_[static_cast<std::size_t>(scan)]) {
    // The world does not move, but whoever leans on it has to be looked at again.
    RelaxationEvent kept = eventOf(RelaxationEventKind::Kept, scan);
    kept.text = "it never moves; its neighbours are queued";
    report.events.push_back(kept);
    pass_on = true;
  } else if (unlinked_[static_cast<std::size_t>(scan)] || neighbours.empty()) {
    RelaxationEvent kept = eventOf(RelaxationEventKind::Kept, scan);
    kept.text = neighbours.empty() ? "it has no neighbour left in the active set"
                                   : "it had no neighbour in the active set when it came in";
    report.events.push_back(kept);
  } else {
    const PoseDifference moved = actions.align(scan, neighbours, report);
    RelaxationEvent event = eventOf(RelaxationEventKind::MovedBy, scan);
    event.translation_m = moved.translation_m;
    event.rotation_rad = moved.rotation_rad;
    report.events.push_back(event);
    pass_on = moved.translation_m > threshold_m_ || moved.rotation_rad > threshold_rad_;
  }
  if (pass_on)
    for (const int neighbour : neighbours) enqueue(neighbour, scan, report);
}

void ActiveSet::enqueue(int scan, int cause, RelaxationStep& report) {
  if (std::ranges::find(queue_, scan) != queue_.end()) return;
  if (visits_[static_cast<std::size_t>(scan)] >= max_visits_) {
    if (std::ranges::find(bounded_, scan) == bounded_.end()) {
      bounded_.push_back(scan);
      report.events.push_back(eventOf(RelaxationEventKind::VisitBound, scan, cause));
    }
    return;
  }
  queue_.push_back(scan);
  report.events.push_back(eventOf(RelaxationEventKind::Queued, scan, cause));
}

}  // namespace tiltmap
