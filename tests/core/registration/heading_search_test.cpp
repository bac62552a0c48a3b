#include "core/registration/heading_search.h"

#include <gtest/gtest.h>

#include "tests/support/room_scene.h"

namespace tiltmap {
namespace {

using test_support::almostEmptyScan;
using test_support::groundScene;
using test_support::roomScene;
using test_support::sceneScan;

const Pose kTruth = Pose::planar(0.6, 0.9, 0.15);

class HeadingSearchTest : public ::testing::Test {
 protected:
  SearchedPair from(const Scan& fixed, const Scan& moving, const Pose& start,
                    const RegistrationSettings& settings = {}) {
    const PreparedScanPtr a = prepare(fixed, settings), b = prepare(moving, settings);
    auto found = registerAndSearch(a, b, *judgedScan(a), *judgedScan(b), start, settings);
    EXPECT_TRUE(found);
    return found.value_or(SearchedPair{});
  }
  const Scan fixed_ = sceneScan(roomScene(), Pose(), 0.012, 1);
  const Scan moving_ = sceneScan(roomScene(), kTruth, 0.012, 2);
};

TEST_F(HeadingSearchTest, AGoodStartIsNotSearched) {
  const SearchedPair found = from(fixed_, moving_, kTruth * Pose::planar(0.1, 0.0, 0.05));
  EXPECT_FALSE(found.searched);
  EXPECT_EQ(found.judgement.verdict, Verdict::Good) << found.judgement.reason;
}

TEST_F(HeadingSearchTest, AStartThatIsTurnedAwayEndsRightOrSaysSo) {
  int right = 0;
  std::string outcomes;
  for (const double turned : {60.0, 90.0, -90.0, 135.0, 180.0}) {
    const Pose start = kTruth * Pose::planar(0.1, -0.1, turned * kDegree);
    const SearchedPair found = from(fixed_, moving_, start);
    const PoseDifference off = difference(found.result.fixed_from_moving, kTruth);
    const bool there = off.translation_m < 0.02 && off.rotation_rad < 0.1 * kDegree;
    if (there) ++right;
    outcomes += std::to_string(turned) + (found.searched ? " searched: " : ": ") +
                std::to_string(off.translation_m) + " m, " + std::to_string(off.rotation_rad / kDegree) +
                " deg, " + verdictName(found.judgement.verdict) + ", " + found.judgement.reason + "\n";
    EXPECT_TRUE(there || found.judgement.verdict != Verdict::Good) << turned;
    // That it lies so far from the odometry stays a cause for doubt.
    EXPECT_NE(found.judgement.verdict, Verdict::Good) << turned;
    if (found.searched) {
      EXPECT_GE(found.result.retries, 11) << turned;
    }
  }
  EXPECT_EQ(right, 5) << outcomes;
}

TEST_F(HeadingSearchTest, SwitchedOffItIsRegisterPair) {
  RegistrationSettings settings;
  settings.retry_agreement = 0.0;
  const Pose start = kTruth * Pose::planar(0.0, 0.0, 90.0 * kDegree);
  const SearchedPair found = from(fixed_, moving_, start, settings);
  const auto plain = registerPair(prepare(fixed_, settings), prepare(moving_, settings), start, settings);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(found.searched);
  EXPECT_EQ(found.result.fixed_from_moving, plain->fixed_from_moving);
}

TEST_F(HeadingSearchTest, ScansOfDifferentPlacesAreNotTalkedIntoAFit) {
  const SearchedPair strange = from(fixed_, sceneScan(groundScene(), Pose(), 0.012, 3), Pose());
  EXPECT_NE(strange.judgement.verdict, Verdict::Good);
  const SearchedPair empty = from(fixed_, almostEmptyScan(5), Pose());
  EXPECT_EQ(empty.judgement.verdict, Verdict::Bad);
}

TEST_F(HeadingSearchTest, StopsWhenAskedTo) {
  std::stop_source source;
  source.request_stop();
  JobControl control;
  control.stop = source.get_token();
  const PreparedScanPtr a = prepare(fixed_, {}), b = prepare(moving_, {});
  const auto found = registerAndSearch(a, b, *judgedScan(a), *judgedScan(b), kTruth, {}, control);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what, kCancelled);
}

}  // namespace
}  // namespace tiltmap
