#include "hardware/capture/capture_station.h"

#include <algorithm>
#include <atomic>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/live_project.h"
#include "hardware/capture/capture_operation.h"
#include "hardware/capture/detect_instruments.h"
#include "hardware/capture/station_capture.h"
#include "hardware/emulator/terminal_rig.h"
#include "tests/support/captured_lines.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

class CaptureStationTest : public ::testing::Test {
 protected:
  CaptureStationTest() {
    project_ = std::move(*Project::create(folder_ / "p.tiltmap"));
    make();
  }
  void make(StationSettings settings = {}) {
    station_.reset();
    seen_ = std::make_shared<Seen>();
    // In virtual time an instrument is found again before anybody has looked.
    station_ = std::make_shared<CaptureStation>(
        [seen = seen_] {
          // Told until its thread has ended, which is before it goes.
          const CaptureStation* station = seen->station;
          if (!station) return;
          const StationSnapshot snapshot = station->snapshot();
          const std::lock_guard lock(seen->mutex);
          if (seen->states.empty() || seen->states.back() != snapshot.state)
            seen->states.push_back(snapshot.state);
        },
        std::move(settings));
    seen_->station = station_.get();
  }
  bool wasSeen(StationState state) const {
    const std::lock_guard lock(seen_->mutex);
    return std::ranges::find(seen_->states, state) != seen_->states.end();
  }
  struct Seen {
    std::atomic<const CaptureStation*> station = nullptr;
    std::mutex mutex;
    std::vector<StationState> states;
  };

