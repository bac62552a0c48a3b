#include "core/registration/registration.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "core/registration/cell_refinement.h"
#include "core/registration/pair_choice.h"
#include "core/registration/sampling.h"

namespace tiltmap {

namespace {

// The data's own scale is taken this often after the annealing, then kept, so that the iteration can settle.
constexpr int kOwnScaleSteps = 3;
constexpr int kOwnScaleStepsToRefine = 2;
// Cells are given to patches once the pose moves less than this a step, and again while it moves more.
constexpr double kRefineBelow_m = 3e-3;
constexpr double kRefineBelow_rad = 3e-4;
constexpr double kRefinedBelow_m = 2e-3;
constexpr double kRefinedBelow_rad = 2e-4;
constexpr int kMostRefinements = 4;
// Surfaces that fit worse than this are not the same surfaces.
constexpr double kMostExcess_m = 0.05;

// The wide search pairs at least so many, and about so many at most.
constexpr std::size_t kWideSample = 200;
constexpr std::size_t kMostWide = 600;
// Of an unordered cloud, while the loss scale comes down.
constexpr std::size_t kMostEarly = 800;

// One in so many, or more than that where too few would be left.
std::vector<std::uint32_t> everyNth(const std::vector<std::uint32_t>& all, int n, std::size_t least) {
  const std::size_t step = std::clamp<std::size_t>(all.size() / least, 1, static_cast<std::size_t>(n));
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < all.size(); i += step) chosen.push_back(all[i]);
  return chosen;
}

double firstLossScale(const RegistrationSettings& settings) {
  switch (settings.loss) {
    case Loss::None:
      return 0.0;
    case Loss::GemanMcClure:
      return settings.loss_scale_m;
    case Loss::Annealed:
      return settings.loss_start_m;
  }
  return 0.0;
}

}  // namespace

std::string stopReasonName(StopReason reason) {
  switch (reason) {
    case StopReason::Converged:
      return "converged";
    case StopReason::TinyMotion:
      return "tiny motion";
    case StopReason::IterationLimit:
      return "iteration limit";
    case StopReason::TooFewPairs:
      return "too few pairs";
    case StopReason::NoOverlap:
      return "no overlap";
    case StopReason::Diverged:
      return "diverged";
    case StopReason::Degenerate:
      return "degenerate";
    case StopReason::Cancelled:
      return "cancelled";
  }
  throw std::invalid_argument("stopReasonName: no such reason");
}

std::string stopReasonSentence(StopReason reason) {
  switch (reason) {
    case StopReason::Converged:
      return "The error no longer changes.";
    case StopReason::TinyMotion:
      return "The last step hardly moved.";
    case StopReason::IterationLimit:
      return "The iteration limit was reached before the pose settled; raise it, or look at the result.";
    case StopReason::TooFewPairs:
      return "Too few pairs were found to estimate a motion; give a better start or wider bounds.";
    case StopReason::NoOverlap:
      return "Too little of the two scans fits together; give a better start, or leave this pair out.";
    case StopReason::Diverged:
      return "The pose ran away from the start further than allowed; give a better start.";
    case StopReason::Degenerate:
      return "The surfaces both scans see leave a direction free, as a single plane or a long corridor does; "
             "that "
             "direction stays as at the start.";
    case StopReason::Cancelled:
      return "It was cancelled.";
  }
  throw std::invalid_argument("stopReasonSentence: no such reason");
}

bool isSuccess(StopReason reason) {
  return reason == StopReason::Converged || reason == StopReason::TinyMotion ||
         reason == StopReason::IterationLimit;
}

Registration::Registration(const Scan& fixed, const Scan& moving, const Pose& start_fixed_from_moving,
                           const RegistrationSettings& settings)
    : Registration(prepare(fixed, settings), prepare(moving, settings), start_fixed_from_moving, settings) {}

Registration::Registration(PreparedScanPtr fixed, PreparedScanPtr moving, const Pose& start_fixed_from_moving,
                           const RegistrationSettings& settings)
    : fixed_(std::move(fixed)),
      moving_(std::move(moving)),
      settings_(settings),
      start_(start_fixed_from_moving),
      pose_(start_fixed_from_moving) {
  if (!fixed_ || !moving_) throw std::invalid_argument("Registration: a scan is missing");
  if (const Status status = checkSettings(settings); !status)
    throw std::invalid_argument(status.error().what);
  if (!start_.isFinite()) throw std::invalid_argument("Registration: the start is not finite");
  moving_sample_ = sampledElements(moving_->elements, settings_);
  takeFewer(moving_sample_, wide_sample_, early_sample_);
  if (settings_.both_directions) {
    fixed_sample_ = sampledElements(fixed_->elements, settings_);
    takeFewer(fixed_sample_, wide_fixed_sample_, early_fixed_sample_);
  }
  begin();
}

