#include "core/registration/pair_judgement.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/support/room_scene.h"

namespace tiltmap {
namespace {

using test_support::almostEmptyScan;
using test_support::groundScene;
using test_support::roomScene;
using test_support::sceneScan;

const Pose kTruth = Pose::planar(0.6, 0.9, 0.15);

JudgedScanPtr seen(const Scan& scan, const RegistrationSettings& settings = {}) {
  return judgedScan(prepare(scan, settings));
}

class PairJudgementTest : public testing::Test {
 protected:
  // The room's surfaces end nowhere, so that little is hidden: what is off stands out.
  JudgedScanPtr fixed_ = seen(sceneScan(roomScene(), Pose(), 0.012, 1));
  JudgedScanPtr moving_ = seen(sceneScan(roomScene(), kTruth, 0.012, 2));

  PairJudgement at(const Pose& pose) const {
    PairClaim claim;
    claim.fixed_from_moving = pose;
    claim.start = pose;
    return judgePair(*fixed_, *moving_, claim);
  }
};

TEST_F(PairJudgementTest, ARightPoseIsGood) {
  const PairJudgement j = at(kTruth);
  EXPECT_EQ(j.verdict, Verdict::Good) << j.reason;
  EXPECT_LE(j.badness, 1.0);
  EXPECT_GT(j.fit, 0.9);
  EXPECT_LT(j.through, 0.01);
  EXPECT_GT(j.overlap_moving, 0.3);
  EXPECT_GT(j.overlap_fixed, 0.3);
  EXPECT_LT(j.excess_m, 0.005);
  EXPECT_NEAR(j.residual_m / j.expected_m, 1.0, 0.5);
  EXPECT_LT(j.strength.weakest_m, 0.01);
  EXPECT_NE(j.strength_sentence.find("held in all directions"), std::string::npos);
  EXPECT_EQ(j.moved.translation_m, 0.0);
}

TEST_F(PairJudgementTest, TheOtherWayRoundIsAsGood) {
  PairClaim claim;
  claim.fixed_from_moving = claim.start = kTruth.inverse();
  const PairJudgement j = judgePair(*moving_, *fixed_, claim), straight = at(kTruth);
  EXPECT_EQ(j.verdict, Verdict::Good) << j.reason;
  EXPECT_NEAR(j.overlap_fixed, straight.overlap_moving, 0.02);
  EXPECT_NEAR(j.fit, straight.fit, 0.02);
}

TEST_F(PairJudgementTest, NoPoseThatIsOffIsGood) {
  for (const Pose& off : {Pose::planar(0.05, 0, 0), Pose::planar(0, -0.05, 0), Pose::planar(0.3, 0.4, 0),
                          Pose::planar(0, 0, 0.5 * kDegree), Pose::planar(0, 0, -3 * kDegree),
                          Pose(Eigen::Quaterniond::Identity(), {0, 0, 0.06}),
                          Pose(rotationExp({0.4 * kDegree, 0, 0}), Eigen::Vector3d::Zero())}) {
    const PairJudgement j = at(kTruth * off);
    EXPECT_NE(j.verdict, Verdict::Good) << difference(off, Pose()).translation_m << " m: " << j.reason;
    EXPECT_GT(j.badness, 1.0);
    EXPECT_FALSE(j.reason.empty());
  }
}

TEST_F(PairJudgementTest, APoseLeftBeforeItsRestIsPulledHomeAndItsCovarianceSaysSo) {
  for (const double off_m : {0.01, 0.02, 0.03}) {
    const Pose pose = kTruth * Pose::planar(off_m, -0.5 * off_m, 0.001);
    const PairJudgement j = at(pose);
    const double off = difference(kTruth, pose).translation_m;
    EXPECT_NEAR(j.pull_m, off, 0.2 * off + 0.003) << off_m;
    const Pose error = kTruth.inverse() * pose;
    Vector6d e;
    e << rotationLog(error.quaternion()), error.translation();
    EXPECT_LT(e.dot(j.strength.covariance.ldlt().solve(e)), 16.8) << "beyond 99 of 100, off by " << off_m;
  }
}

TEST_F(PairJudgementTest, SeeingThroughASurfaceCondemns) {
  // The moving scan's walls stand metres in front of the fixed one's.
  const PairJudgement j = at(Pose::planar(0, -3.0, 0) * kTruth);
  EXPECT_EQ(j.verdict, Verdict::Bad);
  EXPECT_GT(j.through, 0.1) << j.reason;
}

TEST_F(PairJudgementTest, AFailedRegistrationIsBadWhateverThePose) {
  PairClaim claim;
  claim.fixed_from_moving = claim.start = kTruth;
  claim.succeeded = false;
  claim.ended = "no overlap: try elsewhere";
  const PairJudgement j = judgePair(*fixed_, *moving_, claim);
  EXPECT_EQ(j.verdict, Verdict::Bad);
  EXPECT_EQ(j.reason, claim.ended);
}

TEST_F(PairJudgementTest, ALongWayFromTheStartIsACauseForDoubtOnly) {
  PairClaim claim;
  claim.fixed_from_moving = kTruth;
  claim.start = Pose::planar(9.0, 0, 0) * kTruth;
  const PairJudgement j = judgePair(*fixed_, *moving_, claim);
  EXPECT_EQ(j.verdict, Verdict::Doubtful);
  EXPECT_NEAR(j.moved.translation_m, 9.0, 1e-9);
  EXPECT_NE(j.reason.find("9.0 m"), std::string::npos) << j.reason;
}

TEST_F(PairJudgementTest, LimitsAreParameters) {
  PairClaim claim;
  claim.fixed_from_moving = claim.start = kTruth;
  JudgementSettings strict;
  ASSERT_TRUE(judgementParameters().apply({{"weak-good", 0.01}}, strict));
  EXPECT_DOUBLE_EQ(strict.weak_good_m, 1e-5);
  const PairJudgement j = judgePair(*fixed_, *moving_, claim, strict);
  EXPECT_EQ(j.verdict, Verdict::Doubtful);
  EXPECT_NE(j.reason.find("can slide"), std::string::npos) << j.reason;
}

TEST_F(PairJudgementTest, ScansPreparedAsPointsAreJudgedAsWell) {
  const JudgedScanPtr points = seen(sceneScan(roomScene(), kTruth, 0.012, 2), thesisSettings());
  PairClaim claim;
  claim.fixed_from_moving = claim.start = kTruth;
  const PairJudgement j = judgePair(*fixed_, *points, claim), patches = at(kTruth);
  EXPECT_EQ(j.verdict, Verdict::Good) << j.reason;
  EXPECT_EQ(j.fit, patches.fit);
}

TEST(PairJudgement, TheBareGroundIsFreeToSlide) {
  const JudgedScanPtr fixed = seen(sceneScan(groundScene(), Pose(), 0.012, 1));
  const JudgedScanPtr moving = seen(sceneScan(groundScene(), Pose::planar(0.5, 0.2, 0), 0.012, 2));
  PairClaim claim;
  claim.fixed_from_moving = claim.start = Pose::planar(2.0, 1.0, 0.1);  // as good as any other
  const PairJudgement j = judgePair(*fixed, *moving, claim);
  EXPECT_NE(j.verdict, Verdict::Good) << j.reason;
  EXPECT_GT(j.strength.weakest_m, 0.1);
  EXPECT_LT(j.strength.up_m, 0.03);  // by the ground within some 13 m: further off the spot is drawn out
  EXPECT_NE(j.strength_sentence.find("slide"), std::string::npos) << j.strength_sentence;
}

TEST(PairJudgement, ACorridorSlidesAlongItself) {
  const std::vector<test_support::ScenePlane> corridor = {
      {{0, 0, 1}, -1.0}, {{1, 0, 0}, 2.0}, {{-1, 0, 0}, 2.0}};
  const JudgedScanPtr fixed = seen(sceneScan(corridor, Pose(), 0.012, 1));
  const JudgedScanPtr moving = seen(sceneScan(corridor, Pose::planar(0, 0.5, 0), 0.012, 2));
  PairClaim claim;
  claim.fixed_from_moving = claim.start = Pose::planar(0, 1.0, 0);
  const PairJudgement j = judgePair(*fixed, *moving, claim);
  EXPECT_NE(j.verdict, Verdict::Good) << j.reason;
  EXPECT_GT(j.strength.forward_m, 10.0 * j.strength.right_m);
  EXPECT_NE(j.strength_sentence.find("ahead and back"), std::string::npos) << j.strength_sentence;
}

TEST(PairJudgement, NothingInCommonIsNoInformation) {
  const JudgedScanPtr room = seen(sceneScan(roomScene(), Pose(), 0.012, 1));
  for (const int points : {0, 1, 30}) {
    const JudgedScanPtr empty = seen(almostEmptyScan(points));
    const PairJudgement j = judgePair(*room, *empty, {});
    EXPECT_EQ(j.verdict, Verdict::Bad) << points;
    EXPECT_GT(j.strength.weakest_m, 1.0);
  }
  PairClaim claim;
  claim.fixed_from_moving = Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(NAN, 0, 0));
  EXPECT_THROW(judgePair(*room, *room, claim), std::invalid_argument);
  EXPECT_THROW(judgedScan(nullptr), std::invalid_argument);
}

TEST(PoseStrength, IsToldInTheMachinesFrame) {
  // In the fixed frame x is known to 1 cm, all else to 1 mm and 1e-5 rad; the machine looks along -x there.
  Matrix6d information = Matrix6d::Identity() * 1e6;
  information.topLeftCorner<3, 3>() *= 1e4;
  information(3, 3) = 1e4;
  const PoseStrength s = strengthOf(information, Pose::planar(0, 0, 90 * kDegree));
  EXPECT_NEAR(s.forward_m, 0.01, 1e-4);
  EXPECT_NEAR(s.right_m, 0.001, 1e-5);
  EXPECT_NEAR(std::abs(s.weakest.y()), 1.0, 1e-6);
  EXPECT_EQ(strengthSentence(s, 0.01, 1.0), "can slide 2 cm along ahead and back");
  // A turn about the fixed origin shifts a machine that stands far from it.
  Matrix6d turning = Matrix6d::Identity() * 1e8;
  turning(2, 2) = 1e4;
  EXPECT_NEAR(strengthOf(turning, Pose::planar(0, 20, 0)).right_m, 0.2, 1e-3);
  EXPECT_NEAR(strengthOf(turning, Pose::planar(0, 20, 0), 4.0).right_m, 0.4, 2e-3);
}

TEST(PoseStrength, WithoutInformationAllIsFree) {
  const PoseStrength s = strengthOf(Matrix6d::Zero(), Pose());
  EXPECT_NEAR(s.weakest_m, kFree_m, 1e-6);
  EXPECT_NEAR(s.weakest_rad, kFree_rad, 1e-6);
  const std::string words = strengthSentence(s, 0.03, 0.01);
  EXPECT_NE(words.find("free to slide"), std::string::npos) << words;
  EXPECT_NE(words.find("free to turn"), std::string::npos) << words;
}

TEST(PoseStrength, APullCountsAsMuchAsItIs) {
  Vector6d pull = Vector6d::Zero();
  pull[3] = 0.05;
  const PoseStrength s = strengthOf(Matrix6d::Identity() * 1e8, Pose(), 1.0, pull);
  EXPECT_NEAR(s.right_m, 0.05, 1e-5);
  EXPECT_LT(s.forward_m, 0.001);
}

TEST(PoseStrength, DirectionsAreNamedFromTheDriversSeat) {
  EXPECT_EQ(directionWords({0, 1, 0}), "ahead and back");
  EXPECT_EQ(directionWords({0, -1, 0.1}), "ahead and back");
  EXPECT_EQ(directionWords({1, 0, 0}), "sideways");
  EXPECT_EQ(directionWords({0.1, 0.1, 1}), "up and down");
  EXPECT_EQ(directionWords({-0.5, 0.866, 0}), "30° left of ahead");
  EXPECT_EQ(directionWords({0.5, -0.866, 0}), "30° left of ahead");
  EXPECT_EQ(directionWords({0.5, 0.866, 0}), "30° right of ahead");
}

TEST(SeenSpace, TellsFreeSpaceFromSurfacesAndWhatTheyHide) {
  const SeenSpace seen(sceneScan({{{0, 1, 0}, 10.0}}, Pose()));
  EXPECT_EQ(seen.placeOf({0, 5, 0}, 0.2), SeenPlace::Through);
  EXPECT_EQ(seen.placeOf({0, 10, 0}, 0.2), SeenPlace::Near);
  EXPECT_EQ(seen.placeOf({0, 9.9, 0}, 0.2), SeenPlace::Near);
  EXPECT_EQ(seen.placeOf({0, 15, 0}, 0.2), SeenPlace::Behind);
  EXPECT_EQ(seen.placeOf({0, -5, 0}, 0.2), SeenPlace::Unknown);
  EXPECT_EQ(seen.placeOf({0, NAN, 0}, 0.2), SeenPlace::Unknown);
  EXPECT_EQ(SeenSpace(almostEmptyScan(0)).placeOf({0, 5, 0}, 0.2), SeenPlace::Unknown);
}

TEST(SeenSpace, TheEdgeOfAThingIsNotFreeSpace) {
  // A wall 10 m away whose right half another hides, 4 m away.
  Scan scan = sceneScan({{{0, 1, 0}, 10.0}}, Pose());
  RangeImageData data = scan.image->data();
  for (int row = 0; row < data.rows; ++row)
    for (int column = 0; column < 180; ++column)
      data.range_m[scan.image->index(row, column)] =
          std::min(4.0F, data.range_m[scan.image->index(row, column)]);
  scan.image = RangeImage::make(std::move(data)).value();
  const SeenSpace seen(scan);
  EXPECT_NE(seen.placeOf({-0.02, 5.0, 0}, 0.2), SeenPlace::Through);
  EXPECT_EQ(seen.placeOf({-1.0, 5.0, 0}, 0.2), SeenPlace::Through);
  EXPECT_EQ(seen.placeOf({1.0, 5.0, 0}, 0.2), SeenPlace::Behind);
}

}  // namespace
}  // namespace tiltmap
