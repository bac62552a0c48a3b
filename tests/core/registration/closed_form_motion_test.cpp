#include "core/registration/closed_form_motion.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

using Eigen::Vector3d;

struct Pairs {
  std::vector<Vector3d> model;
  std::vector<Vector3d> data;
};

std::vector<Vector3d> randomPoints(std::size_t count, const Vector3d& half_size_m, RandomStream& random) {
  std::vector<Vector3d> points(count);
  for (Vector3d& p : points)
    for (int k = 0; k < 3; ++k) p(k) = random.uniform(-half_size_m(k), half_size_m(k));
  return points;
}

Pose randomPose(RandomStream& random, double reach_m = 20.0) {
  const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
  return {q, Vector3d(random.uniform(-reach_m, reach_m), random.uniform(-reach_m, reach_m),
                      random.uniform(-2, 2))};
}

Pairs movedPairs(const std::vector<Vector3d>& data, const Pose& model_from_data, double noise_m,
                 RandomStream& random) {
  Pairs pairs;
  pairs.data = data;
  for (const Vector3d& p : data)
    pairs.model.push_back(model_from_data * p +
                          noise_m * Vector3d(random.normal(), random.normal(), random.normal()));
  return pairs;
}

double cost(const Pose& model_from_data, const Pairs& pairs, const std::vector<double>& weights = {}) {
  double sum = 0.0;
  for (std::size_t k = 0; k < pairs.model.size(); ++k)
    sum += (weights.empty() ? 1.0 : weights[k]) *
           (pairs.model[k] - model_from_data * pairs.data[k]).squaredNorm();
  return sum;
}

void expectSame(const Pose& a, const Pose& b, double rotation_rad, double translation_m) {
  const PoseDifference d = difference(a, b);
  EXPECT_LT(d.rotation_rad, rotation_rad);
  EXPECT_LT(d.translation_m, translation_m);
}

// Neither a small motion in any of the six directions nor any rotation of a random lot fits better.
void expectOptimal(const Pose& best, const Pairs& pairs, const std::vector<double>& weights = {}) {
  const double least = cost(best, pairs, weights);
  Vector3d centre = Vector3d::Zero();
  double weight = 0.0;
  for (std::size_t k = 0; k < pairs.data.size(); ++k) {
    const double w = weights.empty() ? 1.0 : weights[k];
    centre += w * pairs.data[k];
    weight += w;
  }
  centre /= weight;
  for (int k = 0; k < 6; ++k)
    for (const double step : {1e-3, -1e-3, 0.1, -0.1}) {
      Vector6d d = Vector6d::Zero();
      d(k) = step;
      EXPECT_GT(cost(best.moved(d), pairs, weights), least) << "direction " << k << " step " << step;
    }
  // Far rotations about the centroid: there is one minimum only, but a wrong choice of sign sits on a saddle.
  RandomStream random(99);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
    const Pose other(q, best * centre - q * centre);
    EXPECT_GE(cost(other, pairs, weights), least * (1.0 - 1e-12));
  }
}

class ClosedFormMotion : public testing::TestWithParam<ClosedForm> {
 protected:
  Result<Pose> solve(const Pairs& pairs, const std::vector<double>& weights = {}) const {
    return closedFormMotion(GetParam(), pairs.model, pairs.data, weights);
  }
};

INSTANTIATE_TEST_SUITE_P(AllFour, ClosedFormMotion,
                         testing::Values(ClosedForm::Svd, ClosedForm::OrthonormalMatrices,
                                         ClosedForm::UnitQuaternion, ClosedForm::DualQuaternion),
                         [](const auto& method) {
                           switch (method.param) {
                             case ClosedForm::Svd:
                               return std::string("Svd");
                             case ClosedForm::OrthonormalMatrices:
                               return std::string("OrthonormalMatrices");
                             case ClosedForm::UnitQuaternion:
                               return std::string("UnitQuaternion");
                             default:
                               return std::string("DualQuaternion");
                           }
                         });

