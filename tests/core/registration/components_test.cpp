// Pair choice, sampling, direction buckets and settings, each by hand-made cases.
#include <algorithm>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/registration/metric.h"
#include "core/registration/pair_choice.h"
#include "core/registration/sampling.h"
#include "support/room_scene.h"

namespace tiltmap {
namespace {

using V = Eigen::Vector3d;

PreparedScan scanOf(std::vector<V> positions, std::vector<V> normals) {
  PreparedScan scan;
  scan.elements.position = std::move(positions);
  scan.elements.normal = std::move(normals);
  if (!scan.elements.empty()) {
    scan.tree.emplace(scan.elements.position);
    scan.directions.emplace(scan.elements.position, 3.0 * kDegree, scan.elements.normal);
    scan.wide_directions.emplace(scan.elements.position, 9.0 * kDegree, scan.elements.normal);
  }
  return scan;
}

// The partner that one point at (0, 5, 0) with the given normal finds.
Correspondence choice(const PreparedScan& fixed, PairChoice pair_choice, const V& normal,
                      const Pose& fixed_from_moving = Pose()) {
  const PreparedScan moving = scanOf({V(0, 5, 0)}, {normal});
  RegistrationSettings settings;
  settings.pair_choice = pair_choice;
  const std::vector<std::uint32_t> sample{0};
  std::vector<Correspondence> pairs;
  choosePairs(moving, fixed, fixed_from_moving, sample, false, 0.0, settings, pairs);
  EXPECT_EQ(pairs.size(), 1U);
  return pairs.front();
}

const V kBack(0, -1, 0), kUp(0, 0, 1);

TEST(PairChoice, EachTakesItsOwnPartner) {
  // 0: nearest, wrong normal; 1: a little further, right normal; 2: further, on the line along the normal.
  const PreparedScan fixed =
      scanOf({V(0.02, 5, 0), V(0.1, 5.02, 0.02), V(0, 5.4, 0.001)}, {kUp, kBack, V(0, -1, 0.1).normalized()});
  EXPECT_EQ(choice(fixed, PairChoice::Nearest, kBack).fixed, 0U);
  EXPECT_EQ(choice(fixed, PairChoice::BestNormalInLeaf, kBack).fixed, 1U);
  EXPECT_EQ(choice(fixed, PairChoice::NormalShooting, kBack).fixed, 2U);
  EXPECT_EQ(choice(fixed, PairChoice::Projective, kBack).fixed, 1U);
  const Correspondence pair = choice(fixed, PairChoice::BestNormalInLeaf, kBack);
  EXPECT_NEAR(pair.distance_m, V(0.1, 0.02, 0.02).norm(), 1e-6);
  EXPECT_NEAR(pair.cos_angle, 1.0, 1e-6);
  EXPECT_TRUE(pair.has_normals);
  EXPECT_NEAR(choice(fixed, PairChoice::Nearest, kBack).cos_angle, 0.0, 1e-6);
}

TEST(PairChoice, PlacesTheMovingPointByThePoseAndNotItsInverse) {
  const PreparedScan fixed = scanOf({V(1, 5, 0), V(-1, 5, 0)}, {kBack, kBack});
  const Pose right(Eigen::Quaterniond::Identity(), V(0.9, 0, 0));
  EXPECT_EQ(choice(fixed, PairChoice::Nearest, kBack, right).fixed, 0U);
  EXPECT_EQ(choice(fixed, PairChoice::Projective, kBack, right).fixed, 0U);
  EXPECT_EQ(choice(fixed, PairChoice::Nearest, kBack, right.inverse()).fixed, 1U);
}

TEST(PairChoice, ProjectiveFindsNobodyElsewhereAndTheWrongNormalLast) {
  EXPECT_EQ(choice(scanOf({V(5, 0, 0)}, {kBack}), PairChoice::Projective, kBack).reason,
            RejectReason::NoPartner);
  const Correspondence wrong = choice(scanOf({V(0, 5, 0)}, {kUp}), PairChoice::Projective, kBack);
  EXPECT_TRUE(wrong.kept());  // the rules reject it, by its reason
  EXPECT_NEAR(wrong.cos_angle, 0.0, 1e-6);
}

TEST(PairChoice, NobodyToPairWith) {
  for (const PairChoice c : {PairChoice::Nearest, PairChoice::BestNormalInLeaf, PairChoice::NormalShooting,
                             PairChoice::Projective})
    EXPECT_EQ(choice(scanOf({}, {}), c, kBack).reason, RejectReason::NoPartner);
}

TEST(PairChoice, AnUnpreparedScanIsABrokenContract) {
  PreparedScan fixed = scanOf({V(0, 5, 0)}, {kBack});
  fixed.tree.reset();
  EXPECT_THROW(choice(fixed, PairChoice::Nearest, kBack), std::logic_error);
}

TEST(PairChoice, BothDirectionsKeepTheirSides) {
  const PreparedScan fixed = scanOf({V(0, 5, 0), V(0, 5.2, 0)}, {kBack, kBack}),
                     moving = scanOf({V(0, 5.1, 0)}, {kBack});
  RegistrationSettings settings;
  settings.pair_choice = PairChoice::Nearest;
  const std::vector<std::uint32_t> both{0, 1}, one{0};
  RejectionState state;
  std::vector<Correspondence> pairs;
  findPairs(fixed, moving, Pose(), both, one, 0.05, settings, state, pairs);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_FALSE(pairs[0].from_fixed);
  EXPECT_TRUE(pairs[1].from_fixed && pairs[2].from_fixed);
  EXPECT_EQ(pairs[2].fixed, 1U);
  EXPECT_EQ(pairs[2].moving, 0U);
  findPairs(fixed, moving, Pose(), both, one, 0.5, settings, state, pairs);  // too coarse for both
  EXPECT_EQ(pairs.size(), 1U);
}

TEST(DirectionIndex, FindsEverythingWithinABucketOfTheDirection) {
  RandomStream random(3);
  std::vector<V> points;
  for (int i = 0; i < 3000; ++i)
    points.push_back(V(random.normal(), random.normal(), random.normal()).normalized() *
                     random.uniform(1, 50));
  points.push_back(V::Zero());  // in no bucket
  const double bucket = 3.0 * kDegree;
  const DirectionIndex index(points, bucket);
  EXPECT_THROW(index.nearestFitting(points.front(), V::UnitX(), 0.5), std::logic_error);
  for (int k = 0; k < 300; ++k) {
    V query = V(random.normal(), random.normal(), random.normal()).normalized();
    if (k == 0) query = V::UnitZ();
    if (k == 1) query = -V::UnitZ();
    if (k == 2) query = V(1, -1e-12, 0);
    std::multiset<std::uint32_t> seen;
    index.around(query, [&](const std::uint32_t* a, const std::uint32_t* b) { seen.insert(a, b); });
    for (std::uint32_t i = 0; i + 1 < points.size(); ++i) {
      const double angle = std::acos(std::clamp(query.dot(points[i].normalized()), -1.0, 1.0));
      if (angle < 0.8 * bucket) {
        EXPECT_EQ(seen.count(i), 1U) << k << " " << i << " " << angle / kDegree;
      }
      if (angle > 3.5 * bucket && std::abs(query.z()) < 0.9) {
        EXPECT_EQ(seen.count(i), 0U);
      }
      EXPECT_LE(seen.count(i), 1U);
    }
  }
}

SurfaceElements manyElements() {
  SurfaceElements elements;  // 90 % look up, 10 % to the back
  for (int i = 0; i < 1000; ++i) {
    elements.position.emplace_back(i, 0, 0);
    elements.normal.push_back(i % 10 == 9 ? kBack : kUp);
  }
  return elements;
}

TEST(Sampling, TakesWhatItSays) {
  const SurfaceElements elements = manyElements();
  RegistrationSettings s;
  s.sampling_step = 4;
  s.sampling = Sampling::All;
  EXPECT_EQ(sampledElements(elements, s).size(), 1000U);
  s.sampling = Sampling::Uniform;
  const auto uniform = sampledElements(elements, s);
  ASSERT_EQ(uniform.size(), 250U);
  EXPECT_EQ(uniform[1], 4U);
  s.sampling = Sampling::Random;
  const auto random = sampledElements(elements, s);
  EXPECT_EQ(random.size(), 250U);
  EXPECT_EQ(std::set<std::uint32_t>(random.begin(), random.end()).size(), 250U);
  EXPECT_EQ(random, sampledElements(elements, s));
  s.seed = 2;
  EXPECT_NE(random, sampledElements(elements, s));
  s.sampling = Sampling::NormalSpace;
  const auto even = sampledElements(elements, s);
  EXPECT_EQ(even.size(), 250U);
  EXPECT_TRUE(std::ranges::is_sorted(even));
  const auto to_the_back = std::ranges::count_if(even, [](std::uint32_t i) { return i % 10 == 9; });
  EXPECT_EQ(to_the_back, 100);  // all there are: fewer than their half
  EXPECT_TRUE(sampledElements({}, s).empty());
}

TEST(Metric, JacobiansAreTheDerivativesOfTheCost) {
  // One pair of patches: b is the gradient of half the weighted squared residual, by central differences.
  SurfaceElements fixed, moving;
  PatchShape shape;
  shape.u = V::UnitX();
  shape.v = V::UnitZ();
  shape.offset_variance_m2 = 1e-4;
  shape.tilt_variance_u = 2e-4;
  shape.tilt_variance_v = 3e-4;
  fixed.position = {V(1, 5, 0.3)};
  fixed.normal = {V(0.1, -1, 0.05).normalized()};
  fixed.shape = {shape};
  moving.position = {V(1.3, 5.1, 0.1)};
  moving.normal = {V(-0.05, -1, 0.1).normalized()};
  shape.tilt_variance_u = 5e-4;
  moving.shape = {shape};
  Correspondence pair;
  pair.has_normals = true;
  const std::vector<Correspondence> pairs{pair};
  const RegistrationSettings settings;
  const Pose pose(rotationExp({0.02, 0.01, -0.03}), {0.05, 0.02, 0.04});
  for (const Metric metric : {Metric::PointToPlane, Metric::PatchToPatch, Metric::PointGicp}) {
    SCOPED_TRACE(static_cast<int>(metric));
    LinearSystem at;
    linearise(metric, fixed, moving, Pose(), pose, pairs, settings, 0.0, at);
    // The residual's weight and blend change in second order only near a fixed linearisation point, so
    // compare the residual itself: sqrt(loss_square) has the gradient b / sqrt(w) for a single row.
    const auto square = [](const LinearSystem& system) { return system.loss_square_m2 / system.loss_weight; };
    const double r0 = std::sqrt(square(at));
    const double weight = metric == Metric::PatchToPatch ? at.plane_weight : 1.0;
    for (int k = 0; k < 6; ++k) {
      Vector6d d = Vector6d::Zero();
      d[k] = 1e-5;
      LinearSystem up, down;
      linearise(metric, fixed, moving, Pose(), pose.moved(d), pairs, settings, 0.0, up);
      linearise(metric, fixed, moving, Pose(), pose.moved(-d), pairs, settings, 0.0, down);
      const double slope = (square(up) - square(down)) / (4e-5);
      // Blend and covariances move with the pose too; that part is small against the slope.
      EXPECT_NEAR(at.b[k] / weight, slope, 0.15 * std::abs(slope) + 0.02 * r0) << k;
    }
  }
}

TEST(Metric, MovingBothScansAlikeChangesNothing) {
  const Scan a = test_support::sceneScan(test_support::roomScene(), Pose(), 0.005, 4);
  const Scan b = test_support::sceneScan(test_support::roomScene(), Pose(), 0.005, 5);
  const RegistrationSettings settings;
  const PreparedScanPtr fixed = prepare(a, settings), moving = prepare(b, settings);
  std::vector<std::uint32_t> all(moving->elements.size()), none;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
  RejectionState state;
  std::vector<Correspondence> pairs;
  findPairs(*fixed, *moving, Pose(), none, all, 0.02, settings, state, pairs);
  const Pose world(rotationExp({0.3, 0.2, 1.0}), {10, -4, 2});
  LinearSystem here, there;
  linearise(Metric::PatchToPatch, fixed->elements, moving->elements, Pose(), Pose(), pairs, settings, 0.02,
            here);
  linearise(Metric::PatchToPatch, fixed->elements, moving->elements, world, world, pairs, settings, 0.02,
            there);
  EXPECT_GT(here.pairs, 50U);
  EXPECT_NEAR(here.loss_square_m2, there.loss_square_m2, 1e-9);
  EXPECT_NEAR(here.h.diagonal().tail<3>().sum(), there.h.diagonal().tail<3>().sum(), 1e-6 * here.h.trace());
}

TEST(Settings, TheTableHoldsEverythingAndRoundTrips) {
  const auto& table = registrationParameters();
  for (const ParameterInfo& info : table.infos()) {
    EXPECT_FALSE(info.help.empty()) << info.name;
    EXPECT_FALSE(info.source.empty()) << info.name;
    EXPECT_TRUE(parseParameter(info, parameterText(info.default_value)).has_value()) << info.name;
  }
  ASSERT_EQ(table.presets().size(), 2U);
  const RegistrationSettings thesis = table.presetSettings("thesis").value();
  RegistrationSettings copy;
  ASSERT_TRUE(table.apply(table.values(thesis), copy).has_value());
  EXPECT_EQ(table.values(copy), table.values(thesis));
  EXPECT_NE(table.values(copy), table.values(RegistrationSettings{}));
  EXPECT_FALSE(table.presetSettings("theses").has_value());
  EXPECT_TRUE(checkSettings(thesis).has_value());
  EXPECT_TRUE(checkSettings(RegistrationSettings{}).has_value());
}

TEST(Settings, TheThesisPresetIsTheThesis) {
  const ParameterValues values = registrationParameters().values(thesisSettings());
  EXPECT_EQ(std::get<std::string>(values.at("filter")), "median");
  EXPECT_EQ(std::get<bool>(values.at("filter-no-return-votes")), true);
  EXPECT_NEAR(std::get<double>(values.at("filter-threshold")), 2.0, 1e-12);
  EXPECT_EQ(std::get<std::string>(values.at("reduction")), "line");
  EXPECT_NEAR(std::get<double>(values.at("reduction-distance")), 0.5, 1e-12);
  EXPECT_EQ(std::get<std::string>(values.at("sampling")), "uniform");
  EXPECT_EQ(std::get<long long>(values.at("sampling-step")), 4);
  EXPECT_EQ(std::get<std::string>(values.at("pair-choice")), "best-normal");
  EXPECT_NEAR(std::get<double>(values.at("max-distance")), 5.0, 1e-12);
  EXPECT_NEAR(std::get<double>(values.at("max-angle")), 20.0, 1e-9);
  EXPECT_NEAR(std::get<double>(values.at("statistics-distance")), 0.5, 1e-12);
  EXPECT_EQ(std::get<std::string>(values.at("motion")), "svd");
  EXPECT_NEAR(std::get<double>(values.at("min-change")), 0.1, 1e-12);
  EXPECT_EQ(std::get<long long>(values.at("max-iterations")), 100);
}

TEST(Settings, ImpossibleCombinationsAreRefusedWithAWayOut) {
  const auto refused = [](auto change) {
    RegistrationSettings s;
    change(s);
    const Status status = checkSettings(s);
    return !status && !status.error().what.empty() && !status.error().remedy.empty();
  };
  EXPECT_TRUE(refused([](auto& s) { s.motion = MotionMethod::DualQuaternion; }));
  EXPECT_TRUE(refused([](auto& s) { s.pair_choice = PairChoice::BestNormalInLeaf; }));
  EXPECT_TRUE(refused([](auto& s) { s.statistics = true; }));
  EXPECT_TRUE(refused([](auto& s) { s.loss_start_m = 0.001; }));
  EXPECT_TRUE(refused([](auto& s) { s.statistics = true, s.loss = Loss::None; }));
  EXPECT_FALSE(refused([](auto& s) { s.motion = MotionMethod::PointToPlane; }));
  EXPECT_FALSE(refused([](auto& s) { s.statistics = true, s.loss = Loss::None, s.max_distance_m = 3.0; }));
}

}  // namespace
}  // namespace tiltmap
