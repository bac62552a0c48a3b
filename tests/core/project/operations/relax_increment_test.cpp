// Scans that come after a relaxation are put onto those that it holds.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/operations/relax_start.h"
#include "core/project/project.h"
#include "core/world/experiment.h"
#include "tests/support/program.h"

namespace tiltmap {
namespace {

constexpr std::size_t kFirst = 20, kAll = 22;

class RelaxIncrementTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    stops_ = simulateExperiment(ExperimentId::Survey, 1, static_cast<int>(kAll), 2).value();
  }
  void SetUp() override {
    project_ = std::move(*Project::create((folder_ / "p.tiltmap").string()));
    add(0, kFirst);
    ASSERT_TRUE(run("register", {}));
    ASSERT_TRUE(run("relax", {}));
  }

  void add(std::size_t from, std::size_t to) {
    std::vector<Scan> scans;
    for (std::size_t i = from; i < to; ++i) scans.push_back(stops_[i].scan);
    const auto change = project_->apply(importEdit(std::move(scans)));
    ASSERT_TRUE(change) << change.error().what;
  }
  Result<OperationResult> run(const std::string& id, const ParameterValues& values) {
    auto job = Job::start(*operations().find(id), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    auto result = (*job)->result();
    if (result)
      if (auto change = (*job)->accept(*project_); !change) return fail(change.error());
    return result;
  }
  nlohmann::json relaxed(const ParameterValues& values = {}) {
    const auto result = run("relax", values);
    EXPECT_TRUE(result) << result.error().what;
    return result ? nlohmann::json::parse(result->report_json) : nlohmann::json();
  }
  std::vector<Pose> poses() const {
    std::vector<Pose> list;
    for (const auto& pose : project_->snapshot()->poses(Stage::Relaxed)) list.push_back(pose.value());
    return list;
  }
  std::size_t linksFound() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        project_->snapshot()->links(), [](const Link& link) { return link.stop_reason == "relaxed"; }));
  }
  // Whether a relaxation now would be about the added scans alone.
  bool continues(const RelaxSettings& settings = {}, const std::vector<int>& pins = {}) const {
    return !addedSinceRelaxation(*project_->snapshot(), settings, pins).empty();
  }

  inline static std::vector<SimulatedStop> stops_;
  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(RelaxIncrementTest, NewScansComeToStandWhereARelaxationOfAllPutsThem) {
  const std::vector<Pose> before = poses();
  const std::size_t links_before = linksFound();
  add(kFirst, kAll);
  const nlohmann::json report = relaxed();
  EXPECT_EQ(report["added"], nlohmann::json({20, 21}));
  EXPECT_EQ(report["registered_first"], true);
  EXPECT_LT(report["prepared"].get<std::size_t>(), kAll - 4);
  const std::vector<Pose> put_on = poses();
  ASSERT_EQ(put_on.size(), kAll);
  EXPECT_GT(linksFound(), links_before);
  EXPECT_TRUE(project_->snapshot()->poses(Stage::Pairwise).back());
  // Far from the new ones nothing moves at all.
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(before[i], put_on[i]) << i;

  EXPECT_EQ(relaxed({{"extent", std::string("all")}})["added"], nlohmann::json::array());
  const std::vector<Pose> anew = poses();
  for (std::size_t i = 0; i < kAll; ++i) {
    const PoseDifference off = difference(anew[i], put_on[i]);
    EXPECT_LT(off.translation_m, 0.004) << i;
    EXPECT_LT(off.rotation_rad, 0.02 * kDegree) << i;
  }
  for (std::size_t i = kFirst; i < kAll; ++i) {
    const PoseDifference off = difference(stops_[i].truth, put_on[i]);
    const PoseDifference off_anew = difference(stops_[i].truth, anew[i]);
    EXPECT_LT(off.translation_m, off_anew.translation_m + 0.004) << i;
  }
}

