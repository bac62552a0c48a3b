// The thesis' second experiment as printed, with two wrong rows of odometry.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/products/evaluation.h"
#include "core/products/survey_report.h"
#include "core/project/job.h"
#include "core/project/odometry_check.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

class OverruledOdometryTest : public ::testing::Test {
 protected:
  OperationResult run(const std::string& id, const ParameterValues& values = {}) {
    auto job = must(Job::start(*operations().find(id), project_->snapshot(), "default", values));
    job->wait();
    OperationResult result = must(job->result());
    must(job->accept(*project_));
    return result;
  }
  TemporaryFolder folder_;
  std::unique_ptr<Project> project_ = must(Project::create((folder_ / "p.tiltmap").string()));
};

TEST_F(OverruledOdometryTest, TheTablesWrongRowsAreOverruledAndNamed) {
  run("simulate", {{"experiment", std::string("exp2")}});
  const OperationResult registered = run("register");
  run("relax");
  const SnapshotPtr snapshot = project_->snapshot();
  const auto evaluation =
      must(evaluateTrajectory(snapshot->filledPoses(Stage::Relaxed), snapshot->filledPoses(Stage::Truth)));
  EXPECT_LE(evaluation.rmse_translation_m, 0.004);
  EXPECT_LE(evaluation.rmse_rotation_deg, 0.02);

  for (const Stage stage : {Stage::Pairwise, Stage::Relaxed}) {
    const auto rows = overruledRows(*snapshot, stage);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].scan, 1U);
    EXPECT_NEAR(rows[0].off_m, 1.5, 0.3);
    EXPECT_EQ(rows[1].scan, 13U);
    EXPECT_NEAR(rows[1].off_rad / kDegree, 80.0, 15.0);
  }
  const auto report = nlohmann::json::parse(registered.report_json);
  ASSERT_EQ(report["overruled_odometry"].size(), 2U);
  EXPECT_EQ(report["overruled_odometry"][0]["scan"], 1);
  EXPECT_EQ(report["overruled_odometry"][1]["scan"], 13);
  std::string warnings;
  for (const std::string& warning : reportOf(*snapshot, "exp2").warnings) warnings += warning + "\n";
  EXPECT_NE(warnings.find("odometry of scan 1 was overruled"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("odometry of scan 13 was overruled"), std::string::npos) << warnings;
}

TEST_F(OverruledOdometryTest, AnOdometryThatHoldsIsNot) {
  run("simulate", {{"experiment", std::string("exp2fixed")}, {"stops", 4LL}});
  EXPECT_TRUE(nlohmann::json::parse(run("register").report_json)["overruled_odometry"].empty());
  EXPECT_TRUE(overruledRows(*project_->snapshot(), Stage::Pairwise).empty());
}

}  // namespace
}  // namespace tiltmap
