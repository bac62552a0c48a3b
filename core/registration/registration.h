// Pairwise registration as a value that one advances: while (!r.done()) record(r.step());
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/registration/metric.h"
#include "core/registration/prepared_scan.h"
#include "core/registration/registration_settings.h"
#include "core/registration/rejection.h"
#include "core/scan/range_image.h"

namespace tiltmap {

enum class StopReason {
  Converged,       // the mean squared residual no longer changes
  TinyMotion,      // the step moved less than the bounds
  IterationLimit,  // the pose may still be on its way
  TooFewPairs,     // nothing to estimate from; the pose is not to be used
  NoOverlap,       // too little of the scans fits; the pose is not to be used
  Diverged,        // away from the start further than allowed, or not a number; the pose is not to be used
  Degenerate,      // the surfaces leave a direction free (one plane, a corridor); that direction is as at the
                   // start
  Cancelled,
};
std::string stopReasonName(StopReason reason);      // "converged", "no overlap": one or two words, stable
std::string stopReasonSentence(StopReason reason);  // for people: what it means and what to do
// Converged, tiny motion or iteration limit: the pose may be used.
bool isSuccess(StopReason reason);

// What one step did.
struct StepReport {
  int iteration = 0;           // 1 for the first step
  Pose fixed_from_moving;      // after the step
  Pose motion;                 // the step's own: fixed_from_moving = motion * (pose before)
  std::size_t pairs = 0;       // kept and used
  RejectionCounts rejected{};  // by reason; the entry of None equals `pairs`
  // Mean squared residual of the kept pairs before the step's motion, m^2 (with a loss: weighted by it).
  // Residual: the distance of the two points for the closed forms, the distance along the normal for the
  // plane metrics.
  double error_m2 = 0.0;
  double rms_m = 0.0;             // its root
  double change = 0.0;            // relative change of error_m2 against the step before; 1 for the first
  LossScale loss;                 // at which the step was taken
  double distance_bound_m = 0.0;  // on pairs, after the step; 0: none
  Conditioning condition;
  double overlap = 0.0;    // see Registration::overlap
  double agreement = 0.0;  // see Registration::agreement
  // A step of the refinement: cells were held against patches (refined). Pairs and error are those of the
  // step before.
  bool refining = false;
  double cells = 0.0;  // of both scans, that lie on a patch of the other
  double milliseconds = 0.0;
  std::optional<StopReason> stop;  // set in the last step
};

// A value: a copy continues with the same bits, which is how a step back works (keep the copies). One thread.
class Registration {
 public:
  // `start_fixed_from_moving` carries points of the moving scan into the frame of the fixed one. Throws
  // std::invalid_argument where checkSettings refuses the settings or the start is not finite.
  Registration(const Scan& fixed, const Scan& moving, const Pose& start_fixed_from_moving,
               const RegistrationSettings& settings);
  // Same, from scans that were prepared with the same settings; neither may be null.
  Registration(PreparedScanPtr fixed, PreparedScanPtr moving, const Pose& start_fixed_from_moving,
               const RegistrationSettings& settings);

  bool done() const { return stop_.has_value(); }
  // Finds pairs, rejects, estimates, tests for the end. Throws std::logic_error when done. A requested stop
  // ends the registration as Cancelled, the pose unchanged.
  StepReport step(const std::stop_token& stop = {});

  const Pose& fixedFromMoving() const { return pose_; }
  int iterations() const { return iteration_; }
  std::optional<StopReason> stopReason() const { return stop_; }
  // Pairs of the last step, kept and rejected, found at the pose before its motion.
  const std::vector<Correspondence>& correspondences() const { return pairs_; }
  const PreparedScanPtr& fixed() const { return fixed_; }
  const PreparedScanPtr& moving() const { return moving_; }
  const RegistrationSettings& settings() const { return settings_; }

  // Share (0 to 1) of the moving scan's sampled elements in the common field that have a fitting partner: one
  // that no rule rejected and whose residual is within three deviations (patches: of the pair, with the loss
  // scale; points: within 0.5 m). In the common field is an element for which the pair choice found a
  // candidate at all: with the projective choice something of the fixed scan in about that direction, with
  // the others every element. Of the last step; 0 before the first.
  double overlap() const { return overlap_; }
  // Share of the pairs that no rule rejected whose residual is within three deviations (as above).
  double agreement() const { return agreement_; }
  // Information (inverse covariance) of the last step's pose, left perturbation (rotation, translation) in
  // the frame of the fixed scan (Pose::moved), in rad^-2 and m^-2; zero before the first.
  const Matrix6d& information() const { return information_; }
  const Conditioning& condition() const { return condition_; }
  double rms() const { return rms_m_; }
  std::size_t keptPairs() const { return kept_; }

 private:
  void findPairsOfStep(StepReport& report);
  std::optional<StopReason> advance(StepReport& report);
  void measure(Metric metric, const LinearSystem& system, StepReport& report);
  void updateLossScale();
  std::optional<StopReason> limitReached() const;
  // Patches of either scan are blocks of its matrix, so that there are cells to hold against them.
  bool bothAreBlocks() const;
  bool canRefine() const;
  std::optional<StopReason> refineStep(StepReport& report);
  std::optional<StopReason> endOfStep(const StepReport& report, const PoseDifference& motion) const;
  StopReason verified(StopReason reason) const;
  void takeFewer(const std::vector<std::uint32_t>& all, std::vector<std::uint32_t>& wide,
                 std::vector<std::uint32_t>& early) const;
  void begin();
  void beginAnewStrictly();

  PreparedScanPtr fixed_, moving_;
  RegistrationSettings settings_;
  Pose start_, pose_;
  std::vector<std::uint32_t> moving_sample_, fixed_sample_;
  std::vector<std::uint32_t> wide_sample_, wide_fixed_sample_;    // fewer, in the first steps
  std::vector<std::uint32_t> early_sample_, early_fixed_sample_;  // then, where there are very many
  std::vector<Correspondence> pairs_;
  RejectionState rejection_;
  Residuals residuals_;
  int iteration_ = 0;
  int begun_at_ = 0;  // the iteration before the first, or before it began anew
  // Weak directions are left where they are. Not so at first, until a result turns out to rest on one.
  bool strictly_ = false;
  bool moved_weakly_ = false;  // along a weak direction, since it began
  LossScale loss_;
  int own_scale_steps_left_ = 0;
  int refinements_ = -1;  // made so far; before the first one is due: -1
  double error_m2_ = 0.0;
  double overlap_ = 0.0, agreement_ = 0.0, rms_m_ = 0.0;
  std::size_t kept_ = 0;
  Matrix6d information_ = Matrix6d::Zero();
  Conditioning condition_;
  std::optional<StopReason> stop_;
};

}  // namespace tiltmap
