#include "core/registration/registration.h"

#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "core/registration/register_pair.h"
#include "support/room_scene.h"

namespace tiltmap {
namespace {

using test_support::almostEmptyScan;
using test_support::groundScene;
using test_support::roomScene;
using test_support::sceneScan;

const Pose kTruth(rotationExp({0.01, -0.02, 0.06}), {0.20, 0.30, 0.05});  // fixed_from_moving

struct Room {
  Scan fixed = sceneScan(roomScene(), Pose(), 0.005, 1);
  Scan moving = sceneScan(roomScene(), kTruth, 0.005, 2);
};
const Room& room() {
  static const Room scans;
  return scans;
}

RegistrationSettings thesis() {
  return registrationParameters().presetSettings("thesis").value();
}

// Point methods on the room: all points thinned to half a metre, wide bounds.
RegistrationSettings pointSettings(MotionMethod motion) {
  RegistrationSettings s;
  s.reduction = Reduction::Line;
  s.reduction_distance_m = 0.1;
  s.pair_choice = PairChoice::Nearest;
  s.motion = motion;
  s.loss = Loss::None;
  s.max_distance_m = 1.0;
  s.max_iterations = 80;
  s.min_change = 1e-5;
  return s;
}

bool sameBits(const Pose& a, const Pose& b) {
  return std::memcmp(a.quaternion().coeffs().data(), b.quaternion().coeffs().data(), 4 * sizeof(double)) ==
             0 &&
         std::memcmp(a.translation().data(), b.translation().data(), 3 * sizeof(double)) == 0;
}
bool sameBits(const StepReport& a, const StepReport& b) {
  return a.iteration == b.iteration && sameBits(a.fixed_from_moving, b.fixed_from_moving) &&
         a.pairs == b.pairs && a.rejected == b.rejected && a.error_m2 == b.error_m2 &&
         a.loss.scale_m == b.loss.scale_m && a.loss.deviations == b.loss.deviations && a.stop == b.stop;
}

std::vector<StepReport> runToEnd(Registration registration) {
  std::vector<StepReport> steps;
  while (!registration.done()) steps.push_back(registration.step());
  return steps;
}

TEST(Registration, CarriesTheMovingScanIntoTheFixedFrameAndNotBack) {
  const auto result = registerPair(room().fixed, room().moving, Pose(), RegistrationSettings{});
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(result->succeeded()) << stopReasonName(result->stop_reason);
  const PoseDifference off = difference(result->fixed_from_moving, kTruth);
  EXPECT_LT(off.translation_m, 0.003);
  EXPECT_LT(off.rotation_rad, 0.03 * kDegree);
  EXPECT_GT(difference(result->fixed_from_moving, kTruth.inverse()).translation_m, 0.3);
  EXPECT_GT(result->overlap, 0.6);
  EXPECT_LE(result->overlap, 1.0);
  EXPECT_GT(result->correspondences, 50U);
  EXPECT_LT(result->rms_m, 0.01);
  EXPECT_EQ(result->condition.weak, 0);
  EXPECT_EQ(result->steps.size(), static_cast<std::size_t>(result->iterations));
  EXPECT_GT(result->milliseconds, 0.0);
}

TEST(Registration, SwappingTheScansGivesTheInverse) {
  const auto there = registerPair(room().fixed, room().moving, Pose(), RegistrationSettings{});
  const auto back = registerPair(room().moving, room().fixed, Pose(), RegistrationSettings{});
  const PoseDifference off = difference(there->fixed_from_moving * back->fixed_from_moving, Pose());
  EXPECT_LT(off.translation_m, 0.004);
  EXPECT_LT(off.rotation_rad, 0.05 * kDegree);
}

TEST(Registration, EveryMotionFindsTheRoom) {
  struct Case {
    MotionMethod motion;
    double within_m;
  };
  for (const Case& c : {Case{MotionMethod::Svd, 0.05}, Case{MotionMethod::Orthonormal, 0.05},
                        Case{MotionMethod::Quaternion, 0.05}, Case{MotionMethod::DualQuaternion, 0.05},
                        Case{MotionMethod::PointToPlane, 0.01}, Case{MotionMethod::PlaneToPlane, 0.01}}) {
    SCOPED_TRACE(static_cast<int>(c.motion));
    const auto result = registerPair(room().fixed, room().moving, Pose(), pointSettings(c.motion));
    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(result->succeeded()) << stopReasonName(result->stop_reason);
    EXPECT_LT(difference(result->fixed_from_moving, kTruth).translation_m, c.within_m);
  }
}

TEST(Registration, EveryPairChoiceFindsTheRoom) {
  for (const PairChoice choice : {PairChoice::BestNormalInLeaf, PairChoice::Nearest,
                                  PairChoice::NormalShooting, PairChoice::Projective}) {
    SCOPED_TRACE(static_cast<int>(choice));
    RegistrationSettings s = pointSettings(MotionMethod::PointToPlane);
    s.pair_choice = choice;
    const auto result = registerPair(room().fixed, room().moving, Pose(), s);
    ASSERT_TRUE(result.has_value());
    EXPECT_LT(difference(result->fixed_from_moving, kTruth).translation_m, 0.02);
  }
}

TEST(Registration, ClosedFormsAgreeStepByStep) {
  Registration svd(room().fixed, room().moving, Pose(), pointSettings(MotionMethod::Svd));
  svd.step();
  for (const MotionMethod motion :
       {MotionMethod::Orthonormal, MotionMethod::Quaternion, MotionMethod::DualQuaternion}) {
    Registration other(room().fixed, room().moving, Pose(), pointSettings(motion));
    other.step();
    const PoseDifference off = difference(svd.fixedFromMoving(), other.fixedFromMoving());
    EXPECT_LT(off.translation_m, 1e-9);
    EXPECT_LT(off.rotation_rad, 1e-9);
  }
}

TEST(Registration, SteppingCopyingAndPreparingOnceGiveTheSameBits) {
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis()}) {
    const std::vector<StepReport> run = runToEnd({room().fixed, room().moving, Pose(), settings});
    ASSERT_GT(run.size(), 4U);

    Registration stepped(prepare(room().fixed, settings), prepare(room().moving, settings), Pose(), settings);
    std::vector<Registration> kept{stepped};
    for (std::size_t i = 0; !stepped.done(); ++i) {
      ASSERT_LT(i, run.size());
      EXPECT_TRUE(sameBits(stepped.step(), run[i])) << i;
      kept.push_back(stepped);
    }
    // Back to the third step, and on again.
    const std::vector<StepReport> again = runToEnd(kept[3]);
    ASSERT_EQ(again.size() + 3, run.size());
    for (std::size_t i = 0; i < again.size(); ++i) EXPECT_TRUE(sameBits(again[i], run[i + 3])) << i;
  }
}

