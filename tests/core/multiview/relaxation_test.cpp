// What all methods share, the thesis' method and the sequential one on a simulated drive.
#include <stop_token>

#include <gtest/gtest.h>

#include "tests/core/multiview/relaxation_drives.h"

namespace tiltmap {
namespace {

using relaxation_test::drive;
using relaxation_test::Drive;
using relaxation_test::emptyScan;
using relaxation_test::errorsOf;
using relaxation_test::sameBits;

RelaxationSettings presetOf(const std::string& name) {
  return relaxationParameters().presetSettings(name).value();
}

const Drive& small() {
  return drive(ExperimentId::Exp1, 1);
}

// Prepared once for the thesis' method.
const std::vector<PreparedScanPtr>& thesisScans() {
  static const auto scans = prepareAll(small().scans, presetOf("thesis"), 2).value();
  return scans;
}

RelaxationInput inputFor(const std::string& preset) {
  const RelaxationSettings settings = presetOf(preset);
  return {preset == "thesis" ? thesisScans() : prepareAll(small().scans, settings, 2).value(),
          small().chained,
          {},
          {}};
}

std::size_t countOf(const RelaxationResult& result, RelaxationEventKind kind) {
  std::size_t count = 0;
  for (const RelaxationStep& step : result.steps)
    for (const RelaxationEvent& event : step.events) count += event.kind == kind;
  return count;
}

TEST(Relaxation, RefusesWhatIsNoInput) {
  const RelaxationInput good{{emptyScan(), emptyScan()}, {Pose(), Pose()}, {}, {}};
  const auto refused = [](const RelaxationInput& input) {
    EXPECT_THROW(Relaxation(input, {}), std::invalid_argument);
    const auto result = relax(input, {});
    return !result.has_value() && !result.error().what.empty() && !result.error().remedy.empty();
  };
  EXPECT_NO_THROW(Relaxation(good, {}));
  EXPECT_TRUE(refused({}));
  RelaxationInput bad = good;
  bad.world_from_scan.pop_back();
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.scans[1] = nullptr;
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.world_from_scan[1] = Pose(Eigen::Quaterniond::Identity(), {std::nan(""), 0.0, 0.0});
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.pins = {2};
  EXPECT_TRUE(refused(bad));
  bad.pins = {-1};
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.constraints = {{0, 0, Pose(), Matrix6d::Identity(), true}};
  EXPECT_TRUE(refused(bad));
}

TEST(Relaxation, EmptyScansAreUnlinkedWhateverTheMethod) {
  for (const std::string preset : {"default", "thesis", "sequential"}) {
    const auto result =
        relax({{emptyScan(), emptyScan()}, {Pose(), Pose::planar(1, 2, 0.1)}, {}, {}}, presetOf(preset));
    ASSERT_TRUE(result.has_value()) << preset;
    EXPECT_FALSE(result->unlinked.empty()) << preset;
    EXPECT_FALSE(result->warnings.empty()) << preset;
    EXPECT_TRUE(sameBits(result->poses, {Pose(), Pose::planar(1, 2, 0.1)}) ||
                difference(result->poses[1], Pose::planar(1, 2, 0.1)).translation_m < 1e-12)
        << preset;
  }
}

TEST(Relaxation, OneScanIsDoneAtOnce) {
  for (const std::string preset : {"default", "thesis", "sequential"}) {
    const auto result = relax({{emptyScan()}, {Pose::planar(1, 2, 0.1)}, {}, {}}, presetOf(preset));
    ASSERT_TRUE(result.has_value()) << preset;
    EXPECT_EQ(result->moved[0].translation_m, 0.0);
    EXPECT_EQ(countOf(*result, RelaxationEventKind::Finished), 1U);
  }
}

TEST(Relaxation, AStopEndsItAndThePosesStay) {
  for (const std::string preset : {"default", "thesis", "sequential"}) {
    Relaxation relaxation(inputFor(preset), presetOf(preset), 2);
    relaxation.step();
    const std::vector<Pose> before = relaxation.poses();
    std::stop_source source;
    source.request_stop();
    const RelaxationStep step = relaxation.step(source.get_token());
    EXPECT_TRUE(relaxation.done()) << preset;
    EXPECT_TRUE(relaxation.cancelled()) << preset;
    ASSERT_FALSE(step.events.empty());
    EXPECT_EQ(step.events.back().kind, RelaxationEventKind::Cancelled);
    EXPECT_TRUE(sameBits(before, relaxation.poses())) << preset;
    EXPECT_THROW(relaxation.step(), std::logic_error);
    JobControl control;
    control.stop = source.get_token();
    const auto result = relax(inputFor(preset), presetOf(preset), 2, control);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().what, kCancelled);
  }
}

TEST(Relaxation, TheThesisMethodWorksThroughItsQueue) {
  const auto result = relax(inputFor("thesis"), presetOf("thesis"), 2);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(countOf(*result, RelaxationEventKind::Activated), 5U);
  EXPECT_GE(countOf(*result, RelaxationEventKind::Aligned), 4U);
  EXPECT_EQ(countOf(*result, RelaxationEventKind::MovedBy), countOf(*result, RelaxationEventKind::Aligned));
  EXPECT_EQ(countOf(*result, RelaxationEventKind::Finished), 1U);
  EXPECT_EQ(result->moved[0].translation_m, 0.0);
  EXPECT_TRUE(result->unlinked.empty());
  EXPECT_GE(result->links.size(), 4U);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_GT(result->moved[i].translation_m, 1e-6) << i;
  // Points against points: decimetres at worst, where the plane metric has millimetres.
  EXPECT_LT(errorsOf(result->poses, small().truth).rms_m, 0.5);
}

TEST(Relaxation, TheThesisMethodHasTheSameBitsForAnyNumberOfThreads) {
  const auto one = relax(inputFor("thesis"), presetOf("thesis"), 1);
  const auto four = relax(inputFor("thesis"), presetOf("thesis"), 4);
  ASSERT_TRUE(one.has_value() && four.has_value());
  EXPECT_TRUE(sameBits(one->poses, four->poses));
}

TEST(Relaxation, TheThesisMethodReportsAScanFarAway) {
  RelaxationInput input = inputFor("thesis");
  input.world_from_scan[3] = Pose::planar(900.0, 0.0, 0.0);
  const auto result = relax(input, presetOf("thesis"), 2);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->unlinked, (std::vector<int>{3}));
  EXPECT_EQ(result->moved[3].translation_m, 0.0);
  EXPECT_FALSE(result->warnings.empty());
}

