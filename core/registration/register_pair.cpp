#include "core/registration/register_pair.h"

#include <chrono>

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

Result<PairResult> run(const PreparedScanPtr& fixed, const PreparedScanPtr& moving, const Pose& start,
                       const RegistrationSettings& settings, const JobControl& control,
                       Clock::time_point begin) {
  Registration registration(fixed, moving, start, settings);
  PairResult result;
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
  result.warnings = fixed->warnings;
  result.warnings.insert(result.warnings.end(), moving->warnings.begin(), moving->warnings.end());
  if (result.stop_reason != StopReason::Converged && result.stop_reason != StopReason::TinyMotion)
    result.warnings.push_back(stopReasonName(result.stop_reason) + ": " +
                              stopReasonSentence(result.stop_reason));
  result.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return result;
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
