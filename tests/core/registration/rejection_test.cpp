#include "core/registration/rejection.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/registration/registration_settings.h"

namespace tiltmap {
namespace {

Correspondence pairOf(double distance_m, double angle_deg) {
  Correspondence pair;
  pair.distance_m = static_cast<float>(distance_m);
  pair.cos_angle = static_cast<float>(std::cos(angle_deg * kDegree));
  pair.has_normals = true;
  return pair;
}

std::size_t count(const RejectionCounts& counts, RejectReason reason) {
  return counts[static_cast<std::size_t>(reason)];
}

RegistrationSettings pointSettings() {
  RegistrationSettings s = thesisSettings();
  s.statistics = false;
  return s;
}

TEST(Rejection, CountsByTheFirstReason) {
  RegistrationSettings s = pointSettings();  // 5 m, 20 deg
  RejectionState state{5.0};
  std::vector<Correspondence> pairs{pairOf(0.1, 0),  pairOf(4.9, 19), pairOf(5.1, 0), pairOf(6.0, 90),
                                    pairOf(0.2, 21), pairOf(0.3, 0),  pairOf(0.1, 0)};
  pairs[5].has_normals = false;
  pairs[6].reason = RejectReason::NoPartner;
  const RejectionCounts counts = applyRejection(s, state, pairs);
  EXPECT_EQ(count(counts, RejectReason::None), 2U);
  EXPECT_EQ(count(counts, RejectReason::TooFar), 2U);
  EXPECT_EQ(count(counts, RejectReason::NormalDisagrees), 1U);
  EXPECT_EQ(count(counts, RejectReason::NoNormal), 1U);
  EXPECT_EQ(count(counts, RejectReason::NoPartner), 1U);
  EXPECT_EQ(count(counts, RejectReason::Statistics), 0U);
  EXPECT_EQ(pairs[3].reason, RejectReason::TooFar);  // also the wrong normal: the first rule names it
  EXPECT_TRUE(pairs[1].kept());
}

TEST(Rejection, NormalsAreNotNeededWithoutAnAngleBoundOnPoints) {
  RegistrationSettings s = pointSettings();
  s.max_angle_rad = std::numbers::pi;
  RejectionState state{0.0};  // no distance bound either
  std::vector<Correspondence> pairs{pairOf(100.0, 0), pairOf(0.1, 175)};
  pairs[0].has_normals = false;
  EXPECT_EQ(count(applyRejection(s, state, pairs), RejectReason::None), 2U);
  s.motion = MotionMethod::PointToPlane;
  EXPECT_EQ(count(applyRejection(s, state, pairs), RejectReason::NoNormal), 1U);
}

TEST(Rejection, StatisticsSetTheBoundOfTheNextStep) {
  RegistrationSettings s = pointSettings();
  s.statistics = true;
  RejectionState state{5.0};
  std::vector<Correspondence> pairs(99, pairOf(0.1, 0));
  pairs.push_back(pairOf(4.0, 0));
  // Mean 0.139, deviation 0.388: the bound is 1.303.
  const RejectionCounts counts = applyRejection(s, state, pairs);
  EXPECT_EQ(count(counts, RejectReason::Statistics), 1U);
  EXPECT_EQ(pairs.back().reason, RejectReason::Statistics);
  EXPECT_NEAR(state.distance_bound_m, 0.139 + 3.0 * 0.38805, 1e-3);
  std::vector<Correspondence> next{pairOf(1.4, 0), pairOf(1.2, 0)};
  EXPECT_EQ(count(applyRejection(s, state, next), RejectReason::TooFar), 1U);
}

TEST(Rejection, StatisticsNeverWidenTheFirstBound) {
  RegistrationSettings s = pointSettings();
  s.statistics = true;
  RejectionState state{5.0};
  std::vector<Correspondence> pairs{pairOf(0.1, 0), pairOf(4.9, 0), pairOf(0.1, 0)};
  applyRejection(s, state, pairs);
  EXPECT_LE(state.distance_bound_m, 5.0);
}

// Two distances a and b, half of the pairs each: mean (a + b) / 2, deviation |a - b| / 2.
std::vector<double> halves(double a, double b) {
  std::vector<double> distances(50, a);
  distances.insert(distances.end(), 50, b);
  return distances;
}

TEST(ZhangBound, FollowsTheTable) {
  const double d = 0.5;
  EXPECT_NEAR(zhangBound(halves(0.3, 0.5), d), 0.4 + 3 * 0.1, 1e-12);  // mean below D
  EXPECT_NEAR(zhangBound(halves(0.5, 0.7), d), 0.6 + 2 * 0.1, 1e-12);  // below 3 D
  EXPECT_NEAR(zhangBound(halves(1.39, 1.59), d), 1.49 + 2 * 0.1, 1e-12);
  EXPECT_NEAR(zhangBound(halves(1.5, 1.7), d), 1.6 + 0.1, 1e-12);  // below 6 D
  EXPECT_NEAR(zhangBound(halves(2.8, 3.0), d), 2.9 + 0.1, 1e-12);
}

TEST(ZhangBound, TakesTheValleyOfTheHistogramWhenNothingFits) {
  // Mean above 6 D = 3 m. Bins of 0.5 m up to 10 m: 60 pairs in the bin of 3.2 m, 30 in each of the next: the
  // valley is the bin from 3.5 to 4 m.
  std::vector<double> distances(60, 3.2);
  for (const double x : {3.7, 4.2, 10.0}) distances.insert(distances.end(), 30, x);
  EXPECT_NEAR(zhangBound(distances, 0.5), 3.75, 1e-12);
  EXPECT_NEAR(zhangBound(std::vector<double>(10, 4.0), 0.5), 4.0, 1e-12);  // all alike: all kept
}

TEST(ZhangBound, RefusesNothing) {
  EXPECT_THROW(zhangBound({}, 0.5), std::invalid_argument);
  EXPECT_THROW(zhangBound(std::vector<double>{1.0}, 0.0), std::invalid_argument);
}

TEST(RejectReason, EachHasAName) {
  for (std::size_t i = 0; i < kRejectReasons; ++i)
    EXPECT_FALSE(rejectReasonName(static_cast<RejectReason>(i)).empty());
  EXPECT_EQ(rejectReasonName(RejectReason::TooFar), "too far");
}

}  // namespace
}  // namespace tiltmap