  // In memory where speed is 0, so that nothing depends on how busy the machine is.
  static CaptureSettings emulated(double speed = 0.0) {
    CaptureSettings source;
    source.emulate = CaptureDrive::Exp1;
    source.seed = 7;
    source.speed = speed;
    source.stops = 0;
    return source;
  }
  StationSnapshot now() const { return station_->snapshot(); }
  StationState state() const { return now().state; }
  template <class Condition>
  ::testing::AssertionResult comes(const Condition& condition, std::chrono::seconds limit = 60s) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end)
        return ::testing::AssertionFailure() << "state " << static_cast<int>(state()) << ", " << now().doing
                                             << ", " << now().error.value_or(Error{}).what;
      std::this_thread::sleep_for(1ms);
    }
    return ::testing::AssertionSuccess();
  }
  ::testing::AssertionResult comes(StationState wanted) {
    return comes([&] { return state() == wanted; });
  }
  ::testing::AssertionResult connected(double speed = 0.0) {
    station_->connect(emulated(speed));
    return comes([&] { return state() == StationState::Ready || state() == StationState::Fault; }) &&
                   state() == StationState::Ready
               ? ::testing::AssertionSuccess()
               : ::testing::AssertionFailure() << now().error.value_or(Error{}).what;
  }
  // As a window runs it: the lines are stored on this thread.
  Result<OperationResult> capture(int lines, const ParameterValues& more = {}) {
    const auto operation = makeStationCapture(station_);
    ParameterValues values = more;
    values["lines"] = static_cast<long long>(lines);
    auto job = Job::start(*operation, project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    while (!(*job)->waitFor(5ms)) (*job)->serve(*project_);
    (*job)->serve(*project_);
    return (*job)->result();
  }
  // Stored on the station's thread, so that what `line` does comes right behind a line, however busy the
  // machine is; it is given the number of lines so far.
  Result<OperationResult> captureWatched(const CaptureSettings& settings,
                                         const std::function<void(int)>& line) {
    class Watched : public OwnLiveProject {
     public:
      Watched(Project& project, const std::function<void(int)>& line)
          : OwnLiveProject(project), line_(line) {}
      std::future<Status> appendLine(ScanId scan, int row, ScanLine taken) override {
        auto done = OwnLiveProject::appendLine(scan, row, std::move(taken));
        line_(++lines_);
        return done;
      }

     private:
      const std::function<void(int)>& line_;
      int lines_ = 0;
    } live(*project_, line);
    return station_->capture(project_->snapshot(), settings, {}, live, {});
  }
  void expectTrueScan(std::size_t index, int lines) {
    test::expectTrueScan(*project_->snapshot(), index, lines);
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  std::shared_ptr<Seen> seen_;
  std::shared_ptr<CaptureStation> station_;
};

TEST_F(CaptureStationTest, ConnectsAndTellsWhoIsThere) {
  EXPECT_EQ(state(), StationState::Idle);
  ASSERT_TRUE(connected());
  const StationSnapshot there = now();
  EXPECT_NE(there.scanner.name.find("LMS291"), std::string::npos);
  EXPECT_NE(there.tilt.name.find("MIP 50"), std::string::npos) << there.tilt.name;
  const auto fact = [&](const StationInstrument& instrument, const std::string& name) {
    for (const InstrumentFact& known : instrument.facts)
      if (known.name == name) return known.value;
    return std::string("?");
  };
  EXPECT_NE(fact(there.scanner, "type").find("LMS291"), std::string::npos);
  EXPECT_EQ(fact(there.scanner, "rate"), "38400 Bd");
  EXPECT_NE(fact(there.scanner, "window").find("clean"), std::string::npos);
  EXPECT_EQ(fact(there.scanner, "condition"), "no defect reported");
  EXPECT_EQ(fact(there.tilt, "rate"), "19200 Bd");
  ASSERT_TRUE(comes([&] { return now().line != nullptr; }));
  EXPECT_EQ(now().line->range_m.size(), 361U);
  EXPECT_EQ(now().line->code.size(), 361U);
  EXPECT_EQ(now().line->row, -1);
  EXPECT_NEAR(now().azimuth_step_rad, 0.5 * kDegree, 1e-9);
  ASSERT_TRUE(comes([&] { return now().tilt_rad.has_value(); }));
  station_->disconnect();
  ASSERT_TRUE(comes(StationState::Idle));
  EXPECT_TRUE(now().scanner.name.empty());
}

TEST_F(CaptureStationTest, LiveLinesAreToldOnlyWhileTheyAreWanted) {
  ASSERT_TRUE(connected());
  station_->setLive(false);
  const std::size_t before = now().lines_seen;
  const StationLinePtr line = now().line;
  ASSERT_TRUE(comes([&] { return now().lines_seen > before + 2; })) << "they are taken off the wire";
  EXPECT_EQ(now().line, line);
  station_->setLive(true);
  EXPECT_TRUE(comes([&] { return now().line != line; }));
}

TEST_F(CaptureStationTest, MovesTheTiltParksAndSearchesHome) {
  ASSERT_TRUE(connected());
  const auto stands = [&](double angle) {
    return comes([&] {
      return state() == StationState::Ready && now().tilt_rad && std::abs(*now().tilt_rad - angle) < 0.0004;
    });
  };
  station_->jogTo(0.3);
  EXPECT_TRUE(stands(0.3));
  station_->jogBy(-0.1);
  EXPECT_TRUE(stands(0.2));
  station_->jogTo(9.0);
  ASSERT_TRUE(comes([&] { return now().error.has_value(); }));
  EXPECT_NE(now().error->what.find("limits"), std::string::npos) << now().error->what;
  EXPECT_EQ(state(), StationState::Ready);
  EXPECT_TRUE(stands(0.2)) << "and it has not moved";
  station_->park();
  EXPECT_TRUE(stands(0.0));
  EXPECT_FALSE(now().error) << "what was refused before is over";
  station_->jogTo(0.25);
  EXPECT_TRUE(stands(0.25));
  station_->home();
  ASSERT_TRUE(comes([&] {
    return state() == StationState::Ready && now().tilt_rad && std::abs(*now().tilt_rad - 0.25) > 0.01;
  })) << "home is elsewhere";
}

TEST_F(CaptureStationTest, WhatNeedsInstrumentsIsRefusedWithoutThem) {
  for (const auto& command :
       std::vector<std::function<void()>>{[&] { station_->jogBy(0.1); }, [&] { station_->jogTo(0.1); },
                                          [&] { station_->home(); }, [&] { station_->park(); }}) {
    station_->disconnect();
    ASSERT_TRUE(comes([&] { return !now().error; }));
    command();
    ASSERT_TRUE(comes([&] { return now().error.has_value(); }));
    EXPECT_NE(now().error->remedy, "");
    EXPECT_EQ(state(), StationState::Idle);
  }
  EXPECT_FALSE(station_->fault("silent"));
  const auto refused = capture(3);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("connected"), std::string::npos);
  EXPECT_TRUE(project_->snapshot()->scans().empty());
}