void Registration::takeFewer(const std::vector<std::uint32_t>& all, std::vector<std::uint32_t>& wide,
                             std::vector<std::uint32_t>& early) const {
  const auto oneIn = [&](std::size_t most) { return static_cast<int>(all.size() / most); };
  wide = everyNth(all, std::max(settings_.wide_step, oneIn(kMostWide)), kWideSample);
  early = everyNth(all, std::max(1, oneIn(kMostEarly)), kWideSample);
}

void Registration::begin() {
  rejection_ = {};
  rejection_.distance_bound_m = settings_.max_distance_m;
  loss_ = firstLossScale(settings_);
  if (settings_.loss == Loss::Annealed)
    own_scale_steps_left_ = settings_.refine && bothAreBlocks() ? kOwnScaleStepsToRefine : kOwnScaleSteps;
}

// What is known too badly shall stay as at the start.
void Registration::beginAnewStrictly() {
  strictly_ = true;
  begun_at_ = iteration_;
  refinements_ = -1;
  error_m2_ = 0.0;
  pose_ = start_;
  begin();
}

StepReport Registration::step(const std::stop_token& stop) {
  if (done()) throw std::logic_error("Registration::step: the registration has ended");
  const auto begin = std::chrono::steady_clock::now();
  StepReport report;
  const Pose before = pose_;
  report.iteration = ++iteration_;
  if (stop.stop_requested()) {
    stop_ = StopReason::Cancelled;
  } else if (refinements_ >= 0) {
    stop_ = refineStep(report);
  } else {
    findPairsOfStep(report);
    stop_ = advance(report);
  }
  moved_weakly_ = moved_weakly_ || (!strictly_ && condition_.free < condition_.weak);
  if (stop_ == StopReason::Degenerate && moved_weakly_ && !strictly_) {
    stop_.reset();
    beginAnewStrictly();
  }
  report.fixed_from_moving = pose_;
  report.motion = pose_ * before.inverse();
  report.distance_bound_m = rejection_.distance_bound_m;
  report.overlap = overlap_;
  report.agreement = agreement_;
  report.stop = stop_;
  report.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

void Registration::findPairsOfStep(StepReport& report) {
  // Annealing needs no fine pose, nor does what cells will refine; blocks are many.
  const bool annealing = settings_.loss == Loss::Annealed && settings_.pair_choice == PairChoice::Projective;
  const bool blocks = bothAreBlocks() && annealing;
  const bool wide =
      loss_.isOwn() ? blocks && settings_.refine : blocks || loss_.scale_m > settings_.wide_search_above_m;
  const bool early = annealing && !loss_.isOwn();
  const bool projective = settings_.pair_choice == PairChoice::Projective;
  const auto& moving = wide && projective ? wide_sample_ : early ? early_sample_ : moving_sample_;
  const auto& fixed = wide && projective ? wide_fixed_sample_ : early ? early_fixed_sample_ : fixed_sample_;
  report.rejected =
      findPairs(*fixed_, *moving_, pose_, fixed, moving, loss_.scale_m, settings_, rejection_, pairs_);
  report.pairs = kept_ = report.rejected[static_cast<std::size_t>(RejectReason::None)];
  report.loss = loss_;
}

std::optional<StopReason> Registration::advance(StepReport& report) {
  const Metric metric = metricOf(settings_.motion, settings_.reduction == Reduction::Patches);
  LinearSystem system;
  linearise(metric, fixed_->elements, moving_->elements, Pose(), pose_, pairs_, settings_, loss_, system,
            &residuals_);
  measure(metric, system, report);
  if (kept_ < static_cast<std::size_t>(settings_.min_pairs)) return StopReason::TooFewPairs;

  const Pose before = pose_;
  if (metric == Metric::PointToPoint) {
    const Result<Pose> found =
        closedFormStep(settings_.motion, fixed_->elements, moving_->elements, pose_, pairs_, loss_);
    if (!found) return StopReason::Degenerate;
    pose_ = *found;
  } else {
    pose_ = pose_.moved(strictly_ ? solvedStep(system, condition_) : solvedStepOnTheWay(system, condition_));
  }
  const PoseDifference from_start = difference(start_, pose_);
  if (!pose_.isFinite() || from_start.translation_m > settings_.max_correction_m ||
      from_start.rotation_rad > settings_.max_correction_rad) {
    if (!pose_.isFinite()) pose_ = before;
    return overlap_ < settings_.min_overlap ? StopReason::NoOverlap : StopReason::Diverged;
  }
  const bool settling = own_scale_steps_left_ == 0;
  updateLossScale();
  if (!settling) return limitReached();
  const PoseDifference motion = difference(before, pose_);
  const std::optional<StopReason> end = endOfStep(report, motion);
  const bool settled = motion.translation_m < kRefineBelow_m && motion.rotation_rad < kRefineBelow_rad;
  if (!canRefine() || !(end ? isSuccess(*end) : settled)) return end;
  refinements_ = 0;
  return std::nullopt;
}

bool Registration::bothAreBlocks() const {
  return fixed_->raster && moving_->raster;
}

bool Registration::canRefine() const {
  return settings_.refine && loss_.isOwn() && bothAreBlocks();
}

std::optional<StopReason> Registration::refineStep(StepReport& report) {
  ++refinements_;
  report.refining = true;
  // Those of the last step that looked for pairs.
  for (const Correspondence& pair : pairs_) ++report.rejected[static_cast<std::size_t>(pair.reason)];
  report.pairs = kept_;
  report.loss = loss_;
  report.error_m2 = error_m2_;
  report.rms_m = rms_m_;
  const Refined found = refined(*fixed_, *moving_, pose_, loss_.scale_m, settings_, strictly_);
  report.cells = found.cells;
  if (found.patches < static_cast<std::size_t>(settings_.min_pairs)) {
    report.condition = condition_;
    return verified(StopReason::Converged);
  }
  const PoseDifference motion = difference(pose_, found.fixed_from_moving);
  pose_ = found.fixed_from_moving;
  information_ = found.system.h;
  condition_ = conditioningOf(found.system, settings_.min_eigenvalue);
  report.condition = condition_;
  if (motion.translation_m < kRefinedBelow_m && motion.rotation_rad < kRefinedBelow_rad)
    return verified(StopReason::TinyMotion);
  if (refinements_ == kMostRefinements) return verified(StopReason::Converged);
  return limitReached();
}

// Records what the linearised system says about the step's pose.
void Registration::measure(Metric metric, const LinearSystem& system, StepReport& report) {
  const double last = error_m2_;
  error_m2_ = system.loss_weight > 0.0 ? system.loss_square_m2 / system.loss_weight : 0.0;
  rms_m_ = std::sqrt(error_m2_);
  report.error_m2 = error_m2_;
  report.rms_m = rms_m_;
  report.change = iteration_ == begun_at_ + 1 ? 1.0 : std::abs(error_m2_ - last) / std::max(last, 1e-300);
  condition_ = conditioningOf(system, settings_.min_eigenvalue);
  report.condition = condition_;
  // Unit weights become an information through the residuals' own variance.
  const double floor = 1e-12;
  information_ = metric == Metric::PatchToPatch ? system.h : Matrix6d(system.h / std::max(error_m2_, floor));
  std::size_t common = 0;
  for (const Correspondence& pair : pairs_)
    if (!pair.from_fixed && pair.reason != RejectReason::NoPartner) ++common;
  overlap_ = common > 0 ? static_cast<double>(system.agreeing_moving) / static_cast<double>(common) : 0.0;
  agreement_ =
      system.pairs > 0 ? static_cast<double>(system.agreeing) / static_cast<double>(system.pairs) : 0.0;
}

void Registration::updateLossScale() {
  if (settings_.loss != Loss::Annealed || own_scale_steps_left_ == 0 || residuals_.size_m.empty()) return;
  const double typical = typicalOf(residuals_.size_m);
  if (!loss_.isOwn() && loss_.scale_m > settings_.loss_end_m) {
    // A start that is good already need not wait for the scale to come down.
    const double next = std::min(loss_.scale_m * settings_.loss_factor, settings_.loss_follow * typical);
    loss_ = std::max(settings_.loss_end_m,
                     iteration_ > begun_at_ + 1 ? next : loss_.scale_m * settings_.loss_factor);
    return;
  }
  --own_scale_steps_left_;
  if (residuals_.variance_m2.empty()) {
    loss_ = std::clamp(typical, settings_.loss_minimum_m, settings_.loss_end_m);
    return;
  }
  const double excess = excessDeviation(residuals_.size_m, residuals_.variance_m2);
  loss_ = LossScale::ofOwnDeviation(settings_.loss_deviations, std::min(excess, kMostExcess_m));
}

std::optional<StopReason> Registration::limitReached() const {
  if (iteration_ - begun_at_ >= settings_.max_iterations) return verified(StopReason::IterationLimit);
  return std::nullopt;
}

std::optional<StopReason> Registration::endOfStep(const StepReport& report,
                                                  const PoseDifference& motion) const {
  if (motion.translation_m < settings_.min_translation_m && motion.rotation_rad < settings_.min_rotation_rad)
    return verified(StopReason::TinyMotion);
  if (iteration_ > begun_at_ + 1 && report.change < settings_.min_change)
    return verified(StopReason::Converged);
  return limitReached();
}

// An end is only what it claims to be where the scans fit and the surfaces determine the pose.
StopReason Registration::verified(StopReason reason) const {
  if (overlap_ < settings_.min_overlap || agreement_ < settings_.min_agreement) return StopReason::NoOverlap;
  if (condition_.weak > 0) return StopReason::Degenerate;
  return reason;
}

}  // namespace tiltmap