TEST_P(ClosedFormMotion, CarriesTheDataOntoTheModelAndNotTheOtherWay) {
  // By hand: the data scan stands 3 m in front of the model scan, turned left by 90 degrees. A point 1 m in
  // front of it is 1 m to the left of where it stands.
  const Pairs pairs{{{-1, 3, 0}, {0, 4, 0}, {0, 3, 1}, {0, 3, 0}},
                    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, 0}}};
  const auto motion = solve(pairs);
  ASSERT_TRUE(motion);
  expectSame(*motion, Pose::planar(0, 3, 90 * kDegree), 1e-12, 1e-12);
  EXPECT_GT(difference(*motion, Pose::planar(0, 3, 90 * kDegree).inverse()).translation_m, 1.0);
}

TEST_P(ClosedFormMotion, RecoversAnyMotionOfCleanPairs) {
  RandomStream random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Pose truth = randomPose(random);
    const Pairs pairs = movedPairs(randomPoints(40, {20, 15, 4}, random), truth, 0.0, random);
    const auto motion = solve(pairs);
    ASSERT_TRUE(motion);
    expectSame(*motion, truth, 1e-12, 1e-11);
  }
}

TEST_P(ClosedFormMotion, ThreePairsAreEnough) {
  RandomStream random(2);
  const Pose truth = randomPose(random);
  const Pairs pairs = movedPairs({{0, 0, 0}, {2, 0, 0}, {0, 1, 0.5}}, truth, 0.0, random);
  const auto motion = solve(pairs);
  ASSERT_TRUE(motion);
  expectSame(*motion, truth, 1e-12, 1e-11);
}

TEST_P(ClosedFormMotion, RecoversPlanarInputInAnyPlaneAsARotation) {
  RandomStream random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Pose plane = randomPose(random);
    std::vector<Vector3d> data = randomPoints(30, {20, 10, 0}, random);
    for (Vector3d& p : data) p = plane * p;
    const Pose truth = randomPose(random);
    const auto motion = solve(movedPairs(data, truth, 0.0, random));
    ASSERT_TRUE(motion);
    EXPECT_GT(motion->rotation().determinant(), 0.0);
    expectSame(*motion, truth, 1e-10, 1e-9);
  }
}

TEST_P(ClosedFormMotion, RecoversALongThinStrip) {
  RandomStream random(4);
  const Pose truth = randomPose(random);
  const auto motion = solve(movedPairs(randomPoints(50, {10, 0.01, 0}, random), truth, 0.0, random));
  ASSERT_TRUE(motion);
  expectSame(*motion, truth, 1e-7, 1e-7);
}

TEST_P(ClosedFormMotion, KeepsItsDigitsFarFromTheOrigin) {
  RandomStream random(5);
  std::vector<Vector3d> data = randomPoints(50, {20, 15, 4}, random);
  const Vector3d national(4.5e5, 5.4e6, 200);
  const Eigen::Quaterniond turn = rotationExp({0.01, -0.02, 0.7});
  Pairs pairs;
  for (const Vector3d& p : data) {
    pairs.data.push_back(p + national);
    pairs.model.push_back(turn * p + national + Vector3d(1, 2, 3));
  }
  const auto motion = solve(pairs);
  ASSERT_TRUE(motion);
  EXPECT_LT(rotationLog(motion->quaternion() * turn.conjugate()).norm(), 1e-9);
  for (std::size_t k = 0; k < data.size(); ++k)
    EXPECT_LT((*motion * pairs.data[k] - pairs.model[k]).norm(), 1e-7);
}

TEST_P(ClosedFormMotion, IsTheLeastSquaresOptimumOfNoisyPairs) {
  RandomStream random(6);
  const Pairs pairs = movedPairs(randomPoints(60, {20, 15, 4}, random), randomPose(random), 0.3, random);
  const auto motion = solve(pairs);
  ASSERT_TRUE(motion);
  expectOptimal(*motion, pairs);
}

