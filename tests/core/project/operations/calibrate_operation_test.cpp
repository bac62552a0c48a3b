// Calibrating from a project's scans, and keeping the machine's body out of them.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/calibration/scanner_errors.h"
#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "tests/support/body_scans.h"
#include "tests/support/program.h"
#include "tests/support/range_images.h"

namespace tiltmap {
namespace {

class CalibrateOperationTest : public ::testing::Test {
 protected:
  void SetUp() override { open("p.tiltmap"); }
  void open(const std::string& name) {
    auto made = Project::create((folder_ / name).string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
  }
  void simulate(const std::string& plant, long long stops) {
    const auto made = run(
        "simulate", {{"experiment", std::string("loop")}, {"seed", 3LL}, {"stops", stops}, {"plant", plant}});
    ASSERT_TRUE(made) << made.error().what;
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
  const ScanEntry& scan(std::size_t i) {
    snapshot_ = project_->snapshot();
    return snapshot_->scans()[i];
  }
  double offset(std::size_t i) { return scan(i).geometry.range_offset_m; }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  SnapshotPtr snapshot_;
};

TEST_F(CalibrateOperationTest, FindsKeepsAppliesAndTakesBack) {
  simulate("range-offset=0.03,lever-arm-z=0.05", 7);
  EXPECT_EQ(offset(0), 0.0) << "scans know nothing of what was planted";
  const auto early = run("calibrate", {});
  ASSERT_FALSE(early);
  EXPECT_NE(early.error().remedy.find("register"), std::string::npos);
  ASSERT_TRUE(run("register", {}));
  const std::int64_t before = project_->snapshot()->revision();

  const std::string file = (folder_ / "c.json").string();
  const auto looked = run("calibrate", {{"tilt-zero", false}, {"mounting", false}, {"out", file}});
  ASSERT_TRUE(looked) << looked.error().what;
  EXPECT_TRUE(looked->edit.empty());
  EXPECT_EQ(project_->snapshot()->revision(), before);
  const auto report = nlohmann::json::parse(looked->report_json);
  EXPECT_FALSE(report["applied"].get<bool>());
  EXPECT_EQ(report["estimates"].size(), 8U);
  EXPECT_NEAR(report["geometry"]["range_offset_m"].get<double>(), 0.03, 0.004);
  EXPECT_NEAR(report["geometry"]["lever_arm_m"][2].get<double>(), 0.05, 0.007);
  EXPECT_TRUE(std::ifstream(file).good());

  const auto applied = run("calibrate", {{"tilt-zero", false}, {"mounting", false}, {"apply", true}});
  ASSERT_TRUE(applied) << applied.error().what;
  EXPECT_FALSE(applied->warnings.empty()) << "links are older";
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(offset(i), 0.03, 0.004) << i;
  EXPECT_EQ(project_->snapshot()->latestStage(), Stage::Relaxed);
  const auto& jobs = project_->snapshot()->jobs();
  const auto record = std::ranges::find(jobs, "calibration", &JobRecord::operation);
  ASSERT_NE(record, jobs.end());
  EXPECT_NEAR(std::get<double>(record->values.at("range offset m")), 0.03, 0.004);
  EXPECT_GT(std::get<double>(record->values.at("range offset sigma m")), 0.0);
  EXPECT_NE(std::get<std::string>(record->values.at("scans")).find("stop 6"), std::string::npos);
  // Its points come out where they are: the poses are those of the truth again.
  for (std::size_t i = 0; i < 7; ++i) {
    const PoseDifference off = difference(*scan(i).pose(Stage::Relaxed), *scan(i).pose(Stage::Truth));
    EXPECT_LT(off.translation_m, 0.04) << i;
  }
  ASSERT_TRUE(project_->undo());
  EXPECT_EQ(offset(3), 0.0);
  EXPECT_EQ(project_->snapshot()->latestStage(), Stage::Pairwise);

  // The file, for another survey of the same scanner.
  open("other.tiltmap");
  simulate("range-offset=0.03,lever-arm-z=0.05", 2);
  EXPECT_FALSE(run("calibrate", {{"from", file}})) << "without apply";
  EXPECT_FALSE(run("calibrate", {{"from", file + "x"}, {"apply", true}}));
  const auto taken = run("calibrate", {{"from", file}, {"apply", true}, {"scans", std::string("1")}});
  ASSERT_TRUE(taken) << taken.error().what;
  EXPECT_EQ(offset(0), 0.0);
  EXPECT_NEAR(offset(1), 0.03, 0.004);
}

TEST_F(CalibrateOperationTest, RefusesWhatMakesNoSense) {
  EXPECT_FALSE(run("calibrate", {})) << "no scans";
  EXPECT_FALSE(run("simulate", {{"plant", std::string("tilt-zero=90")}}));
  simulate("", 2);
  EXPECT_FALSE(run("calibrate", {})) << "two scans";
  EXPECT_FALSE(run("calibrate", {{"scans", std::string("7")}}));
}

TEST_F(CalibrateOperationTest, TheMinimumRangeKeepsTheBodyOutAndIsTakenBack) {
  using namespace testing_support;
  EXPECT_FALSE(run("body-mask", {})) << "no scans";
  ASSERT_TRUE(project_->apply(importEdit(scansWithBody(3))));
  const std::string file = (folder_ / "mask.json").string();
  const auto looked = run("body-mask", {{"out", file}});
  ASSERT_TRUE(looked) << looked.error().what;
  EXPECT_EQ(nlohmann::json::parse(looked->report_json)["cells"], kBodyCells);
  EXPECT_TRUE(std::ifstream(file).good());
  EXPECT_EQ((*scan(1).image())->validCells(), 120U);
  ASSERT_TRUE(run("body-mask", {{"apply", true}}));
  EXPECT_NEAR(scan(1).geometry.minimum_range_m, 0.45, 1e-6);
  EXPECT_EQ((*scan(1).image())->validCells(), 120U - kBodyAndMargin) << "with one cell of margin";
  EXPECT_EQ((*scan(1).image())->code(0, 5), cell_code::kMasked);
  EXPECT_TRUE(project_->verify());
  const auto again = run("body-mask", {{"apply", true}});
  ASSERT_TRUE(again);
  EXPECT_FALSE(again->warnings.empty()) << "there is no body left";
  ASSERT_TRUE(project_->undo());
  EXPECT_EQ((*scan(1).image())->validCells(), 120U) << "stored ranges stayed";
}

}  // namespace
}  // namespace tiltmap
