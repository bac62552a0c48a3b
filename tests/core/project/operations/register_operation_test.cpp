#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "core/world/experiment.h"
#include "tests/support/program.h"

namespace tiltmap {
namespace {

class RegisterOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = Project::create((folder_ / "p.tiltmap").string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
    ASSERT_TRUE(run("simulate", {{"experiment", std::string("exp1")}, {"stops", 3LL}}));
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

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(RegisterOperationTest, ChainsLinksIntoPairwisePosesNearTheTruth) {
  const auto result = run("register", {});
  ASSERT_TRUE(result) << result.error().what;
  const SnapshotPtr snapshot = project_->snapshot();
  ASSERT_EQ(snapshot->links().size(), 2U);
  EXPECT_EQ(snapshot->latestStage(), Stage::Pairwise);
  EXPECT_LT(difference(pose(Stage::Pairwise, 0), Pose()).translation_m, 1e-12);
  const Pose chained_pose = snapshot->links()[0].fixed_from_moving * snapshot->links()[1].fixed_from_moving;
  EXPECT_LT(difference(pose(Stage::Pairwise, 2), chained_pose).translation_m, 1e-9);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_LT(difference(pose(Stage::Pairwise, i), pose(Stage::Truth, i)).translation_m, 0.03);
    EXPECT_GT(difference(pose(Stage::Odometry, i), pose(Stage::Truth, i)).translation_m, 0.1);
  }
  // The job is on record, with every parameter and the program's version.
  ASSERT_EQ(snapshot->jobs().size(), 2U);
  const JobRecord& record = snapshot->jobs().back();
  EXPECT_EQ(record.operation, "register");
  EXPECT_EQ(record.values.size(), operations().find("register")->parameters().size());
  EXPECT_FALSE(record.program_version.empty());
}

TEST_F(RegisterOperationTest, APairThatFailsKeepsItsOdometryAndWarns) {
  // With every normal refused no pair is left.
  const auto result = run("register", {{"max-angle", 0.0}});
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_EQ(result->warnings.size(), 2U);
  for (const Link& link : project_->snapshot()->links()) {
    EXPECT_FALSE(link.succeeded);
    EXPECT_NE(link.stop_reason, "converged");
  }
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT(difference(pose(Stage::Pairwise, i), pose(Stage::Odometry, i)).translation_m, 1e-9);
}

TEST_F(RegisterOperationTest, UndoTakesItBack) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_TRUE(project_->undo());
  EXPECT_TRUE(project_->snapshot()->links().empty());
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Pairwise));
  ASSERT_TRUE(project_->redo());
  EXPECT_EQ(project_->snapshot()->links().size(), 2U);
}

TEST_F(RegisterOperationTest, PairsOutsideTheChainAddLinksOnly) {
  ASSERT_TRUE(run("register", {}));
  const Pose before = pose(Stage::Pairwise, 2);
  ASSERT_TRUE(run("register", {{"pairs", std::string("0:2")}}));
  EXPECT_EQ(project_->snapshot()->links().size(), 3U);
  EXPECT_LT(difference(pose(Stage::Pairwise, 2), before).translation_m, 1e-12);
}

TEST_F(RegisterOperationTest, SameBitsForAnyThreadCount) {
  ASSERT_TRUE(run("register", {{"threads", 1LL}}));
  const Pose one = pose(Stage::Pairwise, 2);
  ASSERT_TRUE(run("register", {{"threads", 4LL}}));
  const Pose four = pose(Stage::Pairwise, 2);
  EXPECT_EQ(one.translation(), four.translation());
  EXPECT_EQ(one.quaternion().coeffs(), four.quaternion().coeffs());
}

TEST_F(RegisterOperationTest, SimulatingIntoAFullProjectIsRefused) {
  EXPECT_FALSE(run("simulate", {}));
  EXPECT_EQ(project_->snapshot()->scans().size(), 3U);
}

TEST_F(RegisterOperationTest, CancelledJobChangesNothing) {
  auto job = Job::start(*operations().find("register"), project_->snapshot(), "thesis", {});
  ASSERT_TRUE(job);
  (*job)->cancel();
  (*job)->wait();
  ASSERT_FALSE((*job)->result());
  EXPECT_EQ((*job)->result().error().what, kCancelled);
  EXPECT_TRUE(project_->snapshot()->links().empty());
}

}  // namespace
}  // namespace tiltmap
