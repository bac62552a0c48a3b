// A pair stepped through and accepted stores what the command stores.
#include "core/project/operations/pair_links.h"

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "core/registration/registration_trace.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

class PairLinksTest : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = test::must(Project::create((folder_ / "p.tiltmap").string()));
    run("simulate", {{"experiment", std::string("exp1")}, {"stops", 3LL}});
  }
  void run(const std::string& id, const ParameterValues& values) {
    auto job = test::must(Job::start(*operations().find(id), project_->snapshot(), "default", values));
    job->wait();
    test::must(job->accept(*project_));
  }
  SteppedPair stepped(std::size_t fixed, std::size_t moving, const Pose& start) {
    const SnapshotPtr snapshot = project_->snapshot();
    SteppedPair pair;
    pair.fixed = snapshot->scans()[fixed].id;
    pair.moving = snapshot->scans()[moving].id;
    pair.start = start;
    pair.values = test::must(operations().find("register")->presetValues("default"));
    pair.started = utcNow();
    ParameterValues own = pair.values;
    own.erase("pairs");
    own.erase("threads");
    RegistrationSettings settings;
    test::must(registrationParameters().apply(own, settings));
    auto trace =
        test::must(RegistrationTrace::begin(test::must(snapshot->scans()[fixed].scan()),
                                            test::must(snapshot->scans()[moving].scan()), start, settings));
    while (!trace.done()) trace.step();
    pair.result = trace.result();
    return pair;
  }
  Pose odometry(std::size_t fixed, std::size_t moving) {
    const auto& scans = project_->snapshot()->scans();
    return odometryStart(scans[fixed], scans[moving]);
  }
  // Links, poses and jobs, without what a clock says.
  std::string state() {
    const SnapshotPtr snapshot = project_->snapshot();
    std::string out;
    for (const Link& link : snapshot->links()) {
      out += std::to_string(link.fixed) + "-" + std::to_string(link.moving) + " " +
             test::text(link.fixed_from_moving) + test::text(link.rms_m) + test::text(link.overlap) +
             std::to_string(link.iterations) + " " + std::to_string(link.correspondences) + link.stop_reason +
             linkOriginName(link.origin) + "\n";
      for (int i = 0; link.information && i < 36; ++i) out += test::text(link.information->data()[i]);
    }
    for (const ScanEntry& scan : snapshot->scans())
      for (const auto& [stage, pose] : scan.poses) out += stageName(stage) + test::text(pose) + "\n";
    for (const JobRecord& job : snapshot->jobs())
      out += job.operation + job.preset + parametersToJson(job.values) + jobStateName(job.state) + "\n";
    return out;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(PairLinksTest, AcceptingStoresWhatTheCommandStores) {
  run("register", {{"pairs", std::string("0:1")}});
  const std::string by_command = state();
  test::must(project_->undo());
  test::must(project_->apply(steppedPairEdit(project_->snapshot(), stepped(0, 1, odometry(0, 1)))));
  EXPECT_EQ(state(), by_command);
  EXPECT_EQ(project_->snapshot()->history().back().title, "accept scan 1 on scan 0");
  test::must(project_->undo());
  EXPECT_TRUE(project_->snapshot()->links().empty());
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Pairwise));
  test::must(project_->redo());
  EXPECT_EQ(state(), by_command);
}

TEST_F(PairLinksTest, AStartByHandMakesALinkByHandInPlaceOfOthers) {
  run("register", {});
  ASSERT_EQ(project_->snapshot()->links().size(), 2U);
  const Pose start = odometry(1, 2) * Pose::planar(0.1, 0.0, 0.02);
  SteppedPair pair = stepped(1, 2, start);
  pair.start_by_hand = true;
  ASSERT_TRUE(pair.result.succeeded());
  test::must(project_->apply(steppedPairEdit(project_->snapshot(), pair)));
  const SnapshotPtr snapshot = project_->snapshot();
  ASSERT_EQ(snapshot->links().size(), 2U);
  EXPECT_EQ(snapshot->links().back().origin, LinkOrigin::ByHand);
  EXPECT_EQ(snapshot->links().back().moving, snapshot->scans()[2].id);
  ASSERT_EQ(snapshot->jobs().back().warnings.size(), 1U);
  EXPECT_NE(snapshot->jobs().back().warnings[0].find("by hand"), std::string::npos);
  // Registering again leaves it alone.
  const Link by_hand = snapshot->links().back();
  run("register", {});
  bool still_there = false;
  for (const Link& link : project_->snapshot()->links()) still_there |= link.id == by_hand.id;
  EXPECT_TRUE(still_there);
}

TEST_F(PairLinksTest, WhatFailedOrIsGoneIsRefused) {
  SteppedPair pair = stepped(0, 1, odometry(0, 1));
  pair.result.stop_reason = StopReason::NoOverlap;
  EXPECT_THROW(steppedPairEdit(project_->snapshot(), pair), std::invalid_argument);
  pair.result.stop_reason = StopReason::Converged;
  pair.moving = 4711;
  EXPECT_THROW(steppedPairEdit(project_->snapshot(), pair), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