TEST(Relaxation, PinsHoldInEveryMethod) {
  for (const std::string preset : {"thesis", "sequential"}) {
    RelaxationInput input = inputFor(preset);
    input.pins = {2};
    const auto result = relax(input, presetOf(preset), 2);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->moved[0].translation_m, 0.0);
    EXPECT_EQ(result->moved[2].translation_m, 0.0);
    EXPECT_EQ(result->moved[2].rotation_rad, 0.0);
    EXPECT_GT(result->moved[1].translation_m, 0.0);
  }
}

TEST(Relaxation, SequentialRegistersEachScanOntoThoseBefore) {
  const auto result = relax(inputFor("sequential"), presetOf("sequential"), 2);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->steps.size(), 5U);
  EXPECT_EQ(countOf(*result, RelaxationEventKind::Aligned), 4U);
  EXPECT_LT(errorsOf(result->poses, small().truth).rms_m, 0.02);
  EXPECT_GT(result->moved[4].translation_m, 1e-5);
}

TEST(Relaxation, SequentialCarriesScansAlongWithAMendedOne) {
  // All starts behind scan 1 share its error; registering scan 1 must take them along before their own turn.
  RelaxationInput input = inputFor("sequential");
  const Pose off = Pose::planar(0.4, 0.3, 3.0 * kDegree);
  const Pose world_from_1 = input.world_from_scan[1];
  for (std::size_t i = 1; i < 5; ++i)
    input.world_from_scan[i] = world_from_1 * off * world_from_1.inverse() * input.world_from_scan[i];
  const auto result = relax(input, presetOf("sequential"), 2);
  ASSERT_TRUE(result.has_value());
  EXPECT_LT(errorsOf(result->poses, small().truth).rms_m, 0.02);
}

TEST(RelaxationSettings, PresetsAndParametersAgree) {
  const auto& table = relaxationParameters();
  EXPECT_EQ(table.operation(), "relax");
  EXPECT_EQ(presetOf("default").method, RelaxationMethod::Joint);
  EXPECT_EQ(presetOf("thesis").method, RelaxationMethod::ActiveSet);
  EXPECT_EQ(presetOf("thesis").registration.motion, MotionMethod::Svd);
  EXPECT_EQ(presetOf("sequential").method, RelaxationMethod::Sequential);
  for (const ParameterPreset& preset : table.presets())
    EXPECT_TRUE(checkSettings(presetOf(preset.name)).has_value());
  for (const ParameterInfo& info : table.infos()) {
    EXPECT_FALSE(info.help.empty()) << info.name;
    EXPECT_FALSE(info.source.empty()) << info.name;
  }
  RelaxationSettings settings;
  ASSERT_TRUE(table.apply({{"max-visits", 3LL}, {"requeue-rotation", 2.0}, {"patch-rows", 5LL}}, settings));
  EXPECT_EQ(settings.max_visits, 3);
  EXPECT_NEAR(settings.requeue_rotation_rad, 2.0 * kDegree, 1e-12);
  EXPECT_EQ(settings.registration.patch_rows, 5);
  EXPECT_FALSE(table.apply({{"max-visit", 3LL}}, settings));
}

TEST(RelaxationSettings, CombinationsWithoutSenseAreRefused) {
  RelaxationSettings settings = presetOf("thesis");
  settings.method = RelaxationMethod::Joint;
  EXPECT_FALSE(checkSettings(settings));
  settings.registration.motion = MotionMethod::PointToPlane;
  EXPECT_FALSE(checkSettings(settings));
  settings.registration.statistics = false;
  EXPECT_TRUE(checkSettings(settings));
}

}  // namespace
}  // namespace tiltmap