TEST_F(CaptureStationTest, TwoStopsInARowAreTrueAndTheirRowsAreTold) {
  ASSERT_TRUE(connected());
  for (std::size_t stop = 0; stop < 2; ++stop) {
    // Into the sky as well.
    const auto outcome = capture(12, {{"start", 18.0}});
    ASSERT_TRUE(outcome) << outcome.error().what;
    expectTrueScan(stop, 12);
    EXPECT_EQ(state(), StationState::Verdict);
    const StationSweep sweep = now().sweep;
    EXPECT_EQ(sweep.number, static_cast<int>(stop) + 1);
    EXPECT_EQ(sweep.scan, project_->snapshot()->scans()[stop].id);
    EXPECT_TRUE(sweep.complete);
    EXPECT_EQ(sweep.rows_taken, 12);
    EXPECT_EQ(sweep.cells, 12U * 361U);
    EXPECT_LT(sweep.worst_tilt_error_rad, 0.0004);
    ASSERT_TRUE(sweep.tilt_error_rad);
    const auto image = project_->snapshot()->scans()[stop].image();
    ASSERT_TRUE(image);
    std::size_t dead = 0;
    const auto rows = station_->takeRows();
    ASSERT_EQ(rows.size(), 12U) << "of this sweep alone";
    for (const StationLinePtr& row : rows) {
      const auto first = static_cast<std::ptrdiff_t>((*image)->index(row->row, 0));
      EXPECT_TRUE(std::equal(row->range_m.begin(), row->range_m.end(),
                             (*image)->data().range_m.begin() + first,
                             [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }) ||
                  row->code.front() != cell_code::kMeasured)
          << row->row;
      for (const CellCode code : row->code) dead += !cell_code::hasPoint(code);
    }
    EXPECT_EQ(sweep.dead_cells, dead);
    EXPECT_GT(dead, 0U);
  }
  EXPECT_EQ(project_->snapshot()->scans()[1].odometry(),
            (*experimentPoses(ExperimentId::Exp1, 7, 0))[1].odometry);
}

TEST_F(CaptureStationTest, AContinuousSweepHasNoTiltErrorToShow) {
  ASSERT_TRUE(connected());
  const auto outcome = capture(12, {{"mode", std::string("continuous")}});
  ASSERT_TRUE(outcome) << outcome.error().what;
  EXPECT_FALSE(now().sweep.tilt_error_rad);
  EXPECT_EQ(now().sweep.rows_taken, 12);
}

TEST_F(CaptureStationTest, StoppingASweepKeepsItsLinesAndGoingOnCompletesIt) {
  ASSERT_TRUE(connected());
  const auto stopped = captureWatched({}, [&](int lines) {
    if (lines == 5) station_->stop();
  });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().what, kCancelled);
  ASSERT_TRUE(comes(StationState::Ready));
  const int kept = project_->snapshot()->scans()[0].lines;
  EXPECT_GE(kept, 5);
  EXPECT_LT(kept, 101);
  expectTrueScan(0, kept);
  const auto resumed = capture(101, {{"resume", true}});
  ASSERT_TRUE(resumed) << resumed.error().what;
  ASSERT_EQ(project_->snapshot()->scans().size(), 1U);
  expectTrueScan(0, 101);
  EXPECT_EQ(station_->takeRows().size(), static_cast<std::size_t>(101 - kept));
  EXPECT_EQ(now().sweep.rows_taken, 101);
  const auto again = capture(101, {{"resume", true}});
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().what.find("no interrupted"), std::string::npos);
}

TEST_F(CaptureStationTest, AFaultInASweepIsWaitedForAndNothingIsLost) {
  for (const char* fault : {"unplug", "power-cut=5"}) {
    project_.reset();
    std::filesystem::remove(folder_ / "p.tiltmap");
    project_ = std::move(*Project::create(folder_ / "p.tiltmap"));
    make();
    ASSERT_TRUE(connected());
    CaptureSettings settings;
    settings.lines = 40;
    const auto outcome = captureWatched(settings, [&](int lines) {
      if (lines == 4) {
        EXPECT_TRUE(station_->fault(fault));
      }
    });
    ASSERT_TRUE(outcome) << fault << ": " << outcome.error().what;
    expectTrueScan(0, 40);
    EXPECT_GE(now().sweep.recoveries, 1) << fault;
    EXPECT_EQ(state(), StationState::Verdict);
  }
}

