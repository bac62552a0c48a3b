#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/link_what_if.h"
#include "core/project/operation.h"
#include "tests/support/program.h"
#include "tests/support/project_samples.h"

namespace tiltmap {
namespace {

class LinkOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = test::must(Project::create((folder_ / "p.tiltmap").string()));
    ASSERT_TRUE(run("simulate", {{"experiment", std::string("exp1")}, {"stops", 4LL}}));
    ASSERT_TRUE(run("register", {}));
  }
  Status run(const std::string& id, const ParameterValues& values) {
    auto job = Job::start(*operations().find(id), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    if (!(*job)->result()) return fail((*job)->result().error());
    return (*job)->accept(*project_).map([](const Change&) {});
  }
  const ProjectSnapshot& now() { return *project_->snapshot(); }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(LinkOperationTest, RegistersFromWhereTheScansStandAndMovesNoPose) {
  const auto before = now().filledPoses(Stage::Pairwise);
  ASSERT_TRUE(run("link", {{"fixed", 0LL}, {"moving", 2LL}}));
  const Link& link = now().links().back();
  EXPECT_EQ(link.fixed, now().scans()[0].id);
  EXPECT_EQ(link.moving, now().scans()[2].id);
  EXPECT_EQ(link.origin, LinkOrigin::Automatic);
  EXPECT_TRUE(link.usable());
  EXPECT_GT(link.overlap, 0.1);
  const auto truth = now().filledPoses(Stage::Truth);
  EXPECT_LT(difference(link.fixed_from_moving, truth[0].inverse() * truth[2]).translation_m, 0.03);
  EXPECT_EQ(now().filledPoses(Stage::Pairwise), before);
  const auto count = now().links().size();
  ASSERT_TRUE(run("link", {{"fixed", 0LL}, {"moving", 2LL}}));
  EXPECT_EQ(now().links().size(), count) << "the new one takes the old one's place";
  test::must(project_->undo());
  test::must(project_->undo());
  EXPECT_EQ(now().links().size(), count - 1);
}

TEST_F(LinkOperationTest, AsPlacedIsTheLinkOfAPerson) {
  const auto poses = now().filledPoses(Stage::Pairwise);
  ASSERT_TRUE(run("link", {{"fixed", 1LL}, {"moving", 3LL}, {"method", std::string("as-placed")}}));
  const Link& link = now().links().back();
  EXPECT_EQ(link.origin, LinkOrigin::ByHand);
  EXPECT_LT(difference(link.fixed_from_moving, poses[1].inverse() * poses[3]).translation_m, 1e-12);
  EXPECT_GT(link.correspondences, 0);
  EXPECT_GT(link.rms_m, 0.0);
}

TEST_F(LinkOperationTest, RefusesWhatIsNoPair) {
  EXPECT_FALSE(run("link", {{"fixed", 1LL}, {"moving", 1LL}}));
  EXPECT_FALSE(run("link", {{"fixed", 0LL}, {"moving", 9LL}}));
  const Status status = run("link", {{"fixed", 0LL}, {"moving", 2LL}, {"start", std::string("relaxed")}});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("relaxed"), std::string::npos);
}

TEST_F(LinkOperationTest, TheOthersSayWhichLinkIsWrong) {
  ASSERT_TRUE(run("link", {{"fixed", 0LL}, {"moving", 2LL}}));
  ASSERT_TRUE(run("link", {{"fixed", 1LL}, {"moving", 3LL}}));
  // As good as any other: the others agree, and without it nothing moves far.
  const LinkId good = now().links().back().id;
  const LinkWhatIf harmless = test::must(whatIfWithout(now(), {good}));
  EXPECT_LT(harmless.links.back().after.translation_m, 0.05);
  EXPECT_TRUE(harmless.links.back().left_out);
  EXPECT_TRUE(harmless.links.back().supported);
  EXPECT_NE(whatIfText(now(), harmless).find("agrees"), std::string::npos) << whatIfText(now(), harmless);

  Link wrong = now().links().back();
  wrong.fixed_from_moving = Pose::planar(0.6, -0.3, 0.05) * wrong.fixed_from_moving;
  ProjectEdit edit;
  edit.title = "a wrong link";
  edit.steps.emplace_back(AddLinks{{wrong}, true});
  test::must(project_->apply(edit));
  const LinkId id = now().links().back().id;
  const LinkWhatIf telling = test::must(whatIfWithout(now(), {id}));
  const LinkVerdict& verdict = telling.links.back();
  EXPECT_GT(verdict.after.translation_m, 0.3) << "the others put the scan where it was";
  EXPECT_GT(telling.rms_before_m, 10.0 * telling.rms_after_m);
  EXPECT_GT(telling.moved[3].translation_m, 0.05);
  EXPECT_EQ(telling.moved[0].translation_m, 0.0);
  EXPECT_NE(whatIfText(now(), telling).find("contradicts"), std::string::npos) << whatIfText(now(), telling);
}

TEST_F(LinkOperationTest, ALinkThatNothingElseSupportsIsNamedSo) {
  const LinkWhatIf cut = test::must(whatIfWithout(now(), {now().links()[1].id}));
  EXPECT_EQ(cut.separated, (std::vector<int>{2, 3}));
  EXPECT_FALSE(cut.links[1].supported);
  EXPECT_TRUE(cut.links[0].supported);
  EXPECT_NE(whatIfText(now(), cut).find("nothing speaks for or against"), std::string::npos);
  EXPECT_FALSE(whatIfWithout(now(), {12345}));
}

}  // namespace
}  // namespace tiltmap
