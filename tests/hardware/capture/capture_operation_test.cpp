#include "hardware/capture/capture_operation.h"

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/live_project.h"
#include "hardware/capture/instruments.h"
#include "tests/support/captured_lines.h"
#include "tests/support/child_process.h"
#include "tests/support/fault_vfs.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

class CaptureOperationTest : public ::testing::Test {
 protected:
  CaptureOperationTest() : path_(folder_ / "p.tiltmap"), operation_(makeCaptureOperation()) {
    project_ = std::move(*Project::create(path_));
  }

  static ParameterValues emulated(int stops, int lines) {
    return {{"emulate", std::string("exp1")},
            {"speed", 0.0},
            {"stops", static_cast<long long>(stops)},
            {"lines", static_cast<long long>(lines)},
            {"seed", 7LL}};
  }
  // The job as a program runs it: storing on this thread.
  Result<OperationResult> run(const ParameterValues& values,
                              const std::function<void(Job&, const ProjectSnapshot&)>& watch = {}) {
    auto job = Job::start(*operation_, project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    while (!(*job)->waitFor(std::chrono::milliseconds(20))) {
      (*job)->serve(*project_);
      if (watch) watch(**job, *project_->snapshot());
    }
    (*job)->serve(*project_);
    return (*job)->result();
  }
  void expectTrueScan(std::size_t index, int lines) {
    test::expectTrueScan(*project_->snapshot(), index, lines);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::unique_ptr<Operation> operation_;
  std::unique_ptr<Project> project_;
};

TEST_F(CaptureOperationTest, StoresStopsWithOdometryTruthAndWhatItWasAskedFor) {
  const auto outcome = run(emulated(2, 5));
  ASSERT_TRUE(outcome) << outcome.error().what << outcome.error().where;
  const SnapshotPtr snapshot = project_->snapshot();
  ASSERT_EQ(snapshot->scans().size(), 2U);
  const auto poses = *experimentPoses(ExperimentId::Exp1, 7, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(snapshot->scans()[i].odometry(), poses[i].odometry);
    EXPECT_EQ(snapshot->scans()[i].poses.at(Stage::Truth), poses[i].truth);
    EXPECT_EQ(snapshot->scans()[i].source, "emulated exp1 seed 7");
    expectTrueScan(i, 5);
  }
  ASSERT_EQ(snapshot->jobs().size(), 2U);
  EXPECT_EQ(snapshot->jobs().back().operation, "capture");
  EXPECT_TRUE(outcome->edit.empty()) << "everything has been stored on the way";
  EXPECT_NE(outcome->report_json.find("counts_per_ms"), std::string::npos);
  EXPECT_TRUE(project_->verify());
}

TEST_F(CaptureOperationTest, LinesAreInTheFileWhileItRuns) {
  // Another process could read each line as soon as its storing is over.
  class Looking : public LiveProject {
   public:
    Looking(Project& project, std::filesystem::path path) : own_(project), path_(std::move(path)) {}
    Result<Change> apply(ProjectEdit edit) override { return own_.apply(std::move(edit)); }
    std::future<Status> appendLine(ScanId scan, int row, ScanLine line) override {
      auto done = own_.appendLine(scan, row, std::move(line));
      const auto reader = Project::open(path_, Access::ReadOnly);
      seen.push_back(reader ? (*reader)->snapshot()->scans().front().lines : -1);
      return done;
    }
    std::vector<int> seen;

   private:
    OwnLiveProject own_;
    std::filesystem::path path_;
  } looking(*project_, path_);
  ASSERT_TRUE(operation_->runLive(project_->snapshot(), *operation_->completed("default", emulated(1, 8)), {},
                                  looking));
  EXPECT_EQ(looking.seen, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(CaptureOperationTest, WhatIsCancelledIsGoneOnWithAndNothingIsEnteredAgain) {
  const auto cancelled = run(emulated(2, 101), [](Job& job, const ProjectSnapshot& snapshot) {
    if (!snapshot.scans().empty() && snapshot.scans().front().lines >= 3) job.cancel();
  });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().what, kCancelled);
  EXPECT_GE(project_->snapshot()->scans().front().lines, 3);
  const int lines = project_->snapshot()->scans().back().lines;
  // As after a new start of the program.
  project_.reset();
  project_ = std::move(*Project::open(path_, Access::ReadWrite));
  expectTrueScan(project_->snapshot()->scans().size() - 1, lines);
  const auto resumed = run({{"resume", true}, {"speed", 0.0}});
  ASSERT_TRUE(resumed) << resumed.error().what;
  ASSERT_EQ(project_->snapshot()->scans().size(), 2U);
  expectTrueScan(0, 101);
  expectTrueScan(1, 101);
  const auto again = run({{"resume", true}, {"speed", 0.0}});
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().what.find("completed"), std::string::npos);
}

TEST_F(CaptureOperationTest, AKillInTheMiddleLosesNoLine) {
  project_.reset();
  for (const int at_write : {60, 131, 300}) {
    std::filesystem::remove(path_);
    ASSERT_TRUE(Project::create(path_));
    test::ChildProcess child([&](const test::ChildProcess::Say& say) {
      const test::FaultVfs kills(test::Fault::Kill, at_write);
      auto project = std::move(*Project::open(path_, Access::ReadWrite));
      OwnLiveProject live(*project);
      class Telling : public LiveProject {
       public:
        Telling(LiveProject& inner, const test::ChildProcess::Say& tell) : inner_(inner), tell_(tell) {}
        Result<Change> apply(ProjectEdit edit) override { return inner_.apply(std::move(edit)); }
        std::future<Status> appendLine(ScanId scan, int row, ScanLine stored) override {
          auto done = inner_.appendLine(scan, row, std::move(stored));
          tell_(std::to_string(++count_));
          return done;
        }

       private:
        LiveProject& inner_;
        const test::ChildProcess::Say& tell_;
        int count_ = 0;
      } telling(live, say);
      (void)operation_->runLive(project->snapshot(), *operation_->completed("default", emulated(1, 60)), {},
                                telling);
      say("finished");
    });
    std::string last, line;
    for (const std::string all = child.rest(); const char c : all) {
      if (c != '\n') {
        line += c;
        continue;
      }
      last = std::exchange(line, {});
    }
    EXPECT_FALSE(child.wait()) << "killed";
    ASSERT_NE(last, "finished");
    project_ = std::move(*Project::open(path_, Access::ReadWrite));
    ASSERT_TRUE(project_->verify());
    EXPECT_GE(project_->snapshot()->scans()[0].lines, std::stoi(last)) << "every line that was told durable";
    expectTrueScan(0, project_->snapshot()->scans()[0].lines);
    const auto resumed = run({{"resume", true}, {"speed", 0.0}});
    ASSERT_TRUE(resumed) << resumed.error().what;
    expectTrueScan(0, 60);
    project_.reset();
  }
}

TEST_F(CaptureOperationTest, AFullDiskKeepsWhatThereIs) {
  project_.reset();
  {
    const test::FaultVfs full(test::Fault::Full, 120);
    project_ = std::move(*Project::open(path_, Access::ReadWrite));
    const auto outcome = run(emulated(1, 60));
    ASSERT_FALSE(outcome);
    EXPECT_NE(outcome.error().what.find("full"), std::string::npos) << outcome.error().what;
    project_.reset();
  }
  project_ = std::move(*Project::open(path_, Access::ReadWrite));
  const int lines = project_->snapshot()->scans()[0].lines;
  EXPECT_GT(lines, 5);
  EXPECT_LT(lines, 60);
  expectTrueScan(0, lines);
  const auto resumed = run({{"resume", true}, {"speed", 0.0}});
  ASSERT_TRUE(resumed) << resumed.error().what;
  expectTrueScan(0, 60);
}

TEST_F(CaptureOperationTest, WordsAreCheckedBeforeAnythingIsOpened) {
  const auto refused = [&](const ParameterValues& values) {
    const Status status = operation_->check(*project_->snapshot(), values);
    return status ? std::string() : status.error().what + " | " + status.error().remedy;
  };
  using V = ParameterValues;
  const std::string scanner = "lms2xx:/dev/nothing", tilt = "mip50:/dev/nothing";
  EXPECT_NE(refused(V{}).find("no scanner"), std::string::npos);
  EXPECT_NE(refused(V{{"scanner", scanner}}).find("no tilt unit"), std::string::npos);
  EXPECT_EQ(refused(V{{"scanner", scanner}, {"tilt", tilt}}), "");
  EXPECT_NE(refused(V{{"scanner", scanner}, {"tilt", std::string("mip50:/dev/x?levl=3")}}).find("level"),
            std::string::npos);
  EXPECT_NE(refused(V{{"scanner", scanner}, {"tilt", std::string("mip50:/dev/x?profile=/no/such")}}), "");
  EXPECT_NE(refused(V{{"scanner", scanner}, {"tilt", std::string("mip50:/dev/x?min=10&max=5")}}), "");
  EXPECT_NE(refused(V{{"scanner", scanner}, {"tilt", std::string("manual:")}}).find("by hand"),
            std::string::npos);
  EXPECT_NE(refused(V{{"scanner", std::string("lms2xx:/dev/x?unit=km")}, {"tilt", tilt}}), "");
  EXPECT_NE(
      refused(V{{"scanner", scanner}, {"tilt", tilt}, {"odometry", std::string("1,2")}}).find("X,Y,HEADING"),
      std::string::npos);
  EXPECT_NE(refused(V{{"scanner", scanner}, {"tilt", tilt}, {"stops", 3LL}}).find("several stops"),
            std::string::npos);
  EXPECT_NE(refused(V{{"emulate", std::string("exp1")}, {"scanner", scanner}}).find("its own"),
            std::string::npos);
  EXPECT_NE(refused(V{{"emulate", std::string("exp1")}, {"stops", 50LL}}), "");
  EXPECT_NE(refused(V{{"resume", true}}).find("no capture"), std::string::npos);
}

TEST_F(CaptureOperationTest, AnEmulatedDriveWantsAnEmptyProject) {
  ASSERT_TRUE(run(emulated(1, 3)));
  EXPECT_FALSE(operation_->check(*project_->snapshot(), emulated(1, 3)));
}

TEST_F(CaptureOperationTest, APortThatIsNotThereIsToldAndNothingIsStored) {
  const auto outcome =
      run({{"scanner", std::string("lms2xx:/dev/no-such-port")}, {"tilt", std::string("mip50:/dev/none")}});
  ASSERT_FALSE(outcome);
  EXPECT_FALSE(outcome.error().remedy.empty());
  EXPECT_TRUE(project_->snapshot()->scans().empty());
}

TEST_F(CaptureOperationTest, LinesThatTheTiltMayNotGoToAreRefusedBeforeAnythingIsStored) {
  ParameterValues values = emulated(1, 3);
  values["start"] = 80.0;
  const auto outcome = run(values);
  ASSERT_FALSE(outcome);
  EXPECT_NE(outcome.error().what.find("limits"), std::string::npos) << outcome.error().what;
  EXPECT_EQ(outcome.error().remedy.find("--resume"), std::string::npos);
  EXPECT_TRUE(project_->snapshot()->scans().empty());
}

TEST(ParseStep, IsRightForwardLeft) {
  const Pose step = *parseStep(" 1, 2.5 ,90");
  EXPECT_NEAR((step.translation() - Eigen::Vector3d(1.0, 2.5, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((step.heading() - Eigen::Vector3d(-1.0, 0.0, 0.0)).norm(), 0.0, 1e-12)
      << "a quarter to the left";
  EXPECT_EQ(*parseStep(""), Pose());
  for (const char* text : {"1", "1,2,3,4", "1,2,x", "nan,0,0", ",,", "1e9,0,0"})
    EXPECT_FALSE(parseStep(text)) << text;
}

}  // namespace
}  // namespace tiltmap
