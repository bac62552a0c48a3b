#include "core/registration/register_pair.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

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

PairResult resultOf(const Registration& registration, const PairAttempt& attempt,
                    std::vector<StepReport> steps) {
  PairResult result;
  result.start = attempt.start;
  result.stop_reason = *registration.stopReason();
  result.fixed_from_moving = registration.fixedFromMoving();
  result.iterations = registration.iterations();
  result.correspondences = registration.keptPairs();
  result.rms_m = registration.rms();
  result.overlap = registration.overlap();
  result.agreement = registration.agreement();
  result.information = registration.information();
  result.condition = registration.condition();
  result.steps = std::move(steps);
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

Result<PairResult> run(const PreparedScanPtr& fixed, const PreparedScanPtr& moving, const Pose& start,
                       const RegistrationSettings& settings, const JobControl& control,
                       Clock::time_point begin) {
  PairRegistration registration(fixed, moving, start, settings);
  while (!registration.done()) {
    registration.step(control.stop);
    if (registration.cancelled()) return cancelled();
    control.tell(static_cast<double>(registration.registration().iterations()) / settings.max_iterations,
                 "registering");
  }
  PairResult result = registration.result();
  result.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return result;
}

}  // namespace

PairRegistration::PairRegistration(PreparedScanPtr fixed, PreparedScanPtr moving,
                                   const Pose& start_fixed_from_moving, const RegistrationSettings& settings)
    : fixed_(std::move(fixed)),
      moving_(std::move(moving)),
      settings_(settings),
      plan_{{AttemptKind::Given, start_fixed_from_moving, 0.0}} {
  current_.emplace(fixed_, moving_, start_fixed_from_moving, settings_);
}

const PairAttempt& PairRegistration::attempt() const {
  if (next_ == 0) throw std::logic_error("PairRegistration::attempt: no step was taken");
  return plan_[next_ - 1];
}

const Registration& PairRegistration::registration() const {
  if (next_ == 0) throw std::logic_error("PairRegistration::registration: no step was taken");
  return *current_;
}

PairResult PairRegistration::result() const {
  if (!done() || cancelled_) throw std::logic_error("PairRegistration::result: there is none");
  return *best_;
}

StepReport PairRegistration::step(const std::stop_token& stop) {
  if (done()) throw std::logic_error("PairRegistration::step: the registration has ended");
  if (next_ == 0 || current_->done()) begin(plan_[next_]);
  StepReport report = current_->step(stop);
  steps_.push_back(report);
  if (current_->done()) conclude();
  return report;
}

void PairRegistration::begin(const PairAttempt& attempt) {
  ++next_;
  steps_.clear();
  if (attempt.kind == AttemptKind::Given) return;  // made with this
  if (attempt.kind == AttemptKind::Cubes) {
    settings_.patch_grouping = PatchGrouping::Cubes;
    fixed_ = prepare(fixed_->scan, settings_);
    moving_ = prepare(moving_->scan, settings_);
  }
  current_.emplace(fixed_, moving_, attempt.start, settings_);
}

// Whether the result of the present attempt stands against the best one before.
bool PairRegistration::takes(const PairResult& result) const {
  if (!best_) return true;
  if (attempt().kind == AttemptKind::Cubes) return result.succeeded() || !best_->succeeded();
  // Another heading must leave no doubt of its own, or two strange scans would be talked into a fit.
  return result.agreement >= settings_.retry_agreement && fit(result) > fit(*best_);
}

void PairRegistration::conclude() {
  if (*current_->stopReason() == StopReason::Cancelled) {
    cancelled_ = true;
    plan_.resize(next_);
    return;
  }
  PairResult result = resultOf(*current_, attempt(), std::move(steps_));
  steps_.clear();
  if (takes(result)) {
    best_ = std::move(result);
    chosen_ = next_ - 1;
  }
  if (attempt().kind == AttemptKind::Given) planCubes();
  if (next_ == plan_.size() && attempt().kind != AttemptKind::OtherHeading) planHeadings();
  if (next_ < plan_.size()) return;
  best_->retries = static_cast<int>(
      std::ranges::count(plan_, AttemptKind::OtherHeading, [](const PairAttempt& a) { return a.kind; }));
  best_->warnings = fixed_->warnings;
  best_->warnings.insert(best_->warnings.end(), moving_->warnings.begin(), moving_->warnings.end());
  if (best_->stop_reason != StopReason::Converged && best_->stop_reason != StopReason::TinyMotion)
    best_->warnings.push_back(stopReasonName(best_->stop_reason) + ": " +
                              stopReasonSentence(best_->stop_reason));
}

void PairRegistration::planCubes() {
  if (wantsCubes(*fixed_, *moving_, *best_, settings_))
    plan_.push_back({AttemptKind::Cubes, plan_.front().start, 0.0});
}

void PairRegistration::planHeadings() {
  if (best_->agreement >= settings_.retry_agreement || fixed_->elements.empty() || moving_->elements.empty())
    return;
  for (const double turns : {1.0, -1.0, 2.0, -2.0}) {
    const double turned = turns * settings_.retry_heading_rad;
    plan_.push_back(
        {AttemptKind::OtherHeading, plan_.front().start * Pose::planar(0.0, 0.0, turned), turned});
  }
}

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
