// Calibration of scanners whose errors are known: a room of planes, and the simulated site.
#include "core/calibration/calibrate.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/registration/register_pair.h"
#include "core/world/experiment.h"
#include "tests/support/room_scene.h"

namespace tiltmap {
namespace {

struct Survey {
  std::vector<Scan> scans;
  std::vector<Pose> truth;
};

ErrorVector planted() {
  return parseScannerErrors(
             "tilt-zero=0.5,lever-arm-y=0.05,lever-arm-z=-0.05,mounting-y=0.5,mounting-z=-0.5,range-offset=0."
             "03",
             "test")
      .value();
}

Survey room(const ErrorVector& errors, double noise_m,
            const std::vector<test_support::ScenePlane>& planes = test_support::roomScene()) {
  Survey survey;
  // Towards the wall in front, so that each stop's ground is seen from the ones before it.
  for (int i = 0; i < 8; ++i)
    survey.truth.push_back(Pose::planar(i % 2 == 0 ? -0.7 : 0.8, -6.0 + 0.9 * i, i % 3 == 0 ? 0.3 : -0.25));
  const ScannerGeometry really = corrected(ScannerGeometry(), errors);
  for (std::size_t i = 0; i < survey.truth.size(); ++i) {
    survey.scans.push_back(test_support::sceneScan(planes, survey.truth[i], noise_m, 100 + i, really));
    survey.scans.back().name = "stop " + std::to_string(i);
  }
  return survey;
}

// A centimetre and a quarter degree off.
std::vector<Pose> starts(const Survey& survey) {
  std::vector<Pose> poses = survey.truth;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    RandomStream random = RandomStream::keyed({7, i});
    Vector6d d;
    for (int k = 0; k < 6; ++k) d[k] = random.normal() * (k < 3 ? 0.25 * kDegree : 0.01);
    poses[i] = poses[i] * Pose().moved(d);
  }
  return poses;
}

const ErrorEstimate& of(const Calibration& calibration, ScannerError error) {
  return calibration.estimates[static_cast<std::size_t>(error)];
}

// The room's beams are thin and its ground is even.
constexpr ScannerError kTold[] = {ScannerError::TiltZero,  ScannerError::LeverY,
                                  ScannerError::LeverZ,    ScannerError::MountingY,
                                  ScannerError::MountingZ, ScannerError::RangeOffset};

TEST(Calibrate, FindsPlantedErrorsInARoom) {
  const Survey survey = room(planted(), 0.005);
  const auto found = calibrate(survey.scans, starts(survey), CalibrationSettings(), 2);
  ASSERT_TRUE(found) << found.error().what;
  for (const ScannerError error : kTold) {
    const ErrorEstimate& e = of(*found, error);
    const double truth = planted()[static_cast<int>(error)];
    EXPECT_EQ(e.state, EstimateState::Estimated) << scannerErrorName(error) << ": " << e.reason;
    EXPECT_NEAR(e.value, truth, 0.1 * std::abs(truth)) << scannerErrorName(error);
    EXPECT_GT(e.deviation, 0.0);
    EXPECT_EQ(e.before, 0.0);
  }
  for (const ScannerError error : {ScannerError::LeverX, ScannerError::MountingX}) {
    EXPECT_EQ(of(*found, error).state, EstimateState::Undefined);
    EXPECT_NE(of(*found, error).reason.find("no scans tell it"), std::string::npos);
    EXPECT_EQ(of(*found, error).value, 0.0);
  }
  EXPECT_LT(found->residual_after_m, 0.5 * found->residual_before_m);
  for (std::size_t i = 0; i < survey.truth.size(); ++i) {
    const PoseDifference off = difference(found->poses[i], survey.truth[i]);
    EXPECT_LT(off.translation_m, 0.01) << i;
    EXPECT_LT(off.rotation_rad, 0.1 * kDegree) << i;
  }
}

TEST(Calibrate, FindsNoneWhereThereAreNone) {
  const Survey survey = room(ErrorVector::Zero(), 0.005);
  const auto found = calibrate(survey.scans, starts(survey), CalibrationSettings(), 2);
  ASSERT_TRUE(found) << found.error().what;
  for (const ScannerError error : kTold) {
    const ErrorEstimate& e = of(*found, error);
    EXPECT_LT(std::abs(e.value), 0.05 * std::abs(planted()[static_cast<int>(error)]))
        << scannerErrorName(error);
  }
}

TEST(Calibrate, ResultsDoNotDependOnTheThreads) {
  const Survey survey = room(planted(), 0.005);
  const auto one = calibrate(survey.scans, starts(survey), CalibrationSettings(), 1);
  const auto three = calibrate(survey.scans, starts(survey), CalibrationSettings(), 3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(errorsOf(one->geometry), errorsOf(three->geometry));
}

TEST(Calibrate, WhatIsHeldStays) {
  const Survey survey = room(planted(), 0.005);
  CalibrationSettings settings;
  settings.tilt_zero = settings.lever_arm = settings.mounting = false;
  const auto found = calibrate(survey.scans, starts(survey), settings, 2);
  ASSERT_TRUE(found) << found.error().what;
  EXPECT_EQ(of(*found, ScannerError::LeverY).state, EstimateState::Held);
  EXPECT_TRUE(errorsOf(found->geometry).head<7>().isZero(1e-12));
  EXPECT_NE(of(*found, ScannerError::RangeOffset).state, EstimateState::Held);
}

// A closed street of houses, kerbs, trees and bent ground, seen by the LMS' wide beam.
TEST(Calibrate, FindsPlantedErrorsOnTheSimulatedSite) {
  SimulationSettings how;
  how.true_geometry = corrected(how.geometry, planted());
  const auto stops = simulateExperiment(ExperimentId::Loop, 3, 12, 2, {}, how);
  ASSERT_TRUE(stops);
  Survey survey;
  for (const SimulatedStop& stop : *stops) {
    survey.scans.push_back(stop.scan);
    survey.truth.push_back(stop.truth);
  }
  std::vector<Pose> links;
  for (std::size_t i = 0; i + 1 < survey.scans.size(); ++i) {
    const Scan &fixed = survey.scans[i], &moving = survey.scans[i + 1];
    const auto pair =
        registerPair(fixed, moving, fixed.odometry.inverse() * moving.odometry, RegistrationSettings());
    ASSERT_TRUE(pair && pair->succeeded()) << i;
    links.push_back(pair->fixed_from_moving);
  }
  const auto found = calibrate(survey.scans, chained(Pose(), links), CalibrationSettings(), 2);
  ASSERT_TRUE(found) << found.error().what;
  for (const ScannerError error : kTold) {
    const ErrorEstimate& e = of(*found, error);
    const double truth = planted()[static_cast<int>(error)];
    EXPECT_EQ(e.state, EstimateState::Estimated) << scannerErrorName(error) << ": " << e.reason;
    EXPECT_NEAR(e.value, truth, 0.1 * std::abs(truth)) << scannerErrorName(error);
    EXPECT_LT(std::abs(e.value - truth), 4.0 * e.deviation) << scannerErrorName(error);
  }
  EXPECT_LT(found->residual_after_m, 0.7 * found->residual_before_m);
}

// Open ground alone tells nothing of ranges along it.
TEST(Calibrate, WhatScansDoNotTellIsSaidAndLeftAlone) {
  Survey survey = room(planted(), 0.005, test_support::groundScene());
  survey.scans.resize(4), survey.truth.resize(4);
  const auto found = calibrate(survey.scans, survey.truth, CalibrationSettings(), 2);
  if (!found) {
    EXPECT_NE(found.error().what.find("overlap"), std::string::npos) << found.error().what;
    return;
  }
  int weak = 0;
  for (const ErrorEstimate& e : found->estimates) {
    if (e.state != EstimateState::Weak) continue;
    ++weak;
    EXPECT_EQ(e.value, e.before);
    EXPECT_FALSE(e.reason.empty());
  }
  EXPECT_GT(weak, 0);
}

TEST(Calibrate, RefusesWhatItCannotWorkOn) {
  Survey survey = room(ErrorVector::Zero(), 0.0);
  const auto what = [&] {
    const auto found = calibrate(survey.scans, survey.truth, CalibrationSettings(), 2);
    EXPECT_FALSE(found);
    return found ? std::string() : found.error().what;
  };
  survey.scans[2].geometry.range_offset_m = 0.01;
  EXPECT_NE(what().find("another calibration"), std::string::npos);
  survey = room(ErrorVector::Zero(), 0.0);
  survey.scans.resize(2), survey.truth.resize(2);
  EXPECT_NE(what().find("three"), std::string::npos);
  EXPECT_THROW(static_cast<void>(calibrate(survey.scans, {}, CalibrationSettings())), std::invalid_argument);

  survey = {};
  for (int i = 0; i < 3; ++i) survey.scans.push_back(test_support::almostEmptyScan(i));
  survey.truth.assign(3, Pose());
  EXPECT_FALSE(what().empty());

  survey = {};
  for (std::uint64_t i = 0; i < 3; ++i)
    survey.scans.push_back(test_support::sceneScan(test_support::roomScene(), Pose(), 0.005, i));
  survey.truth.assign(3, Pose());
  EXPECT_NE(what().find("one place"), std::string::npos);

  survey = room(ErrorVector::Zero(), 0.0);
  std::stop_source stop;
  stop.request_stop();
  const auto cancelled =
      calibrate(survey.scans, survey.truth, CalibrationSettings(), 2, JobControl{{}, stop.get_token()});
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().what, kCancelled);
}

}  // namespace
}  // namespace tiltmap