TEST_F(CaptureStationTest, AFaultThatStaysEndsTheSweepAndSaysWhatToDo) {
  ASSERT_TRUE(connected());
  CaptureSettings settings;
  settings.patience_s = 5.0;
  const auto outcome = captureWatched(settings, [&](int lines) {
    if (lines == 4) {
      EXPECT_TRUE(station_->fault("silent"));
    }
  });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(state(), StationState::Fault);
  ASSERT_TRUE(now().error);
  EXPECT_NE(now().error->remedy, "");
  expectTrueScan(0, project_->snapshot()->scans()[0].lines);
  EXPECT_FALSE(station_->checkCapture(*project_->snapshot(), {}));
  station_->stop();
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(state(), StationState::Fault);
  // The emulator is built anew, and is healthy.
  station_->reconnect();
  ASSERT_TRUE(comes(StationState::Ready));
  const auto resumed = capture(101, {{"resume", true}});
  ASSERT_TRUE(resumed) << resumed.error().what;
  expectTrueScan(0, 101);
}

TEST_F(CaptureStationTest, WhatGetsLostBetweenSweepsIsFoundAgain) {
  ASSERT_TRUE(connected());
  ASSERT_TRUE(station_->fault("power-cut=3"));
  ASSERT_TRUE(comes([&] { return wasSeen(StationState::Reconnecting); }));
  ASSERT_TRUE(comes(StationState::Ready));
  EXPECT_FALSE(now().error);
  ASSERT_TRUE(capture(5));
  expectTrueScan(0, 5);
}

TEST_F(CaptureStationTest, ASearchForWhatGotLostIsStopped) {
  ASSERT_TRUE(connected(1.0));
  ASSERT_TRUE(station_->fault("silent"));
  ASSERT_TRUE(comes(StationState::Reconnecting));
  station_->stop();
  ASSERT_TRUE(comes(StationState::Fault));
  ASSERT_TRUE(now().error);
  EXPECT_NE(now().error->what.find("stopped sending"), std::string::npos) << now().error->what;
}

// How long a stop takes is printed; what is asserted is that it comes.
TEST_F(CaptureStationTest, StopWorksWhileConnectingAndWhileMoving) {
  const auto stopTakes = [&](const auto& until) {
    const auto begin = std::chrono::steady_clock::now();
    station_->stop();
    EXPECT_TRUE(comes(until));
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  };
  station_->connect(emulated(1.0));
  ASSERT_TRUE(comes(StationState::Connecting));
  std::this_thread::sleep_for(100ms);
  const double connecting_ms = stopTakes([&] { return state() == StationState::Idle; });
  ASSERT_TRUE(connected(1.0));
  station_->jogTo(0.9);
  ASSERT_TRUE(comes(StationState::Moving));
  std::this_thread::sleep_for(300ms);
  const double moving_ms = stopTakes([&] { return state() != StationState::Moving; });
  EXPECT_EQ(state(), StationState::Ready);
  ASSERT_TRUE(comes([&] { return now().tilt_rad.has_value(); })) << "where it was stopped is asked for";
  const double stopped_at = *now().tilt_rad;
  EXPECT_LT(stopped_at, 0.89);
  station_->jogBy(0.05);
  ASSERT_TRUE(comes([&] {
    return state() == StationState::Ready && now().tilt_rad &&
           std::abs(*now().tilt_rad - stopped_at - 0.05) < 0.0006;
  }));
  RecordProperty("connecting_ms", std::to_string(connecting_ms));
  RecordProperty("moving_ms", std::to_string(moving_ms));
  std::printf("stop took effect after %.0f ms while connecting, %.0f ms while moving\n", connecting_ms,
              moving_ms);
}

TEST_F(CaptureStationTest, TheEndOfTheStationInASweepKeepsEveryLine) {
  ASSERT_TRUE(connected());
  const auto operation = makeStationCapture(station_);
  auto job = Job::start(*operation, project_->snapshot(), "default", {});
  ASSERT_TRUE(job);
  ASSERT_TRUE(comes([&] {
    (*job)->serve(*project_);
    return !project_->snapshot()->scans().empty() && project_->snapshot()->scans()[0].lines >= 3;
  }));
  station_->stop();
  while (!(*job)->waitFor(5ms)) (*job)->serve(*project_);
  (*job)->serve(*project_);
  job->reset();
  station_.reset();
  const int kept = project_->snapshot()->scans()[0].lines;
  project_.reset();
  project_ = std::move(*Project::open(folder_ / "p.tiltmap", Access::ReadWrite));
  EXPECT_EQ(project_->snapshot()->scans()[0].lines, kept);
  expectTrueScan(0, kept);
}

