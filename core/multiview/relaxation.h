// Global relaxation as a value that one advances: while (!r.done()) record(r.step());
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/multiview/relaxation_settings.h"
#include "core/registration/prepared_scan.h"

namespace tiltmap {

// A relative pose known from elsewhere: set by hand, or found by an earlier registration.
struct PoseConstraint {
  int fixed = 0;
  int moving = 0;
  Pose fixed_from_moving;
  // Inverse covariance for Pose::moved (rotation, translation), fixed frame, rad^-2 and m^-2.
  Matrix6d information = Matrix6d::Zero();
  // Used only where the surfaces of the two scans give no link themselves, so that nothing counts twice.
  bool only_without_link = true;
};

struct RelaxationInput {
  std::vector<PreparedScanPtr> scans;       // prepared with the settings' registration; none null
  std::vector<Pose> world_from_scan;        // starts, one a scan
  std::vector<int> pins;                    // scans that never move; scan 0 never does
  std::vector<PoseConstraint> constraints;  // Joint only
  // Pairs of scans that must not be linked by their surfaces (a link that was disabled), either way round.
  std::vector<std::pair<int, int>> excluded = {};
  // One a scan, or empty for none: two scans that are settled are not measured against each other (all that
  // is known of them stands in constraints).
  std::vector<char> settled = {};
};

enum class RelaxationEventKind {
  Activated,  // a scan came into the active set; `pairs`: its neighbours there
  Queued,     // a scan was put at the end of the queue
  // A scan was registered onto its neighbours (Joint: onto `other` alone, which it did not fit yet); `pairs`,
  // `rms_m`, `text`: how that ended.
  Aligned,
  MovedBy,      // a scan moved by translation_m and rotation_rad
  Kept,         // a scan stays where it is; `text`: why
  VisitBound,   // a scan was not queued again: it has been visited as often as allowed
  LinksFound,   // the overlapping pairs were looked for anew; `pairs`: how many are used
  Solved,       // one step of the joint problem: `pairs` of elements, `rms_m`, `loss_scale_m`, largest motion
  Unlinked,     // a scan has no link to the others and keeps its start
  LinkDropped,  // two neighbours in time (`scan`, `other`) do not fit, so nothing is computed from them
  Finished,
  Cancelled,
};
std::string relaxationEventName(RelaxationEventKind kind);  // "moved by"; stable

struct RelaxationEvent {
  RelaxationEventKind kind = RelaxationEventKind::Finished;
  int scan = -1;   // -1: not about one scan
  int other = -1;  // the scan that caused it, or the second of two
  double translation_m = 0.0;
  double rotation_rad = 0.0;
  std::size_t pairs = 0;
  double rms_m = 0.0;
  double loss_scale_m = 0.0;
  std::string text;
};

struct RelaxationStep {
  int number = 0;  // 1 for the first
  std::vector<RelaxationEvent> events;
  double milliseconds = 0.0;
  double fraction = 0.0;  // a guess of how much is done, 0 to 1, for progress
};

// What a relaxation is at, for whoever watches it. Scans by index.
struct RelaxationState {
  int step = 0;  // the one that runs, or that ran last
  // Joint: tied to scan 0 or a pinned one at the last step. ActiveSet: in the order in which they came in.
  // Sequential: those placed.
  std::vector<int> active;
  std::vector<int> waiting;  // not among them yet (the static set), ascending
  std::vector<int> queue;    // ActiveSet: to be aligned, the next one first; Sequential: those to come
  int aligning = -1;         // the scan that is being registered; -1: none
  std::vector<int> onto;     // what it is registered onto
  int iteration = 0;         // of that registration; 0 before its first
  std::size_t pairs = 0;     // of its last iteration
  double rms_m = 0.0;        // of its last iteration
  std::string doing;         // "aligning scan 3 with 2, 4"; empty between two steps
};
// Called on the thread that steps, within a step; the relaxation goes on when it returns, so that it may
// wait.
using RelaxationWatcher = std::function<void(const RelaxationState&)>;

// Two scans that overlap, as the result sees them.
struct RelaxationLink {
  int fixed = 0;  // the lower index
  int moving = 0;
  Pose fixed_from_moving;                   // at the present poses
  std::size_t pairs = 0;                    // of elements, kept
  double overlap = 0.0;                     // as Registration::overlap
  double agreement = 0.0;                   // as Registration::agreement
  double rms_m = 0.0;                       // of the kept pairs' residuals, weighted by the loss
  Matrix6d information = Matrix6d::Zero();  // rotation, translation; fixed frame
  bool used = true;                         // false: too little of it fits, so nothing was computed from it
};

class RelaxationEngine;  // one of the methods

// A value: a copy continues with the same bits, so a step back is an earlier copy. One thread at a time; its
// own work is shared among `threads` threads (0: all cores), and the bits do not depend on how many.
class Relaxation {
 public:
  // Throws std::invalid_argument where sizes differ, a scan is missing, a pose is not finite, a pin or a
  // constraint names no scan, or checkSettings refuses the settings.
  Relaxation(RelaxationInput input, const RelaxationSettings& settings, int threads = 0);
  ~Relaxation();
  Relaxation(const Relaxation& other);
  Relaxation& operator=(const Relaxation& other);
  Relaxation(Relaxation&&) noexcept;
  Relaxation& operator=(Relaxation&&) noexcept;

  bool done() const;
  // Joint: one step of the whole problem. ActiveSet: one scan of the queue. Sequential: one scan. Throws
  // std::logic_error when done. A requested stop ends it as cancelled; the poses stay as the last whole step
  // left them.
  // What a watcher is told changes no bit of what is computed.
  RelaxationStep step(const std::stop_token& stop = {}, const RelaxationWatcher& watcher = {});

  bool cancelled() const;
  const std::vector<Pose>& poses() const;  // world_from_scan
  const std::vector<Pose>& startPoses() const;
  // Ascending: scans that no link ties to the others; they keep their start.
  std::vector<int> unlinked() const;
  // By (fixed, moving). Joint: of the last step. The others: neighbours of the last count, without figures.
  std::vector<RelaxationLink> links() const;
  const std::vector<std::string>& warnings() const;
  RelaxationState state() const;  // between two steps
  int steps() const { return steps_; }

 private:
  std::unique_ptr<RelaxationEngine> engine_;
  int steps_ = 0;
};

struct RelaxationResult {
  std::vector<Pose> poses;            // world_from_scan
  std::vector<PoseDifference> moved;  // from the start, one a scan
  std::vector<int> unlinked;
  std::vector<RelaxationLink> links;
  std::vector<RelaxationStep> steps;
  std::vector<std::string> warnings;
  double rms_m = 0.0;  // over the pairs of all used links, weighted as the links are; 0 where not known
  double milliseconds = 0.0;
};

// Told of a relaxation that somebody else steps; both on the thread that does. Either may be empty.
struct RelaxationWatch {
  RelaxationWatcher within;                                                  // a step
  std::function<void(const Relaxation&, const RelaxationStep&)> after = {};  // each step
};

// Steps to the end. An Error where the settings are refused, an input is not usable, or it was cancelled.
Result<RelaxationResult> relax(RelaxationInput input, const RelaxationSettings& settings, int threads = 0,
                               const JobControl& control = {}, const RelaxationWatch& watch = {});

// Prepares every scan, shared among the threads; the same bits for any number of them.
Result<std::vector<PreparedScanPtr>> prepareAll(const std::vector<Scan>& scans,
                                                const RelaxationSettings& settings, int threads = 0,
                                                const JobControl& control = {});

}  // namespace tiltmap
