// The links of a project judged by their scans: each pair of scans held against each other anew.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/project/project_snapshot.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

struct JudgedLink {
  LinkId link = 0;
  PairJudgement judgement;  // at the link's own pose; how far it moved is told from the odometry
};

// By id, as the snapshot has them; disabled links too. Each scan is read and prepared once (some 10 ms), a
// pair takes about 1 ms. The result does not depend on `threads` (0: all cores). Error: cancelled, or a
// matrix cannot be read.
Result<std::vector<JudgedLink>> judgeLinkScans(const ProjectSnapshot& snapshot, int threads = 0,
                                               const JudgementSettings& settings = {},
                                               const JobControl& control = {});

}  // namespace tiltmap
