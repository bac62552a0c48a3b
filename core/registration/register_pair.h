// One call: two scans and a start in, a pose and how far to trust it out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/registration/registration.h"

namespace tiltmap {

struct PairResult {
  // Carries points of the moving scan into the frame of the fixed one. Only to be used where succeeded().
  Pose fixed_from_moving;
  Pose
      start;  // fixed_from_moving that the registration began at: the one given, or another heading (retries)
  int retries = 0;  // other headings that were tried, because the first result agreed too little
  int iterations = 0;
  std::size_t correspondences = 0;  // pairs kept in the last step
  // Root mean square of the kept pairs' residuals in the last step (with a loss: weighted by it): along the
  // normal for the plane metrics, between the points for the closed forms.
  double rms_m = 0.0;
  double overlap = 0.0;    // 0 to 1, as Registration::overlap
  double agreement = 0.0;  // 0 to 1, as Registration::agreement
  StopReason stop_reason = StopReason::TooFewPairs;
  // Inverse covariance of the pose for Pose::moved (rotation, translation), fixed frame.
  Matrix6d information = Matrix6d::Zero();
  Conditioning condition;     // weak directions
  double milliseconds = 0.0;  // from the raw matrices (or the prepared scans) to the pose
  std::vector<StepReport> steps;
  std::vector<std::string> warnings;

  bool succeeded() const { return isSuccess(stop_reason); }
};

// Where patch-grouping auto cut a matrix into blocks and the result failed, agrees too little or is known
// badly in some direction (retry_deviation), both scans are cut into cubes instead, which catch small things
// better.
// A result that agrees less than retry_agreement is doubted: the pair is registered again from other headings
// of the moving scan. One of them is taken where it is not doubted itself and fits more (overlap times
// agreement).
//
// Why the steps of a pair began anew.
enum class AttemptKind {
  Given,         // from the start that was given
  Cubes,         // the same start, the scans cut into cubes where they had been cut into blocks
  OtherHeading,  // from another heading of the moving scan
};
struct PairAttempt {
  AttemptKind kind = AttemptKind::Given;
  Pose start;               // fixed_from_moving
  double turned_rad = 0.0;  // of the start's heading against the one given, left positive
};

// registerPair as a value that one advances, its attempts one after the other: while (!r.done())
// show(r.step()). A copy continues with the same bits. One thread.
class PairRegistration {
 public:
  // Throws std::invalid_argument for what Registration refuses.
  PairRegistration(PreparedScanPtr fixed, PreparedScanPtr moving, const Pose& start_fixed_from_moving,
                   const RegistrationSettings& settings);

  bool done() const { return next_ == plan_.size() && current_ && current_->done(); }
  bool cancelled() const { return cancelled_; }
  // One step of the present attempt, or the first of the next (which may cut the scans anew). A requested
  // stop ends everything. Throws std::logic_error when done.
  StepReport step(const std::stop_token& stop = {});

  // Attempts that have been begun, the one of the last step included.
  std::size_t attempts() const { return next_; }
  // Those of the last step; throw std::logic_error before the first.
  const PairAttempt& attempt() const;
  const Registration& registration() const;
  // Index of the attempt whose result stands so far; nothing before one has ended.
  std::optional<std::size_t> chosen() const { return chosen_; }

  // What registerPair gives, but for the time. Throws std::logic_error before it is done, or cancelled.
  PairResult result() const;

 private:
  void begin(const PairAttempt& attempt);
  void conclude();
  bool takes(const PairResult& result) const;
  void planCubes();
  void planHeadings();

  PreparedScanPtr fixed_, moving_;
  RegistrationSettings settings_;
  std::vector<PairAttempt> plan_;
  std::size_t next_ = 0;  // of the plan
  std::optional<Registration> current_;
  std::vector<StepReport> steps_;  // of the present attempt
  std::optional<PairResult> best_;
  std::optional<std::size_t> chosen_;
  bool cancelled_ = false;
};

// From the raw matrices. An Error where the settings are refused, a start is not finite, or the job was
// cancelled; a registration that ran and found nothing usable is a PairResult whose stop_reason says so.
Result<PairResult> registerPair(const Scan& fixed, const Scan& moving, const Pose& start_fixed_from_moving,
                                const RegistrationSettings& settings, const JobControl& control = {});
// From scans prepared with the same settings, which may be shared between pairs and threads.
Result<PairResult> registerPair(const PreparedScanPtr& fixed, const PreparedScanPtr& moving,
                                const Pose& start_fixed_from_moving, const RegistrationSettings& settings,
                                const JobControl& control = {});

}  // namespace tiltmap
