// Links against each other: who contradicts whom.
#include "core/project/link_agreement.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/project/link_what_if.h"
#include "core/project/operations/relax_operation.h"
#include "core/project/project.h"
#include "core/registration/pair_judgement.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::must;

// A grid of stops 10 m apart, neighbours and diagonals linked as truly as their information says.
class LinkAgreementTest : public ::testing::Test {
 protected:
  static constexpr double kDeviation_m = 0.005, kDeviation_rad = 0.05 * kDegree;

  void make(int across, int along) {
    across_ = across;
    auto scans = test::sampleScans(across * along);
    for (int i = 0; i < across * along; ++i)
      scans[static_cast<std::size_t>(i)].odometry =
          Pose::planar(10.0 * (i % across), 10.0 * (i / across), 0.7 * i);
    project_ = must(Project::create(folder_ / ("p" + std::to_string(++made_) + ".tiltmap")));
    must(project_->apply(importEdit(std::move(scans))));
    truth_ = now().filledPoses(Stage::Odometry);
    links_.clear();
  }
  void join(int a, int b) { links_.push_back(link(a, b)); }
  // With noise as large as the information says.
  Link link(int a, int b) {
    const auto f = static_cast<std::size_t>(a), m = static_cast<std::size_t>(b);
    Link made = test::sampleLink(now().scans()[f].id, now().scans()[m].id);
    const Pose true_pose = truth_[f].inverse() * truth_[m];
    const auto part = [&](double scale) {
      return Eigen::Vector3d(random_.normal() * scale, random_.normal() * scale, random_.normal() * scale);
    };
    // In the moving scan's frame, as PoseStrength has it.
    made.fixed_from_moving = true_pose * Pose(rotationExp(part(kDeviation_rad)), part(kDeviation_m));
    auto judged = std::make_shared<PairJudgement>();
    judged->verdict = Verdict::Good;
    judged->reason = "as made";
    judged->badness = 0.3;
    Vector6d variance;
    variance << Eigen::Vector3d::Constant(kDeviation_rad * kDeviation_rad),
        Eigen::Vector3d::Constant(kDeviation_m * kDeviation_m);
    judged->strength = strengthOfCovariance(variance.asDiagonal());
    judged->start = true_pose;
    const Matrix6d to_rig = rigFromFixed(made.fixed_from_moving);
    const Matrix6d information = to_rig.transpose() * variance.cwiseInverse().asDiagonal() * to_rig;
    made.information = 0.5 * (information + information.transpose());
    made.judgement = std::move(judged);
    return made;
  }
  void grid() {
    const int count = static_cast<int>(truth_.size());
    for (int i = 0; i < count; ++i) {
      if (i % across_ + 1 < across_) join(i, i + 1);
      if (i + across_ < count) join(i, i + across_);
      if (i % across_ + 1 < across_ && i + across_ < count) join(i, i + across_ + 1);
    }
  }
  std::vector<LinkAgreement> agreements(const JudgementSettings& settings = exact()) {
    must(project_->apply(ProjectEdit{"links", {AddLinks{links_, true}}, nullptr, {}, {}}));
    return linkAgreements(now(), settings);
  }
  static JudgementSettings exact() {
    JudgementSettings settings;
    settings.others_floor_m = settings.others_floor_rad = 0.0;
    return settings;
  }
  const ProjectSnapshot& now() { return *project_->snapshot(); }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  std::vector<Pose> truth_;
  std::vector<Link> links_;
  RandomStream random_{17};
  int across_ = 0, made_ = 0;
};

TEST_F(LinkAgreementTest, LeavingOneOutIsWhatSolvingWithoutItSays) {
  make(3, 2);
  grid();
  const auto told = agreements();
  ASSERT_EQ(told.size(), links_.size());
  for (const LinkAgreement& one : told) {
    ASSERT_TRUE(one.supported);
    // Solved once more without it, in full.
    const LinkWhatIf without = must(whatIfWithout(now(), {one.link}));
    for (const LinkVerdict& verdict : without.links) {
      if (verdict.link != one.link) continue;
      EXPECT_NEAR(one.off.translation_m, verdict.after.translation_m,
                  0.01 * verdict.after.translation_m + 1e-5);
    }
  }
}

TEST_F(LinkAgreementTest, DeviationsAreAboutOneWhereUncertaintyIsHonest) {
  double sum = 0.0;
  std::size_t count = 0;
  for (int round = 0; round < 6; ++round) {
    make(4, 4);
    grid();
    for (const LinkAgreement& one : agreements()) {
      ASSERT_TRUE(one.supported);
      EXPECT_LT(one.deviations, 2.5) << "nobody is accused";
      sum += one.deviations * one.deviations;
      ++count;
    }
  }
  // Each square has 6 degrees of freedom; those of one grid hang together, so the bounds are wide.
  EXPECT_NEAR(sum / static_cast<double>(count), 1.0, 0.15) << count;
}

