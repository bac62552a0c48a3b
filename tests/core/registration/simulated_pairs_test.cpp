// The presets on simulated drives, against their truth.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/registration/register_pair.h"
#include "core/world/experiment.h"

namespace tiltmap {
namespace {

struct Errors {
  std::vector<double> translation_m, rotation_deg;
  std::vector<double> odometry_m, odometry_deg;
  std::vector<std::string> failed;
};

// Simulated once for all tests of this program.
const std::vector<SimulatedStop>& drive(ExperimentId id, std::uint64_t seed) {
  static std::map<std::pair<ExperimentId, std::uint64_t>, std::vector<SimulatedStop>> drives;
  std::vector<SimulatedStop>& stops = drives[{id, seed}];
  if (stops.empty()) stops = simulateExperiment(id, seed, 0, 2).value();
  return stops;
}

Errors errorsOf(ExperimentId id, std::uint64_t first_seed, std::uint64_t last_seed,
                const RegistrationSettings& settings) {
  Errors errors;
  for (std::uint64_t seed = first_seed; seed <= last_seed; ++seed) {
    const std::vector<SimulatedStop>& stops = drive(id, seed);
    std::vector<PreparedScanPtr> prepared;
    for (const SimulatedStop& stop : stops) prepared.push_back(prepare(stop.scan, settings));
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
      const Pose start = stops[i].scan.odometry.inverse() * stops[i + 1].scan.odometry;
      const Pose truth = stops[i].truth.inverse() * stops[i + 1].truth;
      const auto result = registerPair(prepared[i], prepared[i + 1], start, settings);
      EXPECT_TRUE(result.has_value());
      if (!result) continue;
      const PoseDifference off = difference(result->fixed_from_moving, truth),
                           before = difference(start, truth);
      errors.translation_m.push_back(off.translation_m);
      errors.rotation_deg.push_back(off.rotation_rad / kDegree);
      errors.odometry_m.push_back(before.translation_m);
      errors.odometry_deg.push_back(before.rotation_rad / kDegree);
      if (!result->succeeded())
        errors.failed.push_back("seed " + std::to_string(seed) + " pair " + std::to_string(i) + " " +
                                stopReasonName(result->stop_reason));
    }
  }
  return errors;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}
double worst(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

TEST(DefaultPreset, IsWithinMillimetresOnBothExperiments) {
  for (const ExperimentId id : {ExperimentId::Exp1, ExperimentId::Exp2Fixed}) {
    SCOPED_TRACE(nameOf(id));
    const Errors errors = errorsOf(id, 1, 5, RegistrationSettings{});
    EXPECT_EQ(errors.translation_m.size(), id == ExperimentId::Exp1 ? 20U : 65U);
    EXPECT_TRUE(errors.failed.empty()) << errors.failed.front();
    EXPECT_LT(median(errors.translation_m), 0.0015);
    EXPECT_LT(median(errors.rotation_deg), 0.01);
    EXPECT_LT(worst(errors.translation_m), 0.015);
  }
}

TEST(DefaultPreset, IsFinerByItsCellsThanByItsPatches) {
  RegistrationSettings patches;
  patches.refine = false;
  const auto square = [](const Errors& errors) {
    double sum = 0.0;
    for (const double e : errors.translation_m) sum += e * e;
    return sum;
  };
  EXPECT_LT(square(errorsOf(ExperimentId::Exp2Fixed, 1, 2, {})),
            0.7 * square(errorsOf(ExperimentId::Exp2Fixed, 1, 2, patches)));
}

TEST(ThesisPreset, IsBetterThanOdometryAndWorseThanTheDefault) {
  const RegistrationSettings thesis = registrationParameters().presetSettings("thesis").value();
  for (const ExperimentId id : {ExperimentId::Exp1, ExperimentId::Exp2Fixed}) {
    SCOPED_TRACE(nameOf(id));
    const Errors theirs = errorsOf(id, 1, 1, thesis);
    const Errors ours = errorsOf(id, 1, 1, RegistrationSettings{});
    EXPECT_LT(median(theirs.translation_m), median(theirs.odometry_m));
    EXPECT_LT(median(theirs.rotation_deg), median(theirs.odometry_deg));
    EXPECT_GT(median(theirs.translation_m), 5.0 * median(ours.translation_m));
  }
}

}  // namespace
}  // namespace tiltmap
