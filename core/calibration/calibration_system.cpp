#include "core/calibration/calibration_system.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "core/multiview/pose_system.h"

namespace tiltmap {

namespace {

using ErrorRow = Eigen::Matrix<double, 1, kScannerErrors>;

// Held by no term at all, a pose stays.
constexpr double kDamping = 1.0;

class Assembly {
 public:
  Assembly(std::size_t poses, const std::vector<ScannerError>& free)
      : free_(free),
        errors_at_(6 * (static_cast<Eigen::Index>(poses) - 1)),
        size_(errors_at_ + static_cast<Eigen::Index>(free.size())),
        h_(Eigen::MatrixXd::Zero(size_, size_)),
        b_(Eigen::VectorXd::Zero(size_)) {
    h_.diagonal().head(errors_at_).setConstant(kDamping);
  }

  void add(const CalibrationTerm& term) {
    // d = Ad(fixed_from_moving) xi_moving - xi_fixed, motions on the right of the poses.
    const Matrix6d ad = adjoint(term.fixed_from_moving);
    const Eigen::Index f = placeOf(term.fixed), m = placeOf(term.moving);
    if (f >= 0) h_.block<6, 6>(f, f) += term.h_pose;
    if (m >= 0) h_.block<6, 6>(m, m) += ad.transpose() * term.h_pose * ad;
    if (f >= 0 && m >= 0) {
      const Matrix6d mixed = -term.h_pose * ad;
      h_.block<6, 6>(f, m) += mixed;
      h_.block<6, 6>(m, f) += mixed.transpose();
    }
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const int error = static_cast<int>(free_[k]);
      const Eigen::Index at = errors_at_ + static_cast<Eigen::Index>(k);
      const Vector6d column = term.h_mixed.col(error);
      if (f >= 0) addMixed(f, at, -column);
      if (m >= 0) addMixed(m, at, ad.transpose() * column);
      for (std::size_t l = 0; l < free_.size(); ++l)
        h_(at, errors_at_ + static_cast<Eigen::Index>(l)) += term.h_errors(error, static_cast<int>(free_[l]));
    }
    b_ += score(term);
  }

  // The gradient of one term alone.
  Eigen::VectorXd score(const CalibrationTerm& term) const {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(size_);
    const Eigen::Index f = placeOf(term.fixed), m = placeOf(term.moving);
    if (f >= 0) g.segment<6>(f) = -term.b_pose;
    if (m >= 0) g.segment<6>(m) = adjoint(term.fixed_from_moving).transpose() * term.b_pose;
    for (std::size_t k = 0; k < free_.size(); ++k)
      g[errors_at_ + static_cast<Eigen::Index>(k)] = term.b_errors[static_cast<int>(free_[k])];
    return g;
  }

  void add(const ErrorPrior& prior) {
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const int error = static_cast<int>(free_[k]);
      const Eigen::Index at = errors_at_ + static_cast<Eigen::Index>(k);
      const double information = 1.0 / (prior.deviation[error] * prior.deviation[error]);
      h_(at, at) += information;
      b_[at] += information * prior.departure[error];
    }
  }

  const Eigen::MatrixXd& h() const { return h_; }
  const Eigen::VectorXd& b() const { return b_; }
  Eigen::Index errorsAt() const { return errors_at_; }
  Eigen::Index size() const { return size_; }

 private:
  static Eigen::Index placeOf(int scan) { return scan == 0 ? -1 : 6 * (static_cast<Eigen::Index>(scan) - 1); }
  void addMixed(Eigen::Index pose, Eigen::Index error, const Vector6d& column) {
    h_.block<6, 1>(pose, error) += column;
    h_.block<1, 6>(error, pose) += column.transpose();
  }

  const std::vector<ScannerError>& free_;
  Eigen::Index errors_at_, size_;
  Eigen::MatrixXd h_;
  Eigen::VectorXd b_;
};

// The covariance of an estimate from pairs whose residuals belong together wherever they share a scan
// (Aronow, Samii and Assenova 2015, for dyads): sum over scans of the square of their pairs' sum, less the
// squares of the pairs. `influence`: a column a term.
Eigen::MatrixXd pairwiseCovariance(std::size_t scans, std::span<const CalibrationTerm> terms,
                                   const Eigen::MatrixXd& influence) {
  const Eigen::Index k = influence.rows();
  Eigen::MatrixXd of_scan = Eigen::MatrixXd::Zero(k, static_cast<Eigen::Index>(scans));
  for (std::size_t t = 0; t < terms.size(); ++t) {
    of_scan.col(terms[t].fixed) += influence.col(static_cast<Eigen::Index>(t));
    of_scan.col(terms[t].moving) += influence.col(static_cast<Eigen::Index>(t));
  }
  const Eigen::MatrixXd by_pair = influence * influence.transpose();
  const Eigen::MatrixXd by_scan = of_scan * of_scan.transpose() - by_pair;
  // The second may come out too small, or negative, where scans are few: never less than the first.
  Eigen::MatrixXd result = by_pair;
  for (Eigen::Index i = 0; i < k; ++i)
    if (by_scan(i, i) > by_pair(i, i)) result(i, i) = by_scan(i, i);
  return result;
}

}  // namespace