TEST_P(ClosedFormMotion, GivesTheBestProperRotationOfMirroredInput) {
  RandomStream random(7);
  for (int trial = 0; trial < 20; ++trial) {
    Pairs pairs = movedPairs(randomPoints(60, {20, 12, 5}, random), randomPose(random), 0.02, random);
    for (Vector3d& p : pairs.data) p.x() = -p.x();
    const auto motion = solve(pairs);
    ASSERT_TRUE(motion);
    EXPECT_NEAR(motion->rotation().determinant(), 1.0, 1e-12);
    expectOptimal(*motion, pairs);
  }
}

TEST_P(ClosedFormMotion, GivesARotationOfMirroredCubeCornersWhereManyAreEquallyGood) {
  Pairs pairs;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0}) {
        pairs.model.emplace_back(x, y, z);
        pairs.data.emplace_back(-x, y, z);
      }
  const auto motion = solve(pairs);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->rotation().determinant(), 1.0, 1e-12);
  // Singular values 8, 8, 8 with one turned round: 24 + 24 - 2 * (8 + 8 - 8).
  EXPECT_NEAR(cost(*motion, pairs), 32.0, 1e-9);
}

TEST_P(ClosedFormMotion, GivesTheBestRotationOfNoisyPlanarPairsOnEitherSideOfAMirror) {
  // Noise decides the sign of the determinant here: the case in which the unguarded SVD gives mirror images.
  RandomStream random(8);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose truth = randomPose(random);
    const Pairs pairs = movedPairs(randomPoints(12, {10, 8, 0.001}, random), truth, 0.02, random);
    const auto motion = solve(pairs);
    ASSERT_TRUE(motion);
    EXPECT_LT(difference(*motion, truth).rotation_rad, 0.05);
    expectOptimal(*motion, pairs);
  }
}

TEST_P(ClosedFormMotion, WeightsCountAsRepeatedPairs) {
  RandomStream random(9);
  const Pairs pairs = movedPairs(randomPoints(20, {10, 10, 3}, random), randomPose(random), 0.2, random);
  Pairs repeated;
  std::vector<double> weights;
  for (std::size_t k = 0; k < pairs.model.size(); ++k) {
    const std::size_t times = k % 4;  // zero leaves the pair out
    weights.push_back(static_cast<double>(times));
    for (std::size_t t = 0; t < times; ++t) {
      repeated.model.push_back(pairs.model[k]);
      repeated.data.push_back(pairs.data[k]);
    }
  }
  const auto weighted = solve(pairs, weights);
  const auto counted = solve(repeated);
  const auto unweighted = solve(pairs);
  ASSERT_TRUE(weighted && counted && unweighted);
  expectSame(*weighted, *counted, 1e-11, 1e-10);
  EXPECT_GT(difference(*weighted, *unweighted).translation_m, 1e-4);
  expectOptimal(*weighted, pairs, weights);
}

TEST_P(ClosedFormMotion, AWrongPairOfNoWeightDoesNoHarm) {
  RandomStream random(10);
  const Pose truth = randomPose(random);
  Pairs pairs = movedPairs(randomPoints(10, {10, 10, 3}, random), truth, 0.0, random);
  pairs.model.front() = {500, -500, 80};  // the pair that the dual quaternions count from
  std::vector<double> weights(10, 1.0);
  weights.front() = 0.0;
  const auto motion = solve(pairs, weights);
  ASSERT_TRUE(motion);
  expectSame(*motion, truth, 1e-9, 1e-8);
}

