// How firmly ties hold the poses they join, all together.
#pragma once

#include <vector>

#include "core/multiview/pose_system.h"

namespace tiltmap {

// For each term the covariance of the small motion d of its moving scan (as PairTerm has it: rotation,
// translation, fixed frame; rad^2, m^2) that all terms together leave, `held` poses being certain. A term of
// no information is welcome: it asks what the others say about its two poses. `damping` as in solvePoses; it
// must be above zero where a pose hangs on nothing. Only the covariances between poses that share a term are
// computed (the sparse inverse of Takahashi, Fagan and Chin 1973): time and memory as for solving. Error: the
// equations could not be solved.
Result<std::vector<Matrix6d>> termCovariances(std::size_t count, const std::vector<char>& held,
                                              const std::vector<PairTerm>& terms, double damping);

}  // namespace tiltmap