TEST_F(RelaxIncrementTest, OneAfterTheOtherIsAsGood) {
  for (std::size_t i = kFirst; i < kAll; ++i) {
    add(i, i + 1);
    EXPECT_EQ(relaxed()["added"], nlohmann::json({i}));
  }
  const std::vector<Pose> put_on = poses();
  relaxed({{"extent", std::string("all")}});
  const std::vector<Pose> anew = poses();
  for (std::size_t i = 0; i < kAll; ++i) EXPECT_LT(difference(anew[i], put_on[i]).translation_m, 0.004) << i;
}

TEST_F(RelaxIncrementTest, SameBitsForAnyNumberOfThreads) {
  add(kFirst, kAll);
  relaxed({{"threads", 1LL}});
  const std::vector<Pose> one = poses();
  ASSERT_TRUE(project_->undo());
  relaxed({{"threads", 3LL}});
  EXPECT_EQ(one, poses());
}

TEST_F(RelaxIncrementTest, ALinkToANewScanLeavesTheRelaxedPosesOneBetweenOthersDoesNot) {
  add(kFirst, kAll);
  ASSERT_TRUE(run("register", {{"pairs", std::string("19:20,20:21")}}));
  EXPECT_TRUE(project_->snapshot()->hasStage(Stage::Relaxed));
  EXPECT_TRUE(continues());
  EXPECT_EQ(relaxed()["registered_first"], false);
  EXPECT_EQ(poses().size(), kAll);
  ASSERT_TRUE(run("register", {{"pairs", std::string("3:4")}}));
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Relaxed));
  EXPECT_EQ(relaxed()["added"], nlohmann::json::array());
}

TEST_F(RelaxIncrementTest, WhatElseChangedIsRelaxedAnew) {
  EXPECT_FALSE(continues());
  add(kFirst, kAll);
  ASSERT_TRUE(continues());
  const SnapshotPtr snapshot = project_->snapshot();
  ASSERT_TRUE(project_->apply(renameEdit(snapshot->scans()[3].id, "the gate")));
  EXPECT_TRUE(continues());

  RelaxSettings other;
  other.threads = 7;
  EXPECT_TRUE(continues(other));
  EXPECT_FALSE(continues(other, {21}));
  other.relaxation.max_links_per_scan = 12;
  EXPECT_FALSE(continues(other));
  other = {};
  other.extent = RelaxExtent::All;
  EXPECT_FALSE(continues(other));

  ASSERT_TRUE(project_->apply(linkStateEdit(snapshot->links()[5].id, LinkState::Disabled)));
  EXPECT_FALSE(continues());
  ASSERT_TRUE(project_->undo());
  EXPECT_TRUE(continues());
  ASSERT_TRUE(project_->apply(pinsEdit(*snapshot, {snapshot->scans()[4].id})));
  EXPECT_FALSE(continues());
  EXPECT_EQ(relaxed()["added"], nlohmann::json::array());
}

TEST_F(RelaxIncrementTest, AScanThatFitsNothingStaysWhereItsOdometryPutsIt) {
  Scan far = stops_[kFirst].scan;
  RangeImageData empty;
  empty.rows = far.image->rows();
  empty.columns = far.image->columns();
  empty.range_m.assign(empty.cells(), 0.0F);
  empty.code.assign(empty.cells(), cell_code::kLmsNoSignal);
  empty.line_tilt_rad.assign(static_cast<std::size_t>(empty.rows), 0.0);
  far.image = RangeImage::make(std::move(empty)).value();
  const std::vector<Pose> before = poses();
  ASSERT_TRUE(project_->apply(importEdit({far})));
  const nlohmann::json report = relaxed();
  EXPECT_EQ(report["unlinked"], nlohmann::json({20}));
  const std::vector<Pose> after = poses();
  for (std::size_t i = 0; i < kFirst; ++i)
    EXPECT_LT(difference(before[i], after[i]).translation_m, 1e-9) << i;
  const Pose step = stops_[kFirst - 1].scan.odometry.inverse() * far.odometry;
  EXPECT_LT(difference(after[kFirst], after[kFirst - 1] * step).translation_m, 1e-9);
}

}  // namespace
}  // namespace tiltmap
