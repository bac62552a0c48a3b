// The normal equations of poses and scanner errors together, and what they know.
#pragma once

#include <span>
#include <vector>

#include "core/calibration/scanner_errors.h"
#include "core/registration/cell_refinement.h"
#include "core/registration/prepared_scan.h"

namespace tiltmap {

// One pair of scans, linearised: sums over the cells of one scan on the patches of the other, of a motion d
// on the left of fixed_from_moving (rotation, translation; Pose::moved) and a change of the scanner's errors,
// the same in both scans.
struct CalibrationTerm {
  int fixed = 0;
  int moving = 0;
  Pose fixed_from_moving;
  Matrix6d h_pose = Matrix6d::Zero();
  Eigen::Matrix<double, 6, kScannerErrors> h_mixed = Eigen::Matrix<double, 6, kScannerErrors>::Zero();
  ErrorMatrix h_errors = ErrorMatrix::Zero();
  Vector6d b_pose = Vector6d::Zero();
  ErrorVector b_errors = ErrorVector::Zero();
  std::vector<double> residual_m;   // |residual|, one a patch
  std::vector<double> variance_m2;  // of it, from cells and patch alone
};

// Residual: along the patch's normal, from its plane to the mean of the cells on it. A change of the
// scanner's errors moves the cells, and the surface that the patch stands for there as well: to first order
// what remains is the difference of the two scans' motions at that place, so the bending of the patch needs
// no equation of its own. Weights as lineariseCells; `excess_m` and `deviations` likewise. Both scans have
// `geometry`.
CalibrationTerm calibrationTerm(int fixed, int moving, const PreparedScan& fixed_scan,
                                const PreparedScan& moving_scan, const ScannerGeometry& geometry,
                                const Pose& fixed_from_moving, const std::vector<CellsOnPatch>& cells,
                                double excess_m, double deviations);

// What is not known from the scans at all: deviations of the errors about their present departure from what
// was stored.
struct ErrorPrior {
  ErrorVector departure = ErrorVector::Zero();
  ErrorVector deviation = ErrorVector::Zero();
};

struct CalibrationSolution {
  std::vector<Vector6d> motions;  // of each pose, on its right (rotation, translation); scan 0 stays
  ErrorVector change = ErrorVector::Zero();
  // Rows and columns of errors that are not free are zero.
  ErrorMatrix covariance = ErrorMatrix::Zero();  // from the residuals' own variances, poses free
  ErrorMatrix robust = ErrorMatrix::Zero();      // from how the pairs of scans contradict each other
  ErrorVector alone = ErrorVector::Zero();       // deviation if the poses and all other errors were known
};

// One Gauss-Newton step of `count` poses, the first held, and the errors named free; what the prior says of
// them added. Error: the equations could not be solved.
Result<CalibrationSolution> solveCalibration(std::size_t count, std::span<const CalibrationTerm> terms,
                                             const std::vector<ScannerError>& free, const ErrorPrior& prior);

}  // namespace tiltmap