TEST(Registration, ThreadsThatShareScansGetTheSameBits) {
  const RegistrationSettings settings;
  const PreparedScanPtr fixed = prepare(room().fixed, settings), moving = prepare(room().moving, settings);
  const Pose alone = registerPair(fixed, moving, Pose(), settings)->fixed_from_moving;
  Pose first, second;
  std::thread one([&] { first = registerPair(fixed, moving, Pose(), settings)->fixed_from_moving; });
  std::thread two([&] { second = registerPair(fixed, moving, Pose(), settings)->fixed_from_moving; });
  one.join();
  two.join();
  EXPECT_TRUE(sameBits(alone, first));
  EXPECT_TRUE(sameBits(alone, second));
}

TEST(Registration, ReportsAddUp) {
  Registration registration(room().fixed, room().moving, Pose(), thesis());
  Pose pose;
  while (!registration.done()) {
    const StepReport report = registration.step();
    const PoseDifference off = difference(report.motion * pose, report.fixed_from_moving);
    EXPECT_LT(off.translation_m, 1e-12);
    pose = report.fixed_from_moving;
    std::size_t sum = 0;
    for (const std::size_t count : report.rejected) sum += count;
    EXPECT_EQ(sum, registration.correspondences().size());
    EXPECT_EQ(report.pairs, report.rejected[0]);
    RejectionCounts counted{};
    for (const Correspondence& pair : registration.correspondences())
      ++counted[static_cast<std::size_t>(pair.reason)];
    EXPECT_EQ(counted, report.rejected);
    EXPECT_EQ(report.stop.has_value(), registration.done());
  }
  EXPECT_THROW(registration.step(), std::logic_error);
}

TEST(Registration, OnePlaneIsDegenerateAndStaysWhereTheStartLeftIt) {
  const Scan fixed = sceneScan(groundScene(), Pose(), 0.005, 1);
  const Scan moving =
      sceneScan(groundScene(), Pose(rotationExp({0.01, 0.005, 0.0}), {0.0, 0.0, 0.1}), 0.005, 2);
  const Pose start(Eigen::Quaterniond::Identity(), {0.4, -0.3, 0.0});
  const auto result = registerPair(fixed, moving, start, RegistrationSettings{});
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->stop_reason, StopReason::Degenerate);
  EXPECT_FALSE(result->succeeded());
  EXPECT_EQ(result->condition.weak, 3);  // two shifts and the turn about the normal
  EXPECT_FALSE(result->warnings.empty());
  EXPECT_NEAR(result->fixed_from_moving.translation().z(), 0.1, 0.02);
  EXPECT_NEAR(result->fixed_from_moving.translation().x(), 0.4, 0.1);
}

