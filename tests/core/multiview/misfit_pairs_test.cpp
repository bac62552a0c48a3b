// Pairs of a loop that do not fit yet: which are registered by themselves, and how what was found pulls.
#include "core/multiview/misfit_pairs.h"

#include <gtest/gtest.h>

#include "tests/core/multiview/relaxation_drives.h"

namespace tiltmap {
namespace {

JointLink link(int fixed, int moving, bool used) {
  JointLink made;
  made.fixed = fixed;
  made.moving = moving;
  made.used = used;
  return made;
}

// Scans 0 to 5 in a row, its ends and a pair nearby without a link.
std::vector<JointLink> row() {
  std::vector<JointLink> links;
  for (int i = 1; i < 6; ++i) links.push_back(link(i - 1, i, true));
  links.push_back(link(0, 5, false));
  links.push_back(link(1, 3, false));
  return links;
}

MisfitAttempt found(const JointLink& of, const Pose& pose) {
  MisfitAttempt attempt;
  attempt.count = 1;
  attempt.succeeded = true;
  attempt.start = of.fixed_from_moving;
  attempt.found = of;
  attempt.found.fixed_from_moving = pose;
  attempt.found.h = 1e4 * Matrix6d::Identity();
  return attempt;
}

TEST(MisfitPairs, TheEndsOfALoopAreDueAndNearOnesAreNot) {
  const std::vector<JointLink> links = row();
  const auto due = MisfitPairs().due(links);
  ASSERT_EQ(due.size(), 1U);
  EXPECT_EQ(due.front()->fixed, 0);
  EXPECT_EQ(due.front()->moving, 5);
}

TEST(MisfitPairs, WhatWasFoundIsNotTriedAgainAndAVainAttemptOnlyFromElsewhere) {
  std::vector<JointLink> links = row();
  MisfitPairs pairs;
  auto due = pairs.due(links);
  pairs.keep(due, {found(*due.front(), Pose())});
  EXPECT_TRUE(pairs.due(links).empty());

  MisfitPairs vain;
  MisfitAttempt failed;
  failed.count = 1;
  vain.keep(due, {failed});
  EXPECT_TRUE(vain.due(links).empty());
  links[5].fixed_from_moving = Pose::planar(0.2, 0.0, 0.0);
  EXPECT_EQ(vain.due(links).size(), 1U);
  failed.count = 3;
  vain.keep(vain.due(links), {failed});
  EXPECT_TRUE(vain.due(links).empty()) << "three times are enough";
}

TEST(MisfitPairs, WhatWasFoundPullsThereTheLessTheFurtherOff) {
  const std::vector<JointLink> links = row();
  std::vector<Pose> poses(6);
  const auto pull = [&](double off_m) {
    MisfitPairs pairs;
    const auto due = pairs.due(links);
    pairs.keep(due, {found(*due.front(), Pose::planar(off_m, 0.0, 0.0))});
    std::vector<PairTerm> terms;
    pairs.addTerms(links, poses, 0.5, terms);
    EXPECT_EQ(terms.size(), 1U);
    return terms.empty() ? PairTerm() : terms.front();
  };
  const PairTerm near = pull(0.1), far = pull(2.0);
  // The minimum of the term lies at the pose found: the step -b / h leads there.
  EXPECT_NEAR(-near.b[3] / near.h(3, 3), 0.1, 1e-9);
  EXPECT_LT(far.h(3, 3), 0.01 * near.h(3, 3));
}

TEST(MisfitPairs, NothingPullsWhereALinkFitsByNow) {
  std::vector<JointLink> links = row();
  MisfitPairs pairs;
  const auto due = pairs.due(links);
  pairs.keep(due, {found(*due.front(), Pose::planar(0.1, 0.0, 0.0))});
  links[5].used = true;
  std::vector<PairTerm> terms;
  pairs.addTerms(links, std::vector<Pose>(6), 0.5, terms);
  EXPECT_TRUE(terms.empty());
}

// Between two stops of a drive, told that they are far apart in links.
TEST(MisfitPairs, RegistersFromAMisfitAndVerifiesTheWayMoved) {
  const auto& drive = relaxation_test::drive(ExperimentId::Exp1, 1);
  const RegistrationSettings settings = jointRegistrationSettings();
  Samples samples;
  for (const PreparedScanPtr& scan : drive.prepared) {
    samples.emplace_back();
    for (std::uint32_t k = 0; k < scan->elements.size(); ++k) samples.back().push_back(k);
  }
  const Pose truth = drive.truth[0].inverse() * drive.truth[1];
  std::vector<JointLink> links = {link(0, 1, false)};
  links[0].fixed_from_moving = Pose::planar(0.15, -0.1, 0.01) * truth;
  const std::vector<const JointLink*> due = {&links[0]};
  const MisfitPairs::Scene scene{drive.prepared, samples, settings, LossScale(0.02), 2};
  // The scans are one link apart, which may have added up to 5 cm only.
  const auto refused = MisfitPairs().registered(due, links, scene, {});
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_FALSE(refused.front().succeeded);
  EXPECT_LT(difference(refused.front().found.fixed_from_moving, truth).translation_m, 0.01);
  links[0].fixed_from_moving = Pose::planar(0.02, -0.02, 0.001) * truth;
  const auto taken = MisfitPairs().registered(due, links, scene, {});
  EXPECT_TRUE(taken.front().succeeded);
  EXPECT_LT(difference(taken.front().found.fixed_from_moving, truth).translation_m, 0.01);
}

}  // namespace
}  // namespace tiltmap
