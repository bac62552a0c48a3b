#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/job.h"
#include "core/project/link_judgement.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "tests/support/program.h"

namespace tiltmap {
namespace {

class RelaxOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = Project::create((folder_ / "p.tiltmap").string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
    ASSERT_TRUE(run("simulate", {{"experiment", std::string("exp1")}, {"stops", 4LL}}));
  }
  Result<OperationResult> run(const std::string& id, const ParameterValues& values,
                              const std::string& preset = "default") {
    auto job = Job::start(*operations().find(id), project_->snapshot(), preset, values);
    if (!job) return fail(job.error());
    (*job)->wait();
    auto result = (*job)->result();
    if (result)
      if (auto change = (*job)->accept(*project_); !change) return fail(change.error());
    return result;
  }
  Pose pose(Stage stage, std::size_t scan) { return *project_->snapshot()->poses(stage)[scan]; }
  double moved(std::size_t scan) {
    return difference(pose(Stage::Pairwise, scan), pose(Stage::Relaxed, scan)).translation_m;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(RelaxOperationTest, MakesTheRelaxedStageAndLinksBeyondNeighbours) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_EQ(project_->snapshot()->links().size(), 3U);
  const auto result = run("relax", {});
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_TRUE(result->warnings.empty());
  const SnapshotPtr snapshot = project_->snapshot();
  EXPECT_EQ(snapshot->latestStage(), Stage::Relaxed);
  EXPECT_EQ(moved(0), 0.0);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(moved(i), 1e-6) << i;
    EXPECT_LT(difference(pose(Stage::Relaxed, i), pose(Stage::Truth, i)).translation_m, 0.01) << i;
  }
  // 0-1, 1-2, 2-3 were there; nobody's link is there twice.
  EXPECT_GT(snapshot->links().size(), 3U);
  EXPECT_LE(snapshot->links().size(), 6U);
  for (const Link& link : snapshot->links()) {
    EXPECT_EQ(link.origin, LinkOrigin::Automatic);
    // What was found on the way is judged like what was registered: by the scans, at the link's own pose.
    ASSERT_TRUE(link.judgement) << link.fixed << " - " << link.moving;
    EXPECT_EQ(link.judgement->verdict, Verdict::Good) << link.judgement->reason;
    EXPECT_GT(link.judgement->overlap(), 0.1);
  }
  const auto judged = judgeLinkScans(*snapshot);
  ASSERT_TRUE(judged);
  for (const JudgedLink& one : *judged)
    EXPECT_EQ(one.judgement.residual_m, snapshot->findLink(one.link)->judgement->residual_m);

  const auto report = nlohmann::json::parse(result->report_json);
  EXPECT_GT(report["milliseconds"].get<double>(), 0.0);
  ASSERT_EQ(report["moved"].size(), 4U);
  EXPECT_NEAR(report["moved"][2]["translation_m"].get<double>(), moved(2), 1e-9);
  EXPECT_TRUE(report["unlinked"].empty());
  EXPECT_TRUE(report["warnings"].empty());
  EXPECT_EQ(report["method"], "joint");

  ASSERT_TRUE(project_->undo());
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Relaxed));
  EXPECT_EQ(project_->snapshot()->links().size(), 3U);
}

TEST_F(RelaxOperationTest, PinnedScansKeepTheirPairwisePoses) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_TRUE(run("relax", {{"pin", std::string("0,2")}}));
  EXPECT_EQ(moved(2), 0.0);
  EXPECT_GT(moved(1), 0.0);
  EXPECT_FALSE(run("relax", {{"pin", std::string("4")}}));
  EXPECT_FALSE(run("relax", {{"pin", std::string("x")}}));
}

TEST_F(RelaxOperationTest, WithoutPairwisePosesItRegistersFirstAsOneEdit) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_TRUE(run("relax", {}));
  std::vector<Pose> in_two;
  for (std::size_t i = 0; i < 4; ++i) in_two.push_back(pose(Stage::Relaxed, i));
  const std::size_t links = project_->snapshot()->links().size();
  ASSERT_TRUE(project_->undo());
  ASSERT_TRUE(project_->undo());
  ASSERT_FALSE(project_->snapshot()->hasStage(Stage::Pairwise));

  const auto result = run("relax", {});
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_EQ(result->warnings.size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(result->report_json)["registered_first"], true);
  EXPECT_TRUE(project_->snapshot()->hasStage(Stage::Pairwise));
  EXPECT_EQ(project_->snapshot()->links().size(), links);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(in_two[i].translation(), pose(Stage::Relaxed, i).translation());
  ASSERT_TRUE(project_->undo());
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Pairwise));
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Relaxed));
  EXPECT_TRUE(project_->snapshot()->links().empty());
}

TEST_F(RelaxOperationTest, RelaxingAgainGivesTheSameAndDoublesNoLink) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_TRUE(run("relax", {}));
  const std::size_t links = project_->snapshot()->links().size();
  const Pose once = pose(Stage::Relaxed, 3);
  ASSERT_TRUE(run("relax", {}));
  EXPECT_EQ(project_->snapshot()->links().size(), links);
  EXPECT_EQ(pose(Stage::Relaxed, 3).translation(), once.translation());
  // The thesis' method finds none, so what the other found does not stand for its poses.
  ASSERT_TRUE(run("relax", {}, "thesis"));
  EXPECT_EQ(project_->snapshot()->links().size(), 3U);
  ASSERT_TRUE(project_->undo());
  EXPECT_EQ(project_->snapshot()->links().size(), links);
}

TEST_F(RelaxOperationTest, ADisabledPairIsLeftOut) {
  ASSERT_TRUE(run("register", {}));
  const LinkId first = project_->snapshot()->links().front().id;
  ASSERT_TRUE(project_->apply(linkStateEdit(first, LinkState::Disabled)));
  const auto result = run("relax", {});
  ASSERT_TRUE(result);
  const nlohmann::json report = nlohmann::json::parse(result->report_json);
  ASSERT_FALSE(report["links"].empty());
  for (const auto& link : report["links"])
    EXPECT_FALSE(link["fixed"] == 0 && link["moving"] == 1);
}

TEST_F(RelaxOperationTest, ThePresetsAreThere) {
  ASSERT_TRUE(run("register", {}, "thesis"));
  const auto result = run("relax", {}, "thesis");
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_EQ(nlohmann::json::parse(result->report_json)["method"], "active-set");
  const auto sequential = run("relax", {}, "sequential");
  ASSERT_TRUE(sequential);
  EXPECT_EQ(nlohmann::json::parse(sequential->report_json)["method"], "sequential");
}

TEST_F(RelaxOperationTest, ThreadsDoNotChangeTheBits) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_TRUE(run("relax", {{"threads", 1LL}}));
  std::vector<Pose> one;
  for (std::size_t i = 0; i < 4; ++i) one.push_back(pose(Stage::Relaxed, i));
  ASSERT_TRUE(project_->undo());
  ASSERT_TRUE(run("relax", {{"threads", 4LL}}));
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(one[i].translation(), pose(Stage::Relaxed, i).translation()) << i;
}

}  // namespace
}  // namespace tiltmap
