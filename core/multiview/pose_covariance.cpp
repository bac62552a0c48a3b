#include "core/multiview/pose_covariance.h"

#include <algorithm>

#include <Eigen/SparseCholesky>

#include "core/multiview/pose_assembly.h"

namespace tiltmap {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<Sparse>;

// The inverse where the factor of the matrix has entries. With A = L D L^T and Z = A^-1, column by column
// from the last: Z_ij = -sum over k > j of Z_ik L_kj for i > j, and Z_jj = 1 / D_j - sum of Z_jk L_kj; every
// Z_ik that is asked for is where the factor has an entry.
class SparseInverse {
 public:
  explicit SparseInverse(const Solver& solver) : factor_(solver.matrixL().nestedExpression()), z_(factor_) {
    const Eigen::Index n = factor_.cols();
    diagonal_.resize(n);
    place_ = solver.permutationP().indices();
    const Eigen::VectorXd d = solver.vectorD();
    std::vector<double> l(static_cast<std::size_t>(n), 0.0), sum(static_cast<std::size_t>(n), 0.0);
    std::vector<char> in_column(static_cast<std::size_t>(n), 0);
    for (Eigen::Index j = n - 1; j >= 0; --j) {
      for (Sparse::InnerIterator at(factor_, j); at; ++at) {
        if (at.row() <= j) continue;
        const auto row = static_cast<std::size_t>(at.row());
        l[row] = at.value();
        sum[row] = 0.0;
        in_column[row] = 1;
      }
      for (Sparse::InnerIterator at(factor_, j); at; ++at) {
        const Eigen::Index k = at.row();
        if (k <= j) continue;
        const auto column = static_cast<std::size_t>(k);
        sum[column] += diagonal_[k] * l[column];
        for (Sparse::InnerIterator z(z_, k); z; ++z) {
          const auto row = static_cast<std::size_t>(z.row());
          if (z.row() <= k || !in_column[row]) continue;
          sum[row] += z.value() * l[column];
          sum[column] += z.value() * l[row];
        }
      }
      double diagonal = 1.0 / d[j];
      for (Sparse::InnerIterator z(z_, j); z; ++z) {
        if (z.row() <= j) continue;
        const auto row = static_cast<std::size_t>(z.row());
        z.valueRef() = -sum[row];
        diagonal += sum[row] * l[row];
        in_column[row] = 0;
      }
      diagonal_[j] = diagonal;
    }
  }

  // Of the matrix as it was given.
  double operator()(Eigen::Index row, Eigen::Index column) const {
    const Eigen::Index a = place_[row], b = place_[column];
    if (a == b) return diagonal_[a];
    const int low = static_cast<int>(std::min(a, b)), high = static_cast<int>(std::max(a, b));
    const int* begin = z_.innerIndexPtr() + z_.outerIndexPtr()[low];
    const int* end = z_.innerIndexPtr() + z_.outerIndexPtr()[low + 1];
    const int* found = std::lower_bound(begin, end, high);
    return found != end && *found == high ? z_.valuePtr()[found - z_.innerIndexPtr()] : 0.0;
  }

 private:
  Sparse factor_, z_;
  Eigen::VectorXd diagonal_;
  Eigen::VectorXi place_;
};

Matrix6d blockOf(const SparseInverse& inverse, int row, int column) {
  Matrix6d block = Matrix6d::Zero();
  if (row < 0 || column < 0) return block;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) block(r, c) = inverse(6 * row + r, 6 * column + c);
  return block;
}

}  // namespace

Result<std::vector<Matrix6d>> termCovariances(std::size_t count, const std::vector<char>& held,
                                              const std::vector<PairTerm>& terms, double damping) {
  std::vector<int> unknown(count, -1);
  int unknowns = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (!held[i]) unknown[i] = unknowns++;
  std::vector<Matrix6d> covariances(terms.size(), Matrix6d::Zero());
  if (unknowns == 0) return covariances;
  PoseAssembly assembly(static_cast<std::size_t>(unknowns));
  for (int i = 0; i < unknowns; ++i) assembly.add(i, i, damping * Matrix6d::Identity());
  const auto of = [&](int pose) { return unknown[static_cast<std::size_t>(pose)]; };
  for (const PairTerm& term : terms) addTerm(term, of(term.fixed), of(term.moving), assembly);
  const Solver solver(assembly.matrix());
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0))
    return fail("the joint equations could not be solved", "links",
                "look for a link or a start pose that is far off, and disable or mend it");
  const SparseInverse inverse(solver);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const PairTerm& term = terms[k];
    const int f = of(term.fixed), m = of(term.moving);
    const Matrix6d ad = adjoint(term.fixed_from_moving);
    // d = Ad xi_moving - xi_fixed.
    const Matrix6d cross = ad * blockOf(inverse, m, f);
    const Matrix6d c =
        ad * blockOf(inverse, m, m) * ad.transpose() + blockOf(inverse, f, f) - cross - cross.transpose();
    covariances[k] = 0.5 * (c + c.transpose());
  }
  return covariances;
}

}  // namespace tiltmap
