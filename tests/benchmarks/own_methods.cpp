#include "core/registration/register_pair.h"
#include "tests/benchmarks/pair_method.h"

namespace tiltmap::benchmarks {

PairMethod ownMethod(const std::string& name, const RegistrationSettings& settings) {
  return {name, [settings](const PairProblem& pair) -> TimedJob {
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

std::vector<PairMethod> ownMethods() {
  std::vector<PairMethod> methods;
  for (const char* preset : {"default", "thesis"})
    methods.push_back(
        ownMethod(std::string("Tiltmap ") + preset, *registrationParameters().presetSettings(preset)));
  return methods;
}

}  // namespace tiltmap::benchmarks
