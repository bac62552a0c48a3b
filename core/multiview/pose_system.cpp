#include "core/multiview/pose_system.h"

#include <Eigen/SparseCholesky>

#include "core/multiview/pose_assembly.h"

namespace tiltmap {

Matrix6d adjoint(const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.rotation();
  const Eigen::Vector3d& t = pose.translation();
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = rotation;
  ad.bottomLeftCorner<3, 3>() = cross * rotation;
  ad.bottomRightCorner<3, 3>() = rotation;
  return ad;
}

PairTerm measuredPoseTerm(int fixed, int moving, const Pose& fixed_from_moving,
                          const Pose& measured_fixed_from_moving, const Matrix6d& information) {
  return carriedTerm({fixed, moving, measured_fixed_from_moving, information, Vector6d::Zero()},
                     fixed_from_moving);
}

PairTerm carriedTerm(const PairTerm& term, const Pose& fixed_from_moving) {
  // term.fixed_from_moving.moved(off) is the new pose.
  const Pose motion = fixed_from_moving * term.fixed_from_moving.inverse();
  Vector6d off;
  off << rotationLog(motion.quaternion()), motion.translation();
  return {term.fixed, term.moving, fixed_from_moving, term.h, term.b + term.h * off};
}

Result<std::vector<Vector6d>> solvePoses(std::size_t count, const std::vector<char>& held,
                                         const std::vector<PairTerm>& terms, double damping) {
  std::vector<int> unknown(count, -1);
  int unknowns = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!held[i]) unknown[i] = unknowns++;
  std::vector<Vector6d> motions(count, Vector6d::Zero());
  if (unknowns == 0) return motions;

  PoseAssembly assembly(static_cast<std::size_t>(unknowns));
  for (int i = 0; i < unknowns; ++i) assembly.add(i, i, damping * Matrix6d::Identity());
  for (const PairTerm& term : terms)
    addTerm(term, unknown[static_cast<std::size_t>(term.fixed)],
            unknown[static_cast<std::size_t>(term.moving)], assembly);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(assembly.matrix());
  const auto refuse = [] {
    return fail("the joint equations could not be solved", "relax",
                "look for a link or a start pose that is far off, and disable or mend it");
  };
  if (solver.info() != Eigen::Success) return refuse();
  const Eigen::VectorXd solution = solver.solve(-assembly.right());
  if (!solution.allFinite()) return refuse();
  for (std::size_t i = 0; i < count; ++i)
    if (unknown[i] >= 0) motions[i] = solution.segment<6>(6 * unknown[i]);
  return motions;
}

std::vector<char> tiedToHeld(std::size_t count, const std::vector<char>& held,
                             const std::vector<PairTerm>& terms) {
  std::vector<std::vector<int>> ties(count);
  for (const PairTerm& term : terms) {
    ties[static_cast<std::size_t>(term.fixed)].push_back(term.moving);
    ties[static_cast<std::size_t>(term.moving)].push_back(term.fixed);
  }
  std::vector<char> tied(count, 0);
  std::vector<int> open;
  for (std::size_t i = 0; i < count; ++i) {
    if (!held[i]) continue;
    tied[i] = 1;
    open.push_back(static_cast<int>(i));
  }
  while (!open.empty()) {
    const int at = open.back();
    open.pop_back();
    for (const int next : ties[static_cast<std::size_t>(at)]) {
      if (tied[static_cast<std::size_t>(next)]) continue;
      tied[static_cast<std::size_t>(next)] = 1;
      open.push_back(next);
    }
  }
  return tied;
}

}  // namespace tiltmap
