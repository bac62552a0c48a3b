// The scale that the data tell.
#include "core/registration/loss_scale.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/registration/metric.h"

namespace tiltmap {
namespace {

struct Sample {
  std::vector<double> residuals_m, variances_m2;
};

// Normal residuals of known deviations, an excess on top, and a share of wrong ones far off.
Sample sample(double excess_m, double wrong_share, std::uint64_t seed = 7) {
  Sample s;
  RandomStream random(seed);
  for (int i = 0; i < 20000; ++i) {
    const double own = random.uniform(0.001, 0.01);
    const double deviation = std::hypot(own, excess_m);
    const bool wrong = random.uniform() < wrong_share;
    const double off = random.normal() * deviation;
    s.residuals_m.push_back(wrong ? random.uniform(0.2, 2.0) : std::abs(off));
    s.variances_m2.push_back(own * own);
  }
  return s;
}

TEST(ExcessDeviation, IsWhatThePatchesOwnVariancesLeaveUnexplained) {
  for (const double excess : {0.003, 0.01, 0.03}) {
    const Sample s = sample(excess, 0.0);
    EXPECT_NEAR(excessDeviation(s.residuals_m, s.variances_m2), excess, 0.2 * excess);
  }
}

// One answer rests on 500 values and scatters; their mean does not.
TEST(ExcessDeviation, IsRightOnAverage) {
  for (const double excess : {0.003, 0.01, 0.03}) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const Sample s = sample(excess, 0.0, seed);
      sum += excessDeviation(s.residuals_m, s.variances_m2);
    }
    EXPECT_NEAR(sum / 40.0, excess, 0.05 * excess);
  }
}

TEST(ExcessDeviation, IsNothingWhereResidualsAreAsExpectedOrLess) {
  const Sample exact = sample(0.0, 0.0);
  EXPECT_LT(excessDeviation(exact.residuals_m, exact.variances_m2), 0.001);
  Sample small = exact;
  for (double& r : small.residuals_m) r *= 0.5;
  EXPECT_EQ(excessDeviation(small.residuals_m, small.variances_m2), 0.0);
  EXPECT_EQ(excessDeviation({}, {}), 0.0);
}

TEST(ExcessDeviation, IsNotMovedFarByWrongPairs) {
  for (const double wrong_share : {0.2, 0.5}) {
    const Sample s = sample(0.01, wrong_share);
    const double found = excessDeviation(s.residuals_m, s.variances_m2);
    EXPECT_GT(found, 0.009) << wrong_share;
    EXPECT_LT(found, 0.015) << wrong_share;
  }
}

TEST(ExcessDeviation, RefusesListsThatDoNotBelongTogether) {
  EXPECT_THROW(excessDeviation({0.1}, {}), std::invalid_argument);
}

// Two patches face each other 1 cm apart: what the pair weighs under either kind of scale.
TEST(LossScale, OfItsOwnDeviationWeighsAPairByWhatItsPatchesKnow) {
  const auto weightOf = [](double deviation_m, const LossScale& loss) {
    SurfaceElements fixed, moving;
    PatchShape shape;
    shape.u = Eigen::Vector3d::UnitX();
    shape.v = Eigen::Vector3d::UnitZ();
    shape.offset_variance_m2 = 0.5 * deviation_m * deviation_m;
    fixed.position = {{0, 5, 0}}, moving.position = {{0, 5.01, 0}};
    fixed.normal = moving.normal = {{0, -1, 0}};
    fixed.shape = moving.shape = {shape};
    const std::vector<Correspondence> pairs(1);
    LinearSystem system;
    Residuals residuals;
    linearise(Metric::PatchToPatch, fixed, moving, Pose(), Pose(), pairs, {}, loss, system, &residuals);
    EXPECT_NEAR(residuals.size_m.at(0), 0.01, 1e-12);
    EXPECT_NEAR(residuals.variance_m2.at(0), deviation_m * deviation_m, 1e-12);
    return system.loss_weight * (deviation_m * deviation_m + loss.scale_m * loss.scale_m);
  };
  // Absolute: the same for both. Own: 1 cm is little for one that is known to 2 cm, and much for one to 2 mm.
  EXPECT_NEAR(weightOf(0.002, 0.01), 0.25, 1e-9);
  EXPECT_NEAR(weightOf(0.02, 0.01), 0.25, 1e-9);
  EXPECT_LT(weightOf(0.002, LossScale::ofOwnDeviation(1.5, 0.0)), 0.01);
  EXPECT_GT(weightOf(0.02, LossScale::ofOwnDeviation(1.5, 0.0)), 0.8);
  // The excess widens both.
  EXPECT_GT(weightOf(0.002, LossScale::ofOwnDeviation(1.5, 0.02)), 0.8);
}

TEST(LossScale, OfItsOwnDeviationNeedsPatches) {
  LinearSystem system;
  EXPECT_THROW(linearise(Metric::PointToPlane, {}, {}, Pose(), Pose(), {}, {},
                         LossScale::ofOwnDeviation(1.5, 0.0), system),
               std::logic_error);
}

}  // namespace
}  // namespace tiltmap
