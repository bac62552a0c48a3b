#include "core/registration/register_pair.h"
#include "tests/benchmarks/pair_method.h"

namespace tiltmap::benchmarks {

namespace {

PairMethod ownMethod(const std::string& preset) {
  return {"Tiltmap " + preset, [preset](const PairProblem& pair) -> TimedJob {
            const RegistrationSettings settings = *registrationParameters().presetSettings(preset);
            return [fixed = pair.fixed, moving = pair.moving, start = pair.start_fixed_from_moving,
                    settings]() -> Result<Pose> {
              const Result<PairResult> result = registerPair(fixed, moving, start, settings);
              if (!result) return fail(result.error());
              if (!result->succeeded())
                return fail(stopReasonName(result->stop_reason), "", stopReasonSentence(result->stop_reason));
              return result->fixed_from_moving;
            };
          }};
}

}  // namespace

std::vector<PairMethod> ownMethods() {
  return {ownMethod("default"), ownMethod("thesis")};
}

}  // namespace tiltmap::benchmarks