TEST(Registration, ScansOfOtherPlacesNeverConverge) {
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis()}) {
    Pose far(Eigen::Quaterniond::Identity(), {200.0, 0.0, 0.0});
    const auto apart = registerPair(room().fixed, room().moving, far, settings);
    ASSERT_TRUE(apart.has_value());
    EXPECT_FALSE(apart->succeeded());
    EXPECT_TRUE(apart->stop_reason == StopReason::NoOverlap || apart->stop_reason == StopReason::TooFewPairs)
        << stopReasonName(apart->stop_reason) << " overlap " << apart->overlap;
  }
}

TEST(Registration, ScansWithNothingInThemAreNoInformation) {
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis()}) {
    for (const int points : {0, 1, 3}) {
      for (const bool empty_is_fixed : {true, false}) {
        const Scan nothing = almostEmptyScan(points);
        const auto result = empty_is_fixed ? registerPair(nothing, room().moving, Pose(), settings)
                                           : registerPair(room().fixed, nothing, Pose(), settings);
        ASSERT_TRUE(result.has_value());
        EXPECT_EQ(result->stop_reason, StopReason::TooFewPairs) << points;
        EXPECT_FALSE(result->succeeded());
        EXPECT_EQ(result->overlap, 0.0);
      }
    }
  }
}

TEST(Registration, RunningAwayIsDivergence) {
  RegistrationSettings settings;
  settings.max_correction_m = 0.02;
  const auto result = registerPair(room().fixed, room().moving, Pose(), settings);
  EXPECT_EQ(result->stop_reason, StopReason::Diverged);
  EXPECT_FALSE(result->succeeded());
}

TEST(Registration, TheIterationLimitIsNamed) {
  RegistrationSettings settings = pointSettings(MotionMethod::Svd);
  settings.max_iterations = 3;
  const auto result = registerPair(room().fixed, room().moving, Pose(), settings);
  EXPECT_EQ(result->stop_reason, StopReason::IterationLimit);
  EXPECT_EQ(result->iterations, 3);
  EXPECT_FALSE(result->warnings.empty());
}

TEST(Registration, CancellingKeepsThePoseAndIsAnError) {
  std::stop_source source;
  Registration registration(room().fixed, room().moving, kTruth, RegistrationSettings{});
  source.request_stop();
  const StepReport report = registration.step(source.get_token());
  EXPECT_EQ(report.stop, StopReason::Cancelled);
  EXPECT_TRUE(sameBits(registration.fixedFromMoving(), kTruth));
  const auto result =
      registerPair(room().fixed, room().moving, Pose(), RegistrationSettings{}, {{}, source.get_token()});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().what, kCancelled);
}

TEST(Registration, WhatCannotBeUsedIsRefused) {
  const Pose nowhere(Eigen::Quaterniond::Identity(), {std::nan(""), 0.0, 0.0});
  const auto result = registerPair(room().fixed, room().moving, nowhere, RegistrationSettings{});
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().what.find("not finite"), std::string::npos);
  RegistrationSettings bad;
  bad.motion = MotionMethod::Svd;  // on patches
  EXPECT_FALSE(registerPair(room().fixed, room().moving, Pose(), bad).has_value());
  EXPECT_THROW(Registration(room().fixed, room().moving, Pose(), bad), std::invalid_argument);
  EXPECT_THROW(Registration(nullptr, nullptr, Pose(), RegistrationSettings{}), std::invalid_argument);
}

TEST(Registration, TheInformationPredictsTheError) {
  // Ten noise seeds: the squared error, weighed by the information, is of the order of its six degrees of
  // freedom.
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scan fixed = sceneScan(roomScene(), Pose(), 0.01, 10 + seed),
               moving = sceneScan(roomScene(), kTruth, 0.01, 50 + seed);
    const auto result = registerPair(fixed, moving, Pose(), RegistrationSettings{});
    ASSERT_TRUE(result->succeeded());
    Vector6d d;
    const Pose off = result->fixed_from_moving * kTruth.inverse();
    d << rotationLog(off.quaternion()), off.translation();
    sum += d.dot(result->information * d);
  }
  EXPECT_LT(sum / 10.0, 60.0);
  EXPECT_GT(sum / 10.0, 0.05);
}

TEST(StopReason, EachHasItsWords) {
  for (const StopReason reason :
       {StopReason::Converged, StopReason::TinyMotion, StopReason::IterationLimit, StopReason::TooFewPairs,
        StopReason::NoOverlap, StopReason::Diverged, StopReason::Degenerate, StopReason::Cancelled}) {
    EXPECT_FALSE(stopReasonName(reason).empty());
    EXPECT_EQ(stopReasonSentence(reason).back(), '.');
  }
  EXPECT_EQ(stopReasonName(StopReason::NoOverlap), "no overlap");
  EXPECT_FALSE(isSuccess(StopReason::NoOverlap));
  EXPECT_FALSE(isSuccess(StopReason::Degenerate));
  EXPECT_TRUE(isSuccess(StopReason::Converged));
}

}  // namespace
}  // namespace tiltmap
