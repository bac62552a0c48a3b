// Pairs of a project judged by their scans, many at once.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/project/project_edit.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

struct PairToJudge {
  std::size_t fixed = 0, moving = 0;  // scans by index
  PairClaim claim;
};

// In the order given. `scan` makes one scan ready to be judged (any thread, each index once in a while); only
// those of some pairs are kept at a time. A pair takes about 1 ms. The result does not depend on `threads`
// (0: all cores). Error: cancelled, or of `scan`.
Result<std::vector<PairJudgement>> judgePairs(const std::vector<PairToJudge>& pairs,
                                              const std::function<Result<JudgedScanPtr>(std::size_t)>& scan,
                                              int threads = 0, const JudgementSettings& settings = {},
                                              const JobControl& control = {});

struct JudgedLink {
  LinkId link = 0;
  PairJudgement judgement;  // at the link's own pose
};

// These links, disabled ones too; all where none are named. How far a pose moved is told from where its
// registration began, where an earlier judgement knows that, else from the odometry. Error: cancelled, a link
// that is not there, or a matrix cannot be read.
Result<std::vector<JudgedLink>> judgeLinkScans(const ProjectSnapshot& snapshot, int threads = 0,
                                               const JudgementSettings& settings = {},
                                               const JobControl& control = {},
                                               const std::vector<LinkId>& links = {});

// Keeps them with their links.
ProjectEdit storeJudgementsEdit(const SnapshotPtr& base, const std::vector<JudgedLink>& judged);

}  // namespace tiltmap
