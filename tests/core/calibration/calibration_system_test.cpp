// The normal equations against scans of a room whose scanner's errors are known, without noise.
#include "core/calibration/calibration_system.h"

#include <gtest/gtest.h>

#include "tests/support/room_scene.h"

namespace tiltmap {
namespace {

constexpr double kSmallAngle = 0.05 * kDegree, kSmallLength = 0.002;

ErrorVector small(ScannerError error) {
  return (isAngle(error) ? kSmallAngle : kSmallLength) * ErrorVector::Unit(static_cast<int>(error));
}

RegistrationSettings thin() {
  RegistrationSettings s;
  s.patch_spot_rad = 0.0;
  s.patch_grouping = PatchGrouping::Blocks;
  return s;
}

std::vector<Pose> stops() {
  return {Pose(), Pose::planar(1.0, 0.5, 0.3), Pose::planar(-1.0, 1.0, -0.4), Pose::planar(0.3, -1.0, 0.7)};
}

// Every pair at the true poses, the scans read with the geometry that knows nothing of the errors.
std::vector<CalibrationTerm> termsWith(const ErrorVector& errors) {
  const ScannerGeometry nominal, really = corrected(nominal, errors);
  const std::vector<Pose> poses = stops();
  std::vector<PreparedScanPtr> scans;
  for (const Pose& pose : poses)
    scans.push_back(
        prepare(test_support::sceneScan(test_support::roomScene(), pose, 0.0, 1, really), thin()));
  std::vector<CalibrationTerm> terms;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t k = i + 1; k < poses.size(); ++k) {
      const Pose relative = poses[i].inverse() * poses[k];
      const auto cells = cellsOnPatches(*scans[i], *scans[k], relative, 0.005, thin());
      terms.push_back(calibrationTerm(static_cast<int>(i), static_cast<int>(k), *scans[i], *scans[k], nominal,
                                      relative, cells, 0.005, 1e6));
    }
  return terms;
}

ErrorPrior loose() {
  ErrorPrior prior;
  for (const ScannerError error : kAllScannerErrors)
    prior.deviation[static_cast<int>(error)] = isAngle(error) ? 3.0 * kDegree : 0.2;
  return prior;
}

class EachError : public ::testing::TestWithParam<ScannerError> {};

// Residuals are minus what the equations say the missing error would add, patches bent or not: to first order
// h * error + b = 0. In the room's corners a few cells lie on the wrong
// patch whatever the errors are; what they add is taken off.
TEST_P(EachError, ExplainsTheResidualsThatItMakes) {
  const ErrorVector errors = small(GetParam());
  const std::vector<CalibrationTerm> with = termsWith(errors), without = termsWith(ErrorVector::Zero());
  double off = 0.0, size = 0.0;
  for (std::size_t t = 0; t < with.size(); ++t) {
    ASSERT_GT(with[t].residual_m.size(), 100U);
    const ErrorVector b = with[t].b_errors - without[t].b_errors;
    off += std::pow(errors.dot(with[t].h_errors * errors + b), 2);
    size += std::pow(errors.dot(with[t].h_errors * errors), 2);
  }
  EXPECT_LT(std::sqrt(off), 0.05 * std::sqrt(size));
}
INSTANTIATE_TEST_SUITE_P(All, EachError, ::testing::ValuesIn(kAllScannerErrors),
                         [](const auto& tested) { return "Error" + std::to_string(tested.index); });

TEST(CalibrationSystem, OneStepFindsSmallErrorsAndLeavesThePoses) {
  ErrorVector errors = ErrorVector::Zero();
  const std::vector<ScannerError> free = {ScannerError::LeverY, ScannerError::LeverZ, ScannerError::MountingY,
                                          ScannerError::MountingZ, ScannerError::RangeOffset};
  for (const ScannerError error : free) errors += small(error);
  const auto solved = solveCalibration(stops().size(), termsWith(errors), free, loose());
  const auto without = solveCalibration(stops().size(), termsWith(ErrorVector::Zero()), free, loose());
  ASSERT_TRUE(solved && without);
  for (const ScannerError error : free) {
    const int k = static_cast<int>(error);
    EXPECT_NEAR(solved->change[k] - without->change[k], errors[k], 0.25 * std::abs(errors[k]))
        << scannerErrorName(error);
    EXPECT_GT(solved->covariance(k, k), 0.0);
    EXPECT_GE(std::sqrt(solved->covariance(k, k)), solved->alone[k]) << "knowing the rest can only help";
  }
  for (const Vector6d& motion : solved->motions) EXPECT_LT(motion.norm(), 1e-3);
  EXPECT_TRUE(solved->motions.front().isZero());
}

TEST(CalibrationSystem, WhatEveryPoseCanUndoStaysAtThePrior) {
  for (const ScannerError error : {ScannerError::TiltZero, ScannerError::LeverX}) {
    const auto solved = solveCalibration(stops().size(), termsWith(ErrorVector::Zero()), {error}, loose());
    ASSERT_TRUE(solved);
    const int k = static_cast<int>(error);
    EXPECT_GT(std::sqrt(solved->covariance(k, k)), 0.3 * loose().deviation[k]) << scannerErrorName(error);
    EXPECT_LT(solved->alone[k], 0.01 * loose().deviation[k]) << "with the poses known it would be told";
  }
  // The mounting's x is the tilt zero with another lever arm.
  const std::vector<ScannerError> all(kAllScannerErrors.begin(), kAllScannerErrors.end());
  const auto solved = solveCalibration(stops().size(), termsWith(ErrorVector::Zero()), all, loose());
  ASSERT_TRUE(solved);
  const int x = static_cast<int>(ScannerError::MountingX);
  EXPECT_GT(std::sqrt(solved->covariance(x, x)), 0.3 * loose().deviation[x]);
}

TEST(CalibrationSystem, ThePriorPullsBackWhatNothingElseTells) {
  ErrorPrior prior = loose();
  prior.departure[7] = 0.05;
  const auto solved = solveCalibration(2, {}, {ScannerError::RangeOffset}, prior);
  ASSERT_TRUE(solved);
  EXPECT_NEAR(solved->change[7], -0.05, 1e-12);
}

}  // namespace
}  // namespace tiltmap
