// `capture --mode continuous` from the operation to the map, beside the same stops taken line by line.
#include <iostream>
#include <map>

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/registration/register_pair.h"
#include "core/scan/beam_tilts.h"
#include "hardware/capture/capture_operation.h"
#include "tests/support/map_distance.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

class ContinuousCaptureTest : public ::testing::Test {
 protected:
  Status capture(const std::string& name, const std::string& mode, int stops, int lines = 101,
                 bool resume = false) {
    const std::filesystem::path path = folder_ / (name + ".tiltmap");
    if (!resume) projects_[name] = std::move(*Project::create(path));
    Project& project = *projects_[name];
    ParameterValues values{{"emulate", std::string("exp1")},
                           {"speed", 0.0},
                           {"stops", static_cast<long long>(stops)},
                           {"lines", static_cast<long long>(lines)},
                           {"seed", 5LL},
                           {"baud", 500000LL},
                           {"mode", mode}};
    if (resume) values = {{"resume", true}, {"speed", 0.0}};
    const auto operation = makeCaptureOperation();
    auto job = Job::start(*operation, project.snapshot(), "default", values);
    if (!job) return fail(job.error());
    while (!(*job)->waitFor(std::chrono::milliseconds(20))) (*job)->serve(project);
    (*job)->serve(project);
    auto outcome = (*job)->result();
    return outcome ? Status{} : fail(outcome.error());
  }
  static Scan scanOf(const ScanEntry& entry, bool corrected = true) {
    Scan scan;
    scan.image = *entry.image();
    scan.geometry = entry.geometry;
    if (!corrected) scan.image = *withoutBeamTilts(*scan.image, scan.geometry);
    return scan;
  }
  // Of neighbouring stops, from their odometry, against the truth.
  double meanError_m(const std::string& name, bool corrected = true) {
    const SnapshotPtr snapshot = projects_[name]->snapshot();
    double sum = 0.0;
    const auto& scans = snapshot->scans();
    for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
      const Pose truth = scans[i].poses.at(Stage::Truth).inverse() * scans[i + 1].poses.at(Stage::Truth);
      const Pose start = scans[i].odometry().inverse() * scans[i + 1].odometry();
      const auto pair = registerPair(scanOf(scans[i], corrected), scanOf(scans[i + 1], corrected), start, {});
      EXPECT_TRUE(pair);
      if (pair) sum += (pair->fixed_from_moving.translation() - truth.translation()).norm();
    }
    return sum / static_cast<double>(scans.size() - 1);
  }

  test::TemporaryFolder folder_;
  std::map<std::string, std::unique_ptr<Project>> projects_;
};

// The tilt turns at 13.8 deg/s, the fastest that the motor can: 0.18 deg between beams side by side.
TEST_F(ContinuousCaptureTest, TheMapIsAsGoodAsLineByLineAndWrongWithoutTheCorrection) {
  ASSERT_TRUE(capture("stop", "stop", 2));
  const Status done = capture("continuous", "continuous", 2);
  ASSERT_TRUE(done) << done.error().what << ": " << done.error().where;
  // Where neighbouring stops are found to be.
  EXPECT_LT(meanError_m("continuous"), meanError_m("stop") + 0.004);
  // Where the points of a stop lie, beside those of the same stop taken line by line and of a second such
  // scan.
  const auto& still = projects_["stop"]->snapshot()->scans()[0];
  const auto& moved = projects_["continuous"]->snapshot()->scans()[0];
  const test::MapDistance noise = test::mapDistance(scanOf(still), scanOf(still));
  const test::MapDistance right = test::mapDistance(scanOf(still), scanOf(moved));
  const test::MapDistance wrong = test::mapDistance(scanOf(still), scanOf(moved, false));
  std::cout << "points off the surfaces, half and nine tenths of them: line by line " << 1e3 * noise.median_m
            << " and " << 1e3 * noise.ninety_m << " mm, continuous " << 1e3 * right.median_m << " and "
            << 1e3 * right.ninety_m << ", with the correction switched off " << 1e3 * wrong.median_m
            << " and " << 1e3 * wrong.ninety_m << "\n";
  EXPECT_GT(right.points, 5000);
  EXPECT_LT(right.median_m, 1.3 * noise.median_m);
  EXPECT_LT(right.ninety_m, 1.3 * noise.ninety_m);
  EXPECT_GT(wrong.ninety_m, 1.5 * right.ninety_m);
}

TEST_F(ContinuousCaptureTest, WhatIsStoredIsThereAfterReopening) {
  ASSERT_TRUE(capture("a", "continuous", 1, 12));
  const RangeImagePtr before = *projects_["a"]->snapshot()->scans()[0].image();
  ASSERT_TRUE(tiltMoved(*before));
  EXPECT_EQ(before->scannedLines(), 12);
  EXPECT_GT(lineTurnTilt(*before, 3), 0.001);
  const std::filesystem::path path = projects_["a"]->path();
  projects_.clear();
  auto again = Project::open(path, Access::ReadOnly);
  ASSERT_TRUE(again);
  const RangeImagePtr after = *(*again)->snapshot()->scans()[0].image();
  EXPECT_EQ(after->data().line_tilt_rad, before->data().line_tilt_rad);
  // As a whole matrix into another project.
  const ScanEntry& entry = (*again)->snapshot()->scans()[0];
  auto other = std::move(*Project::create(folder_ / "b.tiltmap"));
  AddScan add;
  add.scan.geometry = entry.geometry;
  add.scan.image = after;
  ProjectEdit edit;
  edit.title = "add";
  edit.steps.emplace_back(std::move(add));
  ASSERT_TRUE(other->apply(edit));
  EXPECT_EQ((*other->snapshot()->scans()[0].image())->data().line_tilt_rad, before->data().line_tilt_rad);
}

TEST_F(ContinuousCaptureTest, IsGoneOnWithInTheSameMode) {
  ASSERT_TRUE(capture("a", "continuous", 2, 8));
  const auto& jobs = projects_["a"]->snapshot()->jobs();
  ASSERT_FALSE(jobs.empty());
  EXPECT_EQ(std::get<std::string>(jobs.back().values.at("mode")), "continuous");
}

TEST_F(ContinuousCaptureTest, ATiltSetByHandCannot) {
  projects_["a"] = std::move(*Project::create(folder_ / "a.tiltmap"));
  const auto operation = makeCaptureOperation(
      [](const std::string&, const std::stop_token&) -> Result<std::string> { return std::string(); });
  const ParameterValues values{{"scanner", std::string("lms2xx:/dev/nothing")},
                               {"tilt", std::string("manual:")},
                               {"mode", std::string("continuous")}};
  const Status refused = operation->check(*projects_["a"]->snapshot(), values);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().remedy.find("--mode stop"), std::string::npos);
}

}  // namespace
}  // namespace tiltmap
