#include "core/calibration/scanner_errors.h"

#include <gtest/gtest.h>

#include "core/geometry/pose.h"

namespace tiltmap {
namespace {

ErrorVector skewed() {
  ErrorVector errors;
  errors << 0.01, 0.02, -0.05, 0.04, 0.01, -0.02, 0.015, 0.03;
  return errors;
}

TEST(ScannerErrors, AreReadBackFromTheGeometryTheyWereGivenTo) {
  const ScannerGeometry geometry = corrected(ScannerGeometry(), skewed());
  EXPECT_LT((errorsOf(geometry) - skewed()).norm(), 1e-12);
  EXPECT_TRUE(errorsOf(ScannerGeometry()).isZero());
  EXPECT_TRUE(geometry.check());
}

// The reading (tilt, azimuth, range) stays while the geometry changes.
TEST(ScannerErrors, PointsMoveAsDifferencesOfTheGeometryTell) {
  constexpr double kStep = 1e-6;
  for (const ScannerGeometry& geometry : {ScannerGeometry(), corrected(ScannerGeometry(), skewed())})
    for (const double tilt : {-0.5, 0.0, 0.3, 0.85})
      for (const double azimuth : {0.2, 1.0, 1.6, 2.9})
        for (const double range : {1.0, 25.0}) {
          const auto motions = errorMotions(geometry, geometry.point(tilt, azimuth, range));
          ASSERT_TRUE(motions);
          for (int k = 0; k < kScannerErrors; ++k) {
            const ErrorVector change = kStep * ErrorVector::Unit(k);
            const Eigen::Vector3d numeric = (corrected(geometry, change).point(tilt, azimuth, range) -
                                             corrected(geometry, -change).point(tilt, azimuth, range)) /
                                            (2.0 * kStep);
            EXPECT_LT((motions->col(k) - numeric).norm(), 1e-6 * range)
                << scannerErrorName(kAllScannerErrors[static_cast<std::size_t>(k)]) << " at tilt " << tilt
                << ", azimuth " << azimuth << ", " << range << " m";
          }
        }
}

TEST(ScannerErrors, NoMotionWhereNoBeamReaches) {
  EXPECT_FALSE(errorMotions(ScannerGeometry(), Eigen::Vector3d::Zero()));
  EXPECT_FALSE(errorMotions(ScannerGeometry(), Eigen::Vector3d(std::nan(""), 1.0, 0.0)));
}

TEST(ScannerErrors, AreReadFromText) {
  const auto errors = parseScannerErrors("tilt-zero=0.5, lever-arm-y=0.05,range-offset=-0.03", "--plant");
  ASSERT_TRUE(errors);
  EXPECT_NEAR((*errors)[0], 0.5 * kDegree, 1e-15);
  EXPECT_EQ((*errors)[2], 0.05);
  EXPECT_EQ((*errors)[7], -0.03);
  EXPECT_EQ((*errors)[3], 0.0);
  EXPECT_TRUE(parseScannerErrors("", "--plant")->isZero());
  for (const char* wrong : {"tilt-zero", "tilt-zero=", "tilt-zero=x", "tilt-zero=90", "lever-arm-y=5", "=1",
                            "tilt-zero=1,tilt-zero=2", "tilt-zero=1,", "tilt-zero=nan", "tilt-zero=1=2"})
    EXPECT_FALSE(parseScannerErrors(wrong, "--plant")) << wrong;
  EXPECT_NE(parseScannerErrors("tilt-zerro=1", "--plant").error().remedy.find("tilt-zero"),
            std::string::npos);
}

}  // namespace
}  // namespace tiltmap