TEST_F(CaptureStationTest, AScanOfAnotherWorldIsNotMixedWithAnEmulatedDrive) {
  CaptureSettings other = emulated();
  other.seed = 8;
  ASSERT_TRUE(connected());
  ASSERT_TRUE(capture(3));
  station_->connect(other);
  ASSERT_TRUE(comes([&] { return state() == StationState::Ready && now().source.seed == 8; }));
  const auto refused = capture(3);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("another world"), std::string::npos);
}

class Ports : public CaptureStationTest {
 protected:
  Ports() : rig_(*TerminalRig::open(clock_, *Experiment::make(ExperimentId::Exp1, 7), {})) {}
  std::string level() const { return "level=" + std::to_string(RigSettings().levelCount()); }
  RealClock clock_;
  std::unique_ptr<TerminalRig> rig_;
};

TEST_F(Ports, WhatIsPluggedInIsFound) {
  make({.ports = {rig_->tiltPort(), rig_->scannerPort()}});
  station_->connectToWhatIsThere(level());
  ASSERT_TRUE(comes(StationState::Ready));
  EXPECT_EQ(now().source.scanner, "lms2xx:" + rig_->scannerPort());
  EXPECT_EQ(now().source.tilt, "mip50:" + rig_->tiltPort() + "?" + level());
  make({.ports = {rig_->scannerPort()}});
  station_->connectToWhatIsThere("");
  ASSERT_TRUE(comes(StationState::Fault));
  EXPECT_NE(now().error->what.find("no tilt unit"), std::string::npos) << now().error->what;
}

TEST_F(Ports, ARecordedSessionIsReplayedAsIfLive) {
  CaptureSettings source;
  const std::string scanner_log = (folder_ / "scanner.wire").string(),
                    tilt_log = (folder_ / "tilt.wire").string();
  source.scanner = "lms2xx:" + rig_->scannerPort() + "?log=" + scanner_log;
  source.tilt = "mip50:" + rig_->tiltPort() + "?" + level() + "&log=" + tilt_log;
  // As `tiltmap capture` records it: connected for the sweep.
  const auto operation = makeCaptureOperation();
  auto job = Job::start(*operation, project_->snapshot(), "default",
                        {{"scanner", source.scanner}, {"tilt", source.tilt}, {"lines", 5LL}});
  ASSERT_TRUE(job);
  while (!(*job)->waitFor(5ms)) (*job)->serve(*project_);
  (*job)->serve(*project_);
  const auto recorded = (*job)->result();
  if (!recorded || recorded->report_json.find("\"spoiled\":0") == std::string::npos ||
      recorded->report_json.find("\"recoveries\":0") == std::string::npos)
    GTEST_SKIP() << "the machine is too busy for instruments in real time, nothing worth replaying: "
                 << (recorded ? recorded->report_json : recorded.error().what);
  rig_.reset();
  source.scanner = "lms2xx:replay:" + scanner_log + "?speed=50";
  source.tilt = "mip50:replay:" + tilt_log + "?" + level();
  station_->connect(source);
  ASSERT_TRUE(comes(StationState::Ready));
  EXPECT_TRUE(now().replays);
  for (int replay = 0; replay < 2; ++replay) {
    const auto outcome = capture(5);
    ASSERT_TRUE(outcome) << outcome.error().what << " " << outcome.error().where;
    EXPECT_EQ(now().sweep.recoveries, 0);
    const auto then = project_->snapshot()->scans().front().image(),
               again = project_->snapshot()->scans().back().image();
    ASSERT_TRUE(then && again);
    EXPECT_EQ((*then)->data().code, (*again)->data().code);
    for (int row = 0; row < 5; ++row) EXPECT_EQ((*then)->lineTilt(row), (*again)->lineTilt(row));
  }
  station_->jogBy(0.1);
  ASSERT_TRUE(comes([&] { return now().error.has_value(); }));
  EXPECT_NE(now().error->what.find("recording"), std::string::npos);
  source.scanner = "lms2xx:replay:/no/such/file";
  station_->connect(source);
  ASSERT_TRUE(comes(StationState::Fault));
  EXPECT_TRUE(now().error);
}

}  // namespace
}  // namespace tiltmap
