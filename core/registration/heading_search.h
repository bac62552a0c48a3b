// A pair whose registration came out bad is tried from every heading: an odometry may be a quarter turn off.
#pragma once

#include "core/registration/pair_judgement.h"

namespace tiltmap {

// A pair as it came out, and whether it can be trusted.
struct SearchedPair {
  PairResult result;
  PairJudgement judgement;  // how far it moved is told from the start given
  bool searched = false;    // other headings than those of registerPair were tried
};

// registerPair from the start given. Where its verdict is bad (pair_judgement.h), the pair is registered from
// the moving scan's other headings too, all round in twelfths of a turn at the place given; of those whose
// verdict, but for how far they moved, is good the one with most in common is taken, unless half as much or
// more is common at another place too: of two such places nobody knows which is right. `retry_agreement` 0
// switches it off. The same bits on every run and thread. `fixed` and `moving` judged from the scans prepared
// with `settings`. Error: as registerPair.
Result<SearchedPair> registerAndSearch(const PreparedScanPtr& fixed, const PreparedScanPtr& moving,
                                       const JudgedScan& judged_fixed, const JudgedScan& judged_moving,
                                       const Pose& start_fixed_from_moving,
                                       const RegistrationSettings& settings, const JobControl& control = {});

}  // namespace tiltmap
