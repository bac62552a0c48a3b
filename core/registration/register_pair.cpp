#include "core/registration/register_pair.h"

#include <chrono>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace tiltmap {

namespace {

using Clock = std::chrono::steady_clock;

Status checkStart(const Pose& start, const RegistrationSettings& settings) {
  if (Status status = checkSettings(settings); !status) return status;
  if (!start.isFinite())
    return fail("the start pose is not finite", "register",
                "give the pair an odometry or a start of numbers");
  return {};
}

tl::unexpected<Error> cancelled() {
  return fail(kCancelled, "register", "start it again to register this pair");
}

Result<PairResult> runFrom(const PreparedScanPtr& fixed, const PreparedScanPtr& moving, const Pose& start,
                           const RegistrationSettings& settings, const JobControl& control) {
  Registration registration(fixed, moving, start, settings);
  PairResult result;
  result.start = start;
  while (!registration.done()) {
    result.steps.push_back(registration.step(control.stop));
    control.tell(static_cast<double>(result.steps.size()) / settings.max_iterations, "registering");
  }
  result.stop_reason = *registration.stopReason();
  if (result.stop_reason == StopReason::Cancelled) return cancelled();
  result.fixed_from_moving = registration.fixedFromMoving();
  result.iterations = registration.iterations();
  result.correspondences = registration.keptPairs();
  result.rms_m = registration.rms();
  result.overlap = registration.overlap();
  result.agreement = registration.agreement();
  result.information = registration.information();
  result.condition = registration.condition();
  return result;
}

// How well a result fits; nothing that failed is as good as anything that did not.
double fit(const PairResult& result) {
  return result.succeeded() ? result.overlap * result.agreement : -1.0;
}

// Standard deviation of the translation in its worst direction; infinite where one is free.
double worstDeviation(const PairResult& result) {
  const Eigen::FullPivLU<Matrix6d> information(result.information);
  if (!information.isInvertible()) return std::numeric_limits<double>::infinity();
  const Eigen::Matrix3d covariance = information.inverse().bottomRightCorner<3, 3>();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()[2]);
}

bool wantsCubes(const PreparedScan& fixed, const PreparedScan& moving, const PairResult& result,
                const RegistrationSettings& settings) {
  if (settings.patch_grouping != PatchGrouping::Auto || !fixed.scan.image || !moving.scan.image) return false;
  if (!fixed.raster && !moving.raster) return false;
  return !result.succeeded() || result.agreement < settings.retry_agreement ||
         worstDeviation(result) > settings.retry_deviation_m;
}

Result<PairResult> run(PreparedScanPtr fixed, PreparedScanPtr moving, const Pose& start,
                       RegistrationSettings settings, const JobControl& control, Clock::time_point begin) {
  auto best = runFrom(fixed, moving, start, settings, control);
  if (!best) return best;
  if (wantsCubes(*fixed, *moving, *best, settings)) {
    settings.patch_grouping = PatchGrouping::Cubes;
    fixed = prepare(fixed->scan, settings);
    moving = prepare(moving->scan, settings);
    auto result = runFrom(fixed, moving, start, settings, control);
    if (!result) return result;
    if (result->succeeded() || !best->succeeded()) best = std::move(result);
  }
  int retries = 0;
  if (best->agreement < settings.retry_agreement && !fixed->elements.empty() && !moving->elements.empty()) {
    for (const double turns : {1.0, -1.0, 2.0, -2.0}) {
      const Pose other = start * Pose::planar(0.0, 0.0, turns * settings.retry_heading_rad);
      auto result = runFrom(fixed, moving, other, settings, control);
      if (!result) return result;
      ++retries;
      // Another heading must leave no doubt of its own, or two strange scans would be talked into a fit.
      if (result->agreement >= settings.retry_agreement && fit(*result) > fit(*best))
        best = std::move(result);
    }
  }
  best->retries = retries;
  best->warnings = fixed->warnings;
  best->warnings.insert(best->warnings.end(), moving->warnings.begin(), moving->warnings.end());
  if (best->stop_reason != StopReason::Converged && best->stop_reason != StopReason::TinyMotion)
    best->warnings.push_back(stopReasonName(best->stop_reason) + ": " +
                             stopReasonSentence(best->stop_reason));
  best->milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return best;
}

}  // namespace

Result<PairResult> registerPair(const Scan& fixed, const Scan& moving, const Pose& start_fixed_from_moving,
                                const RegistrationSettings& settings, const JobControl& control) {
  const Clock::time_point begin = Clock::now();
  if (Status status = checkStart(start_fixed_from_moving, settings); !status) return fail(status.error());
  const PreparedScanPtr prepared_fixed = prepare(fixed, settings);
  if (control.stopRequested()) return cancelled();
  const PreparedScanPtr prepared_moving = prepare(moving, settings);
  return run(prepared_fixed, prepared_moving, start_fixed_from_moving, settings, control, begin);
}

Result<PairResult> registerPair(const PreparedScanPtr& fixed, const PreparedScanPtr& moving,
                                const Pose& start_fixed_from_moving, const RegistrationSettings& settings,
                                const JobControl& control) {
  const Clock::time_point begin = Clock::now();
  if (Status status = checkStart(start_fixed_from_moving, settings); !status) return fail(status.error());
  return run(fixed, moving, start_fixed_from_moving, settings, control, begin);
}

}  // namespace tiltmap
