// What later stops of a survey take over from earlier ones: calibration, range bounds, the machine's body.
#include "hardware/capture/known_rig.h"

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/project.h"
#include "hardware/capture/capture_operation.h"
#include "hardware/capture/capture_station.h"
#include "hardware/capture/station_capture.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

constexpr int kLines = 6;

class KnownRigTest : public ::testing::Test {
 protected:
  KnownRigTest() { project_ = std::move(*Project::create(folder_ / "p.tiltmap")); }
  ~KnownRigTest() override { station_.reset(); }

  // The next stop of an emulated drive, as the window takes it.
  Result<OperationResult> capture(ParameterValues more = {}, int seed = 7) {
    if (!station_) station_ = std::make_shared<CaptureStation>();
    if (seed != seed_) {
      CaptureSettings source;
      source.emulate = CaptureDrive::Exp1;
      source.seed = seed_ = seed;
      source.speed = 0.0;
      station_->connect(source);
      const auto end = std::chrono::steady_clock::now() + 60s;
      while (station_->snapshot().state != StationState::Ready && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(1ms);
    }
    const auto operation = makeStationCapture(station_);
    if (!more.contains("lines")) more["lines"] = static_cast<long long>(kLines);
    auto job = Job::start(*operation, project_->snapshot(), "default", more);
    if (!job) return fail(job.error());
    while (!(*job)->waitFor(5ms)) (*job)->serve(*project_);
    (*job)->serve(*project_);
    return (*job)->result();
  }
  const ScanEntry& scan(std::size_t index) {
    snapshot_ = project_->snapshot();
    return snapshot_->scans().at(index);
  }
  std::size_t masked(std::size_t index) {
    const RangeImagePtr image = *scan(index).image();
    return static_cast<std::size_t>(std::ranges::count(image->data().code, cell_code::kMasked));
  }
  static CellMask bumper(int rows = kLines) { return {rows, 361, {{0, 170, 189}, {1, 170, 189}}}; }
  void giveToFirst(const ScannerGeometry& geometry) {
    ProjectEdit edit;
    edit.title = "what was found";
    edit.steps.emplace_back(SetBodyMask{scan(0).id, bumper()});
    edit.steps.emplace_back(SetGeometry{scan(0).id, geometry});
    ASSERT_TRUE(project_->apply(edit));
  }
  ScannerGeometry calibrated() {
    ScannerGeometry geometry = scan(0).geometry;
    geometry.tilt_zero_rad = 0.5 * kDegree;
    geometry.lever_arm_m = {0.0, 0.05, 0.02};
    geometry.range_offset_m = 0.03;
    geometry.minimum_range_m = 0.7;
    return geometry;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  std::shared_ptr<CaptureStation> station_;
  SnapshotPtr snapshot_;
  int seed_ = -1;
};

TEST_F(KnownRigTest, TheNextStopsHaveWhatWasFoundForTheFirst) {
  const auto first = capture();
  ASSERT_TRUE(first) << first.error().what;
  EXPECT_EQ(first->report_json.find("known_rig"), std::string::npos) << "nothing is known yet";
  EXPECT_EQ(masked(0), 0U);
  giveToFirst(calibrated());
  for (std::size_t stop = 1; stop <= 2; ++stop) {
    const auto next = capture();
    ASSERT_TRUE(next) << next.error().what;
    EXPECT_EQ(masked(stop), 40U);
    const ScannerGeometry& geometry = scan(stop).geometry;
    EXPECT_EQ(geometry.tilt_zero_rad, 0.5 * kDegree);
    EXPECT_EQ(geometry.lever_arm_m, Eigen::Vector3d(0.0, 0.05, 0.02));
    EXPECT_EQ(geometry.range_offset_m, 0.03);
    EXPECT_EQ(geometry.minimum_range_m, 0.7);
    EXPECT_EQ(geometry.tilt_start_rad, scan(0).geometry.tilt_start_rad);
    EXPECT_EQ(scan(stop).geometry_id, scan(0).geometry_id) << "one row for all of them";
    EXPECT_NE(next->report_json.find("40 cells"), std::string::npos) << next->report_json;
  }
  // One edit: undoing the stop takes all of it back.
  EXPECT_EQ(project_->snapshot()->history().size(), 4U);
  EXPECT_TRUE(project_->verify());
}

TEST_F(KnownRigTest, IsLeftAwayWhereItIsSwitchedOff) {
  ASSERT_TRUE(capture());
  giveToFirst(calibrated());
  const auto next = capture({{"known-rig", false}});
  ASSERT_TRUE(next);
  EXPECT_EQ(masked(1), 0U);
  EXPECT_EQ(scan(1).geometry.tilt_zero_rad, 0.0);
  EXPECT_EQ(next->report_json.find("known_rig"), std::string::npos);
  ASSERT_TRUE(capture());
  EXPECT_EQ(masked(2), 40U) << "stop 1 in between says nothing";
}

TEST_F(KnownRigTest, AnotherSweepOrOtherInstrumentsAreAnotherRig) {
  ASSERT_TRUE(capture());
  giveToFirst(calibrated());
  ASSERT_TRUE(capture({{"lines", 5LL}}));
  EXPECT_EQ(masked(1), 0U);
  EXPECT_EQ(scan(1).geometry.tilt_zero_rad, 0.0);
  ASSERT_TRUE(capture({{"start", -29.0}}));
  EXPECT_EQ(masked(2), 0U) << "other cells see the machine there";
  const SnapshotPtr snapshot = project_->snapshot();
  const ScannerGeometry sweep = snapshot->scans()[0].geometry;
  const auto known = knownRig(*snapshot, sweep, "emulated exp1 seed 7");
  ASSERT_TRUE(known);
  ASSERT_TRUE(known->body);
  EXPECT_EQ(*known->body, bumper());
  EXPECT_NE(knownRigText(*known).find("stop 0"), std::string::npos) << knownRigText(*known);
  EXPECT_TRUE(knownRig(*snapshot, sweep, "emulated exp1 seed 8")->empty());
  EXPECT_EQ(knownRigText(KnownRig()), "");
}

TEST_F(KnownRigTest, WhereAnInstrumentIsPluggedInDoesNotMatter) {
  AddScan add;
  add.scan.geometry.rows = kLines;
  add.scan.name = "stop 0";
  add.scan.source = "LMS291;S05 at /dev/ttyUSB0, MIP 50 at /dev/ttyUSB1";
  ProjectEdit edit;
  edit.title = "add";
  add.scan.geometry.tilt_zero_rad = 0.01;
  edit.steps.emplace_back(add);
  ASSERT_TRUE(project_->apply(edit));
  ScannerGeometry sweep;
  sweep.rows = kLines;
  const auto of = [&](const char* instruments) {
    return knownRig(*project_->snapshot(), sweep, instruments)->calibration.has_value();
  };
  EXPECT_TRUE(of("LMS291;S05 at /dev/ttyUSB3, MIP 50 at /dev/ttyUSB0"));
  EXPECT_FALSE(of("LMS291;S14 at /dev/ttyUSB0, MIP 50 at /dev/ttyUSB1"));
  EXPECT_FALSE(of("LMS291;S05 at /dev/ttyUSB0, EPOS (v2) at /dev/ttyUSB1"));
}

// A stop that is not whole has masked no cell that was not scanned: it is no model for the next.
TEST_F(KnownRigTest, AnUnfinishedStopIsNoModel) {
  ASSERT_TRUE(capture());
  giveToFirst(calibrated());
  AddScan add;
  add.scan.geometry = scan(0).geometry;
  add.scan.name = "cut short";
  add.scan.source = scan(0).source;
  ProjectEdit edit;
  edit.title = "add";
  edit.steps.emplace_back(add);
  edit.steps.emplace_back(SetBodyMask{addedScan(0), CellMask{kLines, 361, {{0, 0, 3}}}});
  ASSERT_TRUE(project_->apply(edit));
  const auto known = knownRig(*project_->snapshot(), scan(0).geometry, scan(0).source);
  ASSERT_TRUE(known && known->body);
  EXPECT_EQ(*known->body, bumper());
}

}  // namespace
}  // namespace tiltmap
