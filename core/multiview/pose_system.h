// The sparse normal equations of many poses tied in pairs, and their solution.
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

// What one tie between two poses says: the quadratic form d^T h d / 2 + b^T d over a small motion d of the
// moving scan on the left of fixed_from_moving (rotation, translation; Pose::moved, fixed frame). h in rad^-2
// and m^-2; it may lack rank.
struct PairTerm {
  int fixed = 0;
  int moving = 0;
  Pose fixed_from_moving;  // where it was linearised
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
};

// Carries a small motion on the right of the pose to the left of it: T Exp(xi) = Exp(Ad xi) T.
Matrix6d adjoint(const Pose& pose);

// The term of a relative pose measured with the given information: its minimum is at `measured`.
PairTerm measuredPoseTerm(int fixed, int moving, const Pose& fixed_from_moving,
                          const Pose& measured_fixed_from_moving, const Matrix6d& information);

// The same quadratic form, about another relative pose near its own.
PairTerm carriedTerm(const PairTerm& term, const Pose& fixed_from_moving);

// One Gauss-Newton step of all poses: the small motions xi_i (rotation, translation), one a pose, each on the
// right of its pose, world_from_i * Pose().moved(xi_i), that minimise the sum of the terms; to first order
// the motion of a term is d = Ad(fixed_from_moving) xi_moving - xi_fixed. Motions of `held` poses are zero.
// Expressed in each scan's own frame the numbers stay small wherever the scans are. `damping` (m^-2, rad^-2)
// is added to each diagonal: what no term determines does not move. Block-sparse Cholesky: memory and time
// grow with the ties, not with the square of the poses. Error: the equations could not be solved.
Result<std::vector<Vector6d>> solvePoses(std::size_t count, const std::vector<char>& held,
                                         const std::vector<PairTerm>& terms, double damping);

// Which poses are tied to a held one through terms, directly or not.
std::vector<char> tiedToHeld(std::size_t count, const std::vector<char>& held,
                             const std::vector<PairTerm>& terms);

}  // namespace tiltmap
