#include "core/multiview/relaxation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "core/base/parallel.h"
#include "core/multiview/relaxation_engine.h"

namespace tiltmap {

namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

tl::unexpected<Error> unusable(std::string what) {
  return fail(std::move(what), "relax", "give one start a scan, and pins and links among these scans");
}

Status checkInput(const RelaxationInput& input) {
  const auto count = input.scans.size();
  if (count == 0) return unusable("there is no scan to relax");
  if (input.world_from_scan.size() != count) return unusable("the number of poses is not that of the scans");
  for (const PreparedScanPtr& scan : input.scans)
    if (!scan) return unusable("a scan is missing");
  if (!input.settled.empty() && input.settled.size() != count)
    return unusable("the number of flags is not that of the scans");
  for (std::size_t i = 0; i < count; ++i)
    if (!input.world_from_scan[i].isFinite())
      return unusable("the start of scan " + std::to_string(i) + " is not finite");
  const auto outside = [&](int i) { return i < 0 || static_cast<std::size_t>(i) >= count; };
  for (const int pin : input.pins)
    if (outside(pin)) return unusable("there is no scan " + std::to_string(pin) + " to pin");
  for (const PoseConstraint& c : input.constraints) {
    if (outside(c.fixed) || outside(c.moving) || c.fixed == c.moving)
      return unusable("a link does not join two of the scans");
    if (!c.fixed_from_moving.isFinite() || !c.information.allFinite())
      return unusable("the link of scans " + std::to_string(c.fixed) + " and " + std::to_string(c.moving) +
                      " is not finite");
  }
  return {};
}

std::unique_ptr<RelaxationEngine> makeEngine(RelaxationInput input, const RelaxationSettings& settings,
                                             int threads) {
  if (Status status = checkSettings(settings); !status) throw std::invalid_argument(status.error().what);
  if (Status status = checkInput(input); !status) throw std::invalid_argument(status.error().what);
  switch (settings.method) {
    case RelaxationMethod::Joint:
      return makeJointRelaxation(std::move(input), settings, threads);
    case RelaxationMethod::ActiveSet:
      return makeActiveSetRelaxation(std::move(input), settings, threads);
    case RelaxationMethod::Sequential:
      return makeSequentialRelaxation(std::move(input), settings, threads);
  }
  throw std::invalid_argument("Relaxation: no such method");
}

// Over all used links, each by its number of pairs.
double rmsOf(const std::vector<RelaxationLink>& links) {
  double sum = 0.0, weight = 0.0;
  for (const RelaxationLink& link : links) {
    if (!link.used || link.rms_m <= 0.0) continue;
    sum += static_cast<double>(link.pairs) * link.rms_m * link.rms_m;
    weight += static_cast<double>(link.pairs);
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

}  // namespace

std::string relaxationEventName(RelaxationEventKind kind) {
  switch (kind) {
    case RelaxationEventKind::Activated:
      return "activated";
    case RelaxationEventKind::Queued:
      return "queued";
    case RelaxationEventKind::Aligned:
      return "aligned";
    case RelaxationEventKind::MovedBy:
      return "moved by";
    case RelaxationEventKind::Kept:
      return "kept";
    case RelaxationEventKind::VisitBound:
      return "visit bound";
    case RelaxationEventKind::LinksFound:
      return "links found";
    case RelaxationEventKind::Solved:
      return "solved";
    case RelaxationEventKind::Unlinked:
      return "unlinked";
    case RelaxationEventKind::LinkDropped:
      return "link dropped";
    case RelaxationEventKind::Finished:
      return "finished";
    case RelaxationEventKind::Cancelled:
      return "cancelled";
  }
  throw std::invalid_argument("relaxationEventName: no such event");
}

RelaxationEngine::RelaxationEngine(RelaxationInput input, const RelaxationSettings& settings, int threads)
    : input_(std::move(input)),
      settings_(settings),
      threads_(threads),
      poses_(input_.world_from_scan),
      pinned_(input_.scans.size(), 0) {
  for (const auto& [a, b] : input_.excluded) excluded_.insert(std::minmax(a, b));
  pinned_.front() = 1;
  for (const int pin : input_.pins) pinned_[static_cast<std::size_t>(pin)] = 1;
}

void RelaxationEngine::tell(RelaxationState state) const {
  if (!isWatched()) return;
  state.step = watched_step_;
  (*watcher_)(state);
}

void RelaxationEngine::tellDoing(const std::string& doing) const {
  if (!isWatched()) return;
  RelaxationState now = state();
  now.doing = doing;
  tell(std::move(now));
}

std::function<void(const Registration&)> RelaxationEngine::tellIterations(
    RelaxationState now, int scan, const std::vector<int>& onto) const {
  if (!isWatched()) return {};
  now.aligning = scan;
  now.onto = onto;
  now.doing = "aligning scan " + std::to_string(scan) + " with " + namesOf(onto);
  return [this, now = std::move(now)](const Registration& registration) mutable {
    now.iteration = registration.iterations();
    now.pairs = registration.keptPairs();
    now.rms_m = registration.rms();
    tell(now);
  };
}

std::string namesOf(const std::vector<int>& scans) {
  std::string text;
  for (const int scan : scans) text += (text.empty() ? "" : ", ") + std::to_string(scan);
  return text;
}

void RelaxationEngine::finish(RelaxationStep& report) {
  finished_ = true;
  report.fraction = 1.0;
  report.events.emplace_back();
  report.events.back().kind = RelaxationEventKind::Finished;
}

void RelaxationEngine::cancel(RelaxationStep& report) {
  cancelled_ = true;
  report.events.emplace_back();
  report.events.back().kind = RelaxationEventKind::Cancelled;
}

Relaxation::Relaxation(RelaxationInput input, const RelaxationSettings& settings, int threads)
    : engine_(makeEngine(std::move(input), settings, threads)) {}
Relaxation::~Relaxation() = default;
Relaxation::Relaxation(const Relaxation& other) : engine_(other.engine_->clone()), steps_(other.steps_) {}
Relaxation& Relaxation::operator=(const Relaxation& other) {
  if (this != &other) engine_ = other.engine_->clone(), steps_ = other.steps_;
  return *this;
}
Relaxation::Relaxation(Relaxation&&) noexcept = default;
Relaxation& Relaxation::operator=(Relaxation&&) noexcept = default;

bool Relaxation::done() const {
  return engine_->done();
}

RelaxationStep Relaxation::step(const std::stop_token& stop, const RelaxationWatcher& watcher) {
  if (done()) throw std::logic_error("Relaxation::step: the relaxation has ended");
  const Clock::time_point begin = Clock::now();
  RelaxationStep report;
  report.number = ++steps_;
  // The watcher is only sure to live as long as this step.
  struct Watching {
    RelaxationEngine& engine;
    ~Watching() { engine.watchWith(nullptr, 0); }
  } const watching{*engine_};
  engine_->watchWith(&watcher, report.number);
  engine_->step(report, stop);
  report.milliseconds = millisecondsSince(begin);
  return report;
}

bool Relaxation::cancelled() const {
  return engine_->cancelled();
}
const std::vector<Pose>& Relaxation::poses() const {
  return engine_->poses();
}
const std::vector<Pose>& Relaxation::startPoses() const {
  return engine_->startPoses();
}
std::vector<int> Relaxation::unlinked() const {
  return engine_->unlinked();
}
std::vector<RelaxationLink> Relaxation::links() const {
  return engine_->links();
}
const std::vector<std::string>& Relaxation::warnings() const {
  return engine_->warnings();
}

RelaxationState Relaxation::state() const {
  RelaxationState now = engine_->state();
  now.step = steps_;
  return now;
}

Result<RelaxationResult> relax(RelaxationInput input, const RelaxationSettings& settings, int threads,
                               const JobControl& control, const RelaxationWatch& watch) {
  const Clock::time_point begin = Clock::now();
  if (Status status = checkSettings(settings); !status) return fail(status.error());
  if (Status status = checkInput(input); !status) return fail(status.error());
  Relaxation relaxation(std::move(input), settings, threads);
  RelaxationResult result;
  while (!relaxation.done()) {
    result.steps.push_back(relaxation.step(control.stop, watch.within));
    if (watch.after) watch.after(relaxation, result.steps.back());
    control.tell(result.steps.back().fraction, "relaxing, step " + std::to_string(relaxation.steps()));
  }
  if (relaxation.cancelled())
    return fail(kCancelled, "relax", "nothing was changed; start it again when you like");
  result.poses = relaxation.poses();
  for (std::size_t i = 0; i < result.poses.size(); ++i)
    result.moved.push_back(difference(relaxation.startPoses()[i], result.poses[i]));
  result.unlinked = relaxation.unlinked();
  result.links = relaxation.links();
  result.warnings = relaxation.warnings();
  result.rms_m = rmsOf(result.links);
  result.milliseconds = millisecondsSince(begin);
  return result;
}

Result<std::vector<PreparedScanPtr>> prepareAll(const std::vector<Scan>& scans,
                                                const RelaxationSettings& settings, int threads,
                                                const JobControl& control) {
  if (Status status = checkSettings(settings); !status) return fail(status.error());
  for (std::size_t i = 0; i < scans.size(); ++i)
    if (!scans[i].image)
      return fail("it has no range matrix", "scan " + std::to_string(i), "load or capture its matrix first");
  std::vector<PreparedScanPtr> prepared(scans.size());
  parallelFor(scans.size(), threads, [&](std::size_t i) {
    if (!control.stopRequested()) prepared[i] = prepare(scans[i], settings.registration);
  });
  if (control.stopRequested())
    return fail(kCancelled, "relax", "nothing was changed; start it again when you like");
  return prepared;
}

}  // namespace tiltmap
