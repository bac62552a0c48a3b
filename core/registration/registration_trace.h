// Every iteration of a pairwise registration, kept: what a person steps through, forward and back.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/registration/register_pair.h"

namespace tiltmap {

// One iteration as it was. Immutable once made, so that it may be shared with whoever draws it.
struct TraceStep {
  std::size_t attempt = 0;  // which of RegistrationTrace::attempts()
  StepReport report;
  Pose before;                        // fixed_from_moving at which the pairs were found
  std::vector<Correspondence> pairs;  // kept and rejected
};
using TraceStepPtr = std::shared_ptr<const TraceStep>;

// What the steps of one attempt have in common.
struct TraceAttempt {
  PairAttempt what;
  PreparedScanPtr fixed, moving;  // whose elements the pairs name
  RegistrationSettings settings;
  std::size_t first_step = 0;  // of all steps of the trace
};

// registerPair, stepped: the same bits, every retry included. Nothing is ever recomputed to go back. One
// thread at a time.
class RegistrationTrace {
 public:
  // From the raw matrices. Errors as registerPair: settings refused, a start that is not finite, a scan
  // without a matrix.
  static Result<RegistrationTrace> begin(const Scan& fixed, const Scan& moving,
                                         const Pose& start_fixed_from_moving,
                                         const RegistrationSettings& settings);
  // From scans prepared with the same settings; neither may be null.
  static Result<RegistrationTrace> begin(const PreparedScanPtr& fixed, const PreparedScanPtr& moving,
                                         const Pose& start_fixed_from_moving,
                                         const RegistrationSettings& settings);

  bool done() const { return registration_.done(); }
  bool cancelled() const { return registration_.cancelled(); }
  // The next iteration, which is kept as well. Throws std::logic_error when done. A requested stop ends the
  // trace; the step that tells so has no pairs.
  TraceStepPtr step(const std::stop_token& stop = {});

  const std::vector<TraceStepPtr>& steps() const { return steps_; }
  // Those begun so far: the first one is there before the first step.
  const std::vector<TraceAttempt>& attempts() const { return attempts_; }
  std::optional<std::size_t> chosenAttempt() const { return registration_.chosen(); }
  const Pose& start() const { return attempts_.front().what.start; }
  // registerPair's; its time is that of the preparation and of the steps taken, without the pauses between
  // them. Throws std::logic_error before the end, or when cancelled.
  PairResult result() const;

 private:
  RegistrationTrace(PairRegistration registration, TraceAttempt first);

  PairRegistration registration_;
  std::vector<TraceAttempt> attempts_;
  std::vector<TraceStepPtr> steps_;
  double milliseconds_ = 0.0;
};

// A pair of an iteration with what the metric makes of it. Residual, deviation and weight only where it was
// kept.
struct TracedPair {
  Correspondence pair;
  Eigen::Vector3d fixed_point = Eigen::Vector3d::Zero();   // fixed scan's frame; without a partner: unused
  Eigen::Vector3d moving_point = Eigen::Vector3d::Zero();  // moving scan's frame
  double residual_m = 0.0;   // not negative; along the normal for the plane metrics
  double deviation_m = 0.0;  // expected of the residual, patches only; 0: not known
  double weight = 1.0;       // of the loss, 0 to 1
};
std::vector<TracedPair> tracedPairs(const TraceAttempt& attempt, const TraceStep& step);

// How the residuals of the kept pairs lie.
struct ResidualHistogram {
  double bin_m = 0.0;               // width; 0: there are no pairs
  std::vector<std::size_t> counts;  // of pairs: bin k holds k bin_m <= residual < (k + 1) bin_m
  std::vector<double> weighted;     // the same, each pair counting by its weight
  std::size_t beyond = 0;           // further out than the last bin
  double median_m = 0.0;
};
// About `bins` (at most) of a round width that hold nineteen of twenty residuals.
ResidualHistogram residualHistogram(const std::vector<TracedPair>& pairs, std::size_t bins = 40);

// In sentences, for people.
std::string attemptSentence(const PairAttempt& attempt);  // "From the given start."
// What became of a pair and why: "Kept: 12 mm apart along the normal ..."
std::string pairSentence(const TraceAttempt& attempt, const TraceStep& step, const TracedPair& pair);
// What residuals were judged by in a step: "Loss scale: 0.43 m, on its way down.", or that of the refinement
// how many cells were held against patches.
std::string lossSentence(const TraceAttempt& attempt, const StepReport& report);

}  // namespace tiltmap
