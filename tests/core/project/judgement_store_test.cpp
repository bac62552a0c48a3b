// What judging a pair gave, kept with its link for as long as it holds.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/judgement_json.h"
#include "core/project/link_judgement.h"
#include "core/project/project.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::must;

PairJudgement someJudgement(const Pose& pose) {
  PairJudgement j;
  j.verdict = Verdict::Doubtful;
  j.reason = "only 8 % of the surfaces are common to both scans";
  j.badness = 1.4;
  j.overlap_fixed = 0.08, j.overlap_moving = 0.07;
  j.fit = 0.83, j.through = 0.012, j.seen = 412;
  j.residual_m = 0.0043, j.expected_m = 0.0039, j.excess_m = 0.0021;
  j.pull_m = 0.0011, j.pull_rad = 0.0002;
  Matrix6d covariance = 1e-6 * Matrix6d::Identity();
  covariance(1, 4) = covariance(4, 1) = 2e-7;
  j.strength = strengthOfCovariance(covariance);
  j.strength_sentence = "is held in all directions";
  j.start = pose * Pose::planar(0.3, -0.2, 0.02);
  j.moved = difference(j.start, pose);
  return j;
}

void expectSame(const PairJudgement& a, const PairJudgement& b) {
  EXPECT_TRUE(sameJudgement(&a, &b));
  EXPECT_EQ(judgementJson(a), judgementJson(b));
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.strength.weakest_m, b.strength.weakest_m);
  EXPECT_EQ(a.strength_sentence, b.strength_sentence);
}

TEST(JudgementJson, ComesBackAsItWas) {
  const JudgedOf of{{1, 2, 101}, {3, 2, 101}, test::samplePose(4)};
  const PairJudgement judged = someJudgement(of.fixed_from_moving);
  const auto back = restoredJudgement(storedJudgement(judged, of), of);
  ASSERT_TRUE(back);
  expectSame(*back, judged);
}

TEST(JudgementJson, OfSomethingElseItDoesNotStand) {
  const JudgedOf of{{1, 2, 101}, {3, 2, 101}, test::samplePose(4)};
  const std::string stored = storedJudgement(someJudgement(of.fixed_from_moving), of);
  JudgedOf other = of;
  other.fixed.matrix = 9;
  EXPECT_FALSE(restoredJudgement(stored, other));
  other = of, other.moving.geometry = 9;
  EXPECT_FALSE(restoredJudgement(stored, other));
  other = of, other.moving.lines = 100;
  EXPECT_FALSE(restoredJudgement(stored, other));
  other = of, other.fixed_from_moving = test::samplePose(5);
  EXPECT_FALSE(restoredJudgement(stored, other));
}

TEST(JudgementJson, WhatIsNoJudgementIsNone) {
  const JudgedOf of{{1, 2, 101}, {3, 2, 101}, test::samplePose(4)};
  for (const char* text : {"", "null", "{}", "[1, 2]", "no json"})
    EXPECT_FALSE(restoredJudgement(text, of)) << text;
  nlohmann::json stored = nlohmann::json::parse(storedJudgement(someJudgement(of.fixed_from_moving), of));
  stored["verdict"] = "splendid";
  EXPECT_FALSE(restoredJudgement(stored.dump(), of));
  PairJudgement judged = someJudgement(of.fixed_from_moving);
  judged.residual_m = std::nan("");
  EXPECT_THROW((void)storedJudgement(judged, of), std::invalid_argument);
}

class JudgementStore : public ::testing::Test {
 protected:
  JudgementStore() {
    project_ = must(Project::create(folder_ / "p.tiltmap"));
    must(project_->apply(importEdit(test::sampleScans(3))));
    Link judged = test::sampleLink(id(0), id(1), 1), plain = test::sampleLink(id(1), id(2), 2);
    judged.judgement = std::make_shared<const PairJudgement>(someJudgement(judged.fixed_from_moving));
    must(project_->apply(ProjectEdit{"links", {AddLinks{{judged, plain}, true}}, nullptr, {}, {}}));
    made_ = someJudgement(judged.fixed_from_moving);
  }
  const ProjectSnapshot& now() { return *project_->snapshot(); }
  ScanId id(std::size_t i) { return now().scans()[i].id; }
  const Link& link(std::size_t k) { return now().links()[k]; }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  PairJudgement made_;
};

TEST_F(JudgementStore, IsThereAfterOpeningAgain) {
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(link(0).judgement);
    expectSame(*link(0).judgement, made_);
    EXPECT_FALSE(link(1).judgement);
    project_.reset();
    project_ = must(Project::open(folder_ / "p.tiltmap", Access::ReadWrite));
  }
}

TEST_F(JudgementStore, IsSetChangedAndUndone) {
  PairJudgement other = someJudgement(link(1).fixed_from_moving);
  other.verdict = Verdict::Good;
  const Change change =
      must(project_->apply(storeJudgementsEdit(project_->snapshot(), {{link(1).id, other}})));
  EXPECT_EQ(change.links_changed, std::vector<LinkId>{link(1).id});
  ASSERT_TRUE(link(1).judgement);
  expectSame(*link(1).judgement, other);
  expectSame(*link(0).judgement, made_);
  must(project_->undo());
  EXPECT_FALSE(link(1).judgement);
  must(project_->redo());
  expectSame(*link(1).judgement, other);
  EXPECT_FALSE(project_->apply(storeJudgementsEdit(project_->snapshot(), {{4711, other}})));
}

TEST_F(JudgementStore, FallsWithTheGeometryItWasMadeWith) {
  ScannerGeometry turned = now().scans()[1].geometry;
  turned.tilt_zero_rad += 0.002;
  must(project_->apply(ProjectEdit{"geometry", {SetGeometry{id(1), turned}}, nullptr, {}, {}}));
  EXPECT_FALSE(link(0).judgement) << "its scan looks different now";
  must(project_->undo());
  ASSERT_TRUE(link(0).judgement);
  expectSame(*link(0).judgement, made_);
}

TEST_F(JudgementStore, AJudgementThatIsNotFiniteIsRefusedWhole) {
  PairJudgement broken = made_;
  broken.pull_m = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(project_->apply(storeJudgementsEdit(project_->snapshot(), {{link(0).id, broken}})));
  expectSame(*link(0).judgement, made_);
}

}  // namespace
}  // namespace tiltmap
