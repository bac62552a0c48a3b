#include "core/multiview/pose_covariance.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

constexpr double kDamping = 1e-3;

Pose randomPose(RandomStream& random, double angle_rad, double shift_m) {
  const auto part = [&](double scale) {
    return Eigen::Vector3d(random.normal() * scale, random.normal() * scale, random.normal() * scale);
  };
  return Pose(rotationExp(part(angle_rad)), part(shift_m));
}

Matrix6d randomInformation(RandomStream& random) {
  Matrix6d a;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) a(r, c) = random.normal();
  const Matrix6d spread = (Vector6d() << 2e3, 1e3, 3e3, 50, 100, 70).finished().asDiagonal();
  return spread * (a * a.transpose() + Matrix6d::Identity()) * spread;
}

// The whole matrix, inverted: what the sparse one must agree with.
std::vector<Matrix6d> byTheBook(std::size_t count, const std::vector<char>& held,
                                const std::vector<PairTerm>& terms) {
  const auto n = static_cast<Eigen::Index>(6 * count);
  Eigen::MatrixXd whole = kDamping * Eigen::MatrixXd::Identity(n, n);
  const auto rows = [&](const PairTerm& term) {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, n);
    if (!held[static_cast<std::size_t>(term.moving)])
      jacobian.middleCols<6>(6 * term.moving) += adjoint(term.fixed_from_moving);
    if (!held[static_cast<std::size_t>(term.fixed)])
      jacobian.middleCols<6>(6 * term.fixed) -= Matrix6d::Identity();
    return jacobian;
  };
  for (const PairTerm& term : terms) whole += rows(term).transpose() * term.h * rows(term);
  const Eigen::MatrixXd inverse = whole.inverse();
  std::vector<Matrix6d> covariances;
  for (const PairTerm& term : terms) covariances.emplace_back(rows(term) * inverse * rows(term).transpose());
  return covariances;
}

// A ring with chords, some of them of no information.
std::vector<PairTerm> someTerms(int count, RandomStream& random) {
  std::vector<PairTerm> terms;
  const auto tie = [&](int a, int b, bool tells) {
    PairTerm term{a, b, randomPose(random, 0.5, 8.0), {}, {}};
    term.h = tells ? randomInformation(random) : Matrix6d(Matrix6d::Zero());
    term.b.setZero();
    terms.push_back(term);
  };
  for (int i = 0; i < count; ++i) tie(i, (i + 1) % count, true);
  for (int i = 0; i + 3 < count; i += 2) tie(i + 3, i, i % 4 == 0);
  tie(0, count / 2, false);
  return terms;
}

void expectSame(const std::vector<Matrix6d>& a, const std::vector<Matrix6d>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    EXPECT_LE((a[k] - b[k]).norm(), 1e-7 * b[k].norm()) << "term " << k;
}

TEST(PoseCovariance, AgreesWithTheInverseOfTheWholeMatrix) {
  RandomStream random(11);
  const auto terms = someTerms(15, random);
  std::vector<char> held(15, 0);
  held[0] = 1;
  expectSame(termCovariances(15, held, terms, kDamping).value(), byTheBook(15, held, terms));
  held[7] = held[8] = 1;  // one term between two certain poses
  const auto covariances = termCovariances(15, held, terms, kDamping).value();
  expectSame(covariances, byTheBook(15, held, terms));
  EXPECT_TRUE(covariances[7].isZero());
}

TEST(PoseCovariance, OneTieAloneIsAsCertainAsItSays) {
  RandomStream random(3);
  PairTerm term{0, 1, randomPose(random, 0.3, 5.0), randomInformation(random), Vector6d::Zero()};
  const auto covariance = termCovariances(2, {1, 0}, {term}, 1e-9).value().front();
  EXPECT_LT((covariance * term.h - Matrix6d::Identity()).norm(), 1e-5);
  // The other way round, the fixed one unknown.
  const auto other = termCovariances(2, {0, 1}, {term}, 1e-9).value().front();
  EXPECT_LT((other - covariance).norm(), 1e-5 * covariance.norm());
}

TEST(PoseCovariance, AnotherTieMakesItMoreCertainAndOneWithoutInformationDoesNot) {
  RandomStream random(4);
  const PairTerm term{0, 1, randomPose(random, 0.3, 5.0), randomInformation(random), Vector6d::Zero()};
  PairTerm silent = term;
  silent.h.setZero();
  const auto alone = termCovariances(2, {1, 0}, {term, silent}, 1e-9).value();
  const auto twice = termCovariances(2, {1, 0}, {term, term}, 1e-9).value();
  EXPECT_LT((alone[0] - alone[1]).norm(), 1e-6 * alone[0].norm());
  EXPECT_LT((twice[0] - 0.5 * alone[0]).norm(), 1e-5 * alone[0].norm());
}

TEST(PoseCovariance, ThereMayBeNothingToAsk) {
  EXPECT_TRUE(termCovariances(0, {}, {}, kDamping).value().empty());
  EXPECT_TRUE(termCovariances(3, {0, 0, 0}, {}, kDamping).value().empty());
  const PairTerm term{0, 1, Pose(), Matrix6d::Identity(), Vector6d::Zero()};
  EXPECT_TRUE(termCovariances(2, {1, 1}, {term}, kDamping).value().front().isZero());
  const PairTerm silent{0, 1, Pose(), Matrix6d::Zero(), Vector6d::Zero()};
  EXPECT_FALSE(termCovariances(2, {1, 0}, {silent}, 0.0)) << "nothing holds the pose";
}

}  // namespace
}  // namespace tiltmap