CalibrationTerm calibrationTerm(int fixed, int moving, const PreparedScan& fixed_scan,
                                const PreparedScan& moving_scan, const ScannerGeometry& geometry,
                                const Pose& fixed_from_moving, const std::vector<CellsOnPatch>& cells,
                                double excess_m, double deviations) {
  CalibrationTerm term;
  term.fixed = fixed;
  term.moving = moving;
  term.fixed_from_moving = fixed_from_moving;
  const Eigen::Matrix3d rotation = fixed_from_moving.rotation(), back = rotation.transpose();
  const Eigen::Vector3d shift = fixed_from_moving.translation();
  for (const CellsOnPatch& on : cells) {
    const SurfaceElements& elements = on.of_fixed ? fixed_scan.elements : moving_scan.elements;
    const PatchShape& shape = elements.shape[on.patch];
    // The cells' mean as both scans see it.
    const Eigen::Vector3d in_fixed = on.of_fixed ? rotation * on.mean + shift : on.mean;
    const Eigen::Vector3d in_moving = on.of_fixed ? on.mean : back * (on.mean - shift);
    const auto moves_fixed = errorMotions(geometry, in_fixed);
    const auto moves_moving = errorMotions(geometry, in_moving);
    if (!moves_fixed || !moves_moving) continue;
    const Eigen::Vector3d d = (on.of_fixed ? in_fixed : in_moving) - elements.position[on.patch];
    const double u = d.dot(shape.u), v = d.dot(shape.v);
    const double own = on.variance_m2 + shape.offset_variance_m2 + u * u * shape.tilt_variance_u +
                       v * v * shape.tilt_variance_v;
    const double variance = own + excess_m * excess_m;
    const double r = elements.normal[on.patch].dot(d);
    // Both directions rest on the same cells, as in lineariseCells.
    const double w = 0.5 * gemanMcClureWeight(r * r, deviations * deviations * variance) / variance;
    const Eigen::Vector3d normal =
        on.of_fixed ? elements.normal[on.patch] : Eigen::Vector3d(-(rotation * elements.normal[on.patch]));
    Vector6d j;
    j << in_fixed.cross(normal), normal;
    const ErrorRow e = normal.transpose() * (rotation * *moves_moving - *moves_fixed);
    term.h_pose += w * j * j.transpose();
    term.h_mixed += w * j * e;
    term.h_errors += w * e.transpose() * e;
    term.b_pose += w * r * j;
    term.b_errors += w * r * e.transpose();
    term.residual_m.push_back(std::abs(r));
    term.variance_m2.push_back(own);
  }
  return term;
}

Result<CalibrationSolution> solveCalibration(std::size_t count, std::span<const CalibrationTerm> terms,
                                             const std::vector<ScannerError>& free, const ErrorPrior& prior) {
  Assembly assembly(count, free);
  for (const CalibrationTerm& term : terms) assembly.add(term);
  assembly.add(prior);
  const Eigen::LDLT<Eigen::MatrixXd> solver(assembly.h());
  const Eigen::VectorXd step = solver.solve(-assembly.b());
  if (solver.info() != Eigen::Success || !step.allFinite())
    return fail("the equations of the calibration could not be solved", "calibration",
                "relax the survey again, or leave out scans that stand far off");
  CalibrationSolution solution;
  solution.motions.assign(count, Vector6d::Zero());
  for (std::size_t i = 1; i < count; ++i)
    solution.motions[i] = step.segment<6>(6 * (static_cast<Eigen::Index>(i) - 1));

  if (free.empty()) return solution;

  const auto k = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd ends = Eigen::MatrixXd::Zero(assembly.size(), k);
  ends.bottomRows(k).setIdentity();
  const Eigen::MatrixXd inverse = solver.solve(ends);
  Eigen::MatrixXd influence(k, static_cast<Eigen::Index>(terms.size()));
  for (std::size_t t = 0; t < terms.size(); ++t)
    influence.col(static_cast<Eigen::Index>(t)) = inverse.transpose() * assembly.score(terms[t]);
  const Eigen::MatrixXd robust = pairwiseCovariance(count, terms, influence);
  for (Eigen::Index a = 0; a < k; ++a) {
    const int error = static_cast<int>(free[static_cast<std::size_t>(a)]);
    const Eigen::Index at = assembly.errorsAt() + a;
    solution.change[error] = step[at];
    solution.alone[error] = 1.0 / std::sqrt(assembly.h()(at, at));
    for (Eigen::Index c = 0; c < k; ++c) {
      const int other = static_cast<int>(free[static_cast<std::size_t>(c)]);
      solution.covariance(error, other) = inverse(assembly.errorsAt() + a, c);
      solution.robust(error, other) = robust(a, c);
    }
  }
  return solution;
}

}  // namespace tiltmap
