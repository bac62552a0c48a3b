// Registering many pairs of a project's scans: the work of `register`, the whole of it or a part.
#pragma once

#include <string>
#include <vector>

#include "core/base/parameter.h"
#include "core/base/progress.h"
#include "core/project/operation.h"
#include "core/project/operations/pair_list.h"
#include "core/registration/pair_judgement.h"
#include "core/registration/register_pair.h"

namespace tiltmap {

struct RegisterSettings {
  RegistrationSettings registration;
  std::string pairs;  // as parsePairList reads them
  int threads = 0;
};
const ParameterTable<RegisterSettings>& registerParameters();

// Two scans or more, pairs that are there, settings that make sense.
Status checkRegister(const ProjectSnapshot& snapshot, const RegisterSettings& settings);

// A pair as it came out, and whether it can be trusted.
struct RegisteredPair {
  int fixed = 0;  // indices
  int moving = 0;
  PairResult result;  // without its steps
  PairJudgement judgement;
  double milliseconds = 0.0;  // from the two raw matrices to the pose
};

// Each pair from its odometry; a scan is prepared once and let go after the last pair that needs it, so that
// memory does not grow with the survey. What comes out of a pair depends on its two scans and the settings
// alone: neither on the threads nor on the other pairs. Error: a matrix that cannot be read, cancelled.
Result<std::vector<RegisteredPair>> registerPairs(const ProjectSnapshot& snapshot,
                                                  const std::vector<IndexPair>& pairs,
                                                  const RegisterSettings& settings,
                                                  const JobControl& control);

// What `register` makes of them: links, poses, report and warnings. `milliseconds`: of the whole work.
OperationResult registeredOutcome(const SnapshotPtr& snapshot, const std::vector<RegisteredPair>& pairs,
                                  double milliseconds);

// The report's JSON of the pairs alone: an array as text.
std::string registeredPairsJson(const std::vector<RegisteredPair>& pairs);

}  // namespace tiltmap