TEST_F(LinkAgreementTest, AWrongLinkIsNamedAndTheGoodOnesAreNot) {
  make(4, 3);
  grid();
  const std::size_t wrong = 7;
  links_[wrong].fixed_from_moving = links_[wrong].fixed_from_moving * Pose::planar(0.12, -0.05, 0.01);
  const auto told = agreements();
  EXPECT_GT(told[wrong].deviations, 5.0);
  EXPECT_NEAR(told[wrong].off.translation_m, 0.13, 0.04);
  EXPECT_TRUE(told[wrong].own);
  for (std::size_t k = 0; k < told.size(); ++k)
    EXPECT_TRUE(k == wrong || told[k].deviations < 2.5) << "link " << k << ": " << told[k].deviations;
}

TEST_F(LinkAgreementTest, TwoWrongLinksDoNotHideEachOther) {
  make(4, 3);
  grid();
  for (const std::size_t wrong : {std::size_t{4}, std::size_t{12}})
    links_[wrong].fixed_from_moving = links_[wrong].fixed_from_moving * Pose::planar(0.5, 0.3, 0.1);
  const auto told = agreements();
  for (std::size_t k = 0; k < told.size(); ++k) {
    const bool wrong = k == 4 || k == 12;
    EXPECT_EQ(told[k].deviations > 5.0, wrong) << "link " << k << ": " << told[k].deviations;
  }
}

TEST_F(LinkAgreementTest, InALoopAloneNobodyKnowsWhichOneIsWrong) {
  make(3, 1);
  join(0, 1), join(1, 2), join(0, 2);
  links_[1].fixed_from_moving = links_[1].fixed_from_moving * Pose::planar(0.3, 0.0, 0.0);
  const auto told = agreements();
  for (const LinkAgreement& one : told) {
    EXPECT_TRUE(one.supported);
    EXPECT_GT(one.deviations, 5.0);
    EXPECT_FALSE(one.own);
    EXPECT_EQ(one.loop, 3);
    EXPECT_NEAR(one.misclosure.translation_m, 0.3, 0.05);
  }
}

TEST_F(LinkAgreementTest, AChainHasNobodyToAsk) {
  make(4, 1);
  for (int i = 0; i < 3; ++i) join(i, i + 1);
  for (const LinkAgreement& one : agreements()) {
    EXPECT_FALSE(one.supported);
    EXPECT_EQ(one.deviations, 0.0);
    EXPECT_EQ(one.loop, 0);
  }
}

TEST_F(LinkAgreementTest, DisabledBadAndRelaxedLinksAreAskedAboutButNotAsked) {
  make(3, 1);
  join(0, 1), join(1, 2), join(0, 2);
  links_[2].fixed_from_moving = links_[2].fixed_from_moving * Pose::planar(0.3, 0.0, 0.0);
  const auto check = [&](const std::vector<LinkAgreement>& told) {
    EXPECT_FALSE(told[0].supported);
    EXPECT_FALSE(told[1].supported);
    ASSERT_TRUE(told[2].supported);
    EXPECT_NEAR(told[2].off.translation_m, 0.3, 0.03);
    EXPECT_GT(told[2].deviations, 5.0);
    EXPECT_EQ(told[2].loop, 3);
  };
  links_[2].state = LinkState::Disabled;
  check(agreements());
  make(3, 1);
  join(0, 1), join(1, 2), join(0, 2);
  links_[2].fixed_from_moving = links_[2].fixed_from_moving * Pose::planar(0.3, 0.0, 0.0);
  links_[2].stop_reason = kFoundByRelaxation;
  check(agreements());
  auto bad = std::make_shared<PairJudgement>(*links_[2].judgement);
  bad->verdict = Verdict::Bad;
  make(3, 1);
  join(0, 1), join(1, 2), join(0, 2);
  links_[2].fixed_from_moving = links_[2].fixed_from_moving * Pose::planar(0.3, 0.0, 0.0);
  links_[2].judgement = bad;
  check(agreements());
}

TEST_F(LinkAgreementTest, TwoSurveysInOneProjectDoNotSpeakForEachOther) {
  make(6, 1);
  join(0, 1), join(1, 2), join(0, 2), join(3, 4), join(4, 5);
  const auto told = agreements();
  EXPECT_TRUE(told[0].supported && told[1].supported && told[2].supported);
  EXPECT_FALSE(told[3].supported || told[4].supported);
  EXPECT_LT(told[0].deviations, 2.5);
}

TEST_F(LinkAgreementTest, FailedOnesAndNoneAtAll) {
  make(2, 1);
  EXPECT_TRUE(linkAgreements(now()).empty());
  join(0, 1);
  links_[0].succeeded = false;
  links_[0].judgement = nullptr;
  EXPECT_TRUE(agreements().empty());
}

}  // namespace
}  // namespace tiltmap
