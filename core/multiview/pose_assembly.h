// The normal equations of poses tied in pairs, put together block by block. Only for the .cpp files that
// solve them.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "core/multiview/pose_system.h"

namespace tiltmap {

class PoseAssembly {
 public:
  explicit PoseAssembly(std::size_t unknowns)
      : right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * unknowns))) {}

  // Only the lower triangle is kept.
  void add(int row, int column, const Matrix6d& block) {
    for (int c = 0; c < 6; ++c)
      for (int r = row == column ? c : 0; r < 6; ++r)
        triplets_.emplace_back(6 * row + r, 6 * column + c, block(r, c));
  }
  void addRight(int row, const Vector6d& part) { right_.segment<6>(6 * row) += part; }
  Eigen::SparseMatrix<double> matrix() const {
    Eigen::SparseMatrix<double> result(right_.size(), right_.size());
    result.setFromTriplets(triplets_.begin(), triplets_.end());
    return result;
  }
  const Eigen::VectorXd& right() const { return right_; }

 private:
  std::vector<Eigen::Triplet<double>> triplets_;
  Eigen::VectorXd right_;
};

// `fixed` and `moving`: which unknown each pose is, -1 for a held one.
inline void addTerm(const PairTerm& term, int fixed, int moving, PoseAssembly& assembly) {
  const Matrix6d ad = adjoint(term.fixed_from_moving);
  const Matrix6d h_ad = term.h * ad;
  if (fixed >= 0) {
    assembly.add(fixed, fixed, term.h);
    assembly.addRight(fixed, -term.b);
  }
  if (moving >= 0) {
    assembly.add(moving, moving, ad.transpose() * h_ad);
    assembly.addRight(moving, ad.transpose() * term.b);
  }
  if (fixed < 0 || moving < 0) return;
  if (fixed > moving)
    assembly.add(fixed, moving, -h_ad);
  else
    assembly.add(moving, fixed, -h_ad.transpose());
}

}  // namespace tiltmap