TEST_P(ClosedFormMotion, RefusesPairsThatLeaveTheRotationFree) {
  RandomStream random(11);
  const Pose truth = randomPose(random);
  std::vector<Vector3d> line;
  for (int k = 0; k < 20; ++k) line.push_back(Vector3d(1, 2, -3) + 0.37 * k * Vector3d(0.3, -0.5, 0.8));
  const auto collinear = solve(movedPairs(line, truth, 0.0, random));
  ASSERT_FALSE(collinear);
  EXPECT_NE(collinear.error().what.find("one line"), std::string::npos);
  EXPECT_FALSE(collinear.error().remedy.empty());

  const auto coincident =
      solve(movedPairs(std::vector<Vector3d>(9, Vector3d(4.1, 5.2, 6.3)), truth, 0.0, random));
  ASSERT_FALSE(coincident);
  EXPECT_NE(coincident.error().what.find("one place"), std::string::npos);

  // A line on one side is enough: many data points paired with the points of one edge.
  Pairs one_sided{line, randomPoints(line.size(), {5, 5, 5}, random)};
  EXPECT_FALSE(solve(one_sided));
  // One model point for all data points.
  Pairs to_one_point{std::vector<Vector3d>(12, Vector3d(1, 1, 1)), randomPoints(12, {5, 5, 5}, random)};
  EXPECT_FALSE(solve(to_one_point));
  // At the origin the size is zero as well.
  EXPECT_FALSE(
      solve({std::vector<Vector3d>(5, Vector3d::Zero()), std::vector<Vector3d>(5, Vector3d::Zero())}));
}

TEST_P(ClosedFormMotion, RefusesTooFewPairsAndWrongNumbers) {
  RandomStream random(12);
  const Pairs good = movedPairs(randomPoints(6, {10, 10, 3}, random), randomPose(random), 0.0, random);
  EXPECT_FALSE(solve({}));
  for (const std::size_t count : {1U, 2U}) {
    const Pairs few{{good.model.begin(), good.model.begin() + static_cast<long>(count)},
                    {good.data.begin(), good.data.begin() + static_cast<long>(count)}};
    const auto motion = solve(few);
    ASSERT_FALSE(motion);
    EXPECT_NE(motion.error().what.find("three are needed"), std::string::npos);
  }
  Pairs uneven = good;
  uneven.data.pop_back();
  EXPECT_FALSE(solve(uneven));
  EXPECT_FALSE(solve(good, {1.0, 1.0}));
  EXPECT_FALSE(solve(good, {1, 1, 0, 0, 0, 0}));
  EXPECT_FALSE(solve(good, {1, 1, 1, -1, 1, 1}));
  EXPECT_FALSE(solve(good, {1, 1, 1, std::nan(""), 1, 1}));
  Pairs bad = good;
  bad.model[3].y() = std::numeric_limits<double>::quiet_NaN();
  const auto motion = solve(bad);
  ASSERT_FALSE(motion);
  EXPECT_NE(motion.error().where.find("pair 3"), std::string::npos);
  EXPECT_TRUE(solve(good, std::vector<double>(6, 2.0)));
}

TEST(ClosedFormMotions, AgreeWithEachOtherOnNoisyPairsToo) {
  RandomStream random(13);
  for (int trial = 0; trial < 200; ++trial) {
    Pairs pairs =
        movedPairs(randomPoints(80, {25, 20, 4}, random), randomPose(random), trial % 4 * 0.05, random);
    if (trial % 5 == 0)
      for (Vector3d& p : pairs.data) p.z() = -p.z();  // mirrored
    const auto reference = closedFormMotion(ClosedForm::Svd, pairs.model, pairs.data);
    ASSERT_TRUE(reference);
    for (const ClosedForm method :
         {ClosedForm::OrthonormalMatrices, ClosedForm::UnitQuaternion, ClosedForm::DualQuaternion}) {
      const auto other = closedFormMotion(method, pairs.model, pairs.data);
      ASSERT_TRUE(other);
      expectSame(*other, *reference, 1e-10, 1e-9);
    }
  }
}

}  // namespace
}  // namespace tiltmap
