#include "hardware/capture/stop_odometry.h"

#include <fstream>

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/project.h"
#include "hardware/capture/capture_operation.h"
#include "hardware/emulator/terminal_rig.h"
#include "tests/support/feed_server.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::FeedServer;

constexpr double kLong_s = 20.0;

class StopOdometryTest : public ::testing::Test {
 protected:
  std::string file(const std::string& text) {
    std::ofstream(folder_ / "stops.tum") << text;
    return (folder_ / "stops.tum").string();
  }
  // A quarter turn to the left after 5 m straight on, in the axes of most robots: x forward.
  std::string drive() {
    return file(
        "# stamp x y z qx qy qz qw\n"
        "10 100 50 0 0 0 0 1\n"
        "20 105 50 0 0 0 0 1\n"
        "30 105 52 0 0 0 0.70710678118654752 0.70710678118654752\n");
  }

  test::TemporaryFolder folder_;
};

void expectPose(const Pose& pose, double x, double y, double heading_deg) {
  const PoseDifference off = difference(pose, Pose::planar(x, y, heading_deg * kDegree));
  EXPECT_LT(off.translation_m, 1e-9) << pose.translation().transpose();
  EXPECT_LT(off.rotation_rad, 1e-9);
}

TEST_F(StopOdometryTest, AFileHasAPoseForEachStop) {
  const auto source = StopOdometry::make(drive(), BodyAxes::ForwardLeftUp);
  ASSERT_TRUE(source) << source.error().what;
  // The file's x is where the vehicle looks, a scan's is to its right: the heading is one quarter less.
  std::optional<Pose> last;
  const auto next = [&](std::size_t stop) {
    last = (*source)->poseOf(stop, last, 0.0, {}).value();
    return *last;
  };
  expectPose(next(0), 100, 50, -90);
  expectPose(next(1), 105, 50, -90);
  expectPose(next(2), 105, 52, 0);
  const auto none = (*source)->poseOf(3, last, 0.0, {});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().what.find("3 poses"), std::string::npos) << none.error().what;
  // Stops that the project has elsewhere: the step from the one before counts.
  expectPose((*source)->poseOf(1, Pose::planar(0, 0, 0), 0.0, {}).value(), 0, 5, 0);
}

TEST_F(StopOdometryTest, AFileMayGrowAndMayHaveOurAxes) {
  const std::string name = file("1 0 0 0 0 0 0 1\n");
  const auto source = StopOdometry::make(name, BodyAxes::RightForwardUp);
  ASSERT_TRUE(source);
  expectPose((*source)->poseOf(0, {}, 0.0, {}).value(), 0, 0, 0);
  EXPECT_FALSE((*source)->poseOf(1, Pose(), 0.0, {}));
  file("1 0 0 0 0 0 0 1\n2 0.5 4 0 0 0 0 1\n");
  expectPose((*source)->poseOf(1, Pose(), 0.0, {}).value(), 0.5, 4, 0);
}

TEST_F(StopOdometryTest, AFeedGivesThePoseThatComesOnceTheVehicleStands) {
  FeedServer server;
  const auto source = StopOdometry::make("tcp://" + server.address().text(), BodyAxes::RightForwardUp);
  ASSERT_TRUE(source) << source.error().what;
  JobControl job;
  int told = 0;
  // The next line is sent when it is waited for.
  job.report = [&](const Progress&) {
    if (told++ == 0) server.send(FeedServer::line(10.0, 3.0, 4.0));
  };
  const auto first = (*source)->poseOf(0, {}, kLong_s, job);
  ASSERT_TRUE(first) << first.error().what;
  expectPose(*first, 3, 4, 0);
  told = 0;
  job.report = [&](const Progress&) {
    if (told++ == 0) server.send(FeedServer::line(20.0, 3.5, 9.0));
  };
  const auto second = (*source)->poseOf(1, first.value(), kLong_s, job);
  ASSERT_TRUE(second) << second.error().what;
  expectPose(*second, 3.5, 9, 0);
  told = 0;
  // A stamp from before: it counts from another origin now.
  job.report = [&](const Progress&) {
    if (told++ == 0) server.send(FeedServer::line(1.0, 0.0, 0.0));
  };
  const auto anew = (*source)->poseOf(2, second.value(), kLong_s, job);
  ASSERT_FALSE(anew);
  EXPECT_NE(anew.error().what.find("begun anew"), std::string::npos) << anew.error().what;
}

TEST_F(StopOdometryTest, ASilentFeedIsToldAndAWaitEndsWhenItIsStopped) {
  FeedServer server;
  const auto source = StopOdometry::make("tcp://" + server.address().text(), BodyAxes::ForwardLeftUp);
  ASSERT_TRUE(source);
  const auto none = (*source)->poseOf(0, {}, 0.05, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().where, server.address().text());
  EXPECT_NE(none.error().remedy.find("--odometry"), std::string::npos);
  std::stop_source stop;
  JobControl job;
  job.stop = stop.get_token();
  job.report = [&](const Progress&) { stop.request_stop(); };
  const auto stopped = (*source)->poseOf(0, {}, 1e6, job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().what, kCancelled);
}

TEST_F(StopOdometryTest, RefusesWhatIsNoSource) {
  for (const std::string& where :
       {std::string("tcp://"), std::string("tcp://host"), std::string("tcp://host:0"),
        (folder_ / "none.tum").string(), file("hello\n"), file("")}) {
    EXPECT_FALSE(StopOdometry::make(where, BodyAxes::ForwardLeftUp)) << where;
    EXPECT_FALSE(checkStopOdometry(where)) << where;
  }
}

class CaptureWithOdometry : public StopOdometryTest {
 protected:
  void SetUp() override {
    rig_ = std::move(*TerminalRig::open(clock_, *Experiment::make(ExperimentId::Exp1, 7), {}));
    project_ = std::move(*Project::create(folder_ / "p.tiltmap"));
  }
  Result<OperationResult> capture(ParameterValues values, const AskOperator& ask = {}) {
    values["scanner"] = "lms2xx:" + rig_->scannerPort();
    values["tilt"] = "mip50:" + rig_->tiltPort() + "?level=" + std::to_string(RigSettings().levelCount());
    values["lines"] = 1LL;
    const auto operation = makeCaptureOperation(ask);
    auto job = Job::start(*operation, project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    while (!(*job)->waitFor(std::chrono::milliseconds(5))) (*job)->serve(*project_);
    (*job)->serve(*project_);
    return (*job)->result();
  }
  Pose stop(std::size_t index) { return project_->snapshot()->scans().at(index).odometry(); }

  RealClock clock_;
  std::unique_ptr<TerminalRig> rig_;
  std::unique_ptr<Project> project_;
};

TEST_F(CaptureWithOdometry, StopsStandWhereTheFileSays) {
  int asked = 0;
  const AskOperator ask = [&](const std::string& question, const std::stop_token&) -> Result<std::string> {
    ++asked;
    EXPECT_NE(question.find("next stop"), std::string::npos);
    return std::string();
  };
  const auto two = capture({{"odometry-from", drive()}, {"stops", 2LL}}, ask);
  ASSERT_TRUE(two) << two.error().what;
  EXPECT_EQ(asked, 1);
  expectPose(stop(0), 100, 50, -90);
  expectPose(stop(1), 105, 50, -90);
  // The third one on a day of its own.
  const auto third = capture({{"odometry-from", drive()}});
  ASSERT_TRUE(third) << third.error().what;
  expectPose(stop(2), 105, 52, 0);
  const auto fourth = capture({{"odometry-from", drive()}});
  ASSERT_FALSE(fourth);
  EXPECT_EQ(project_->snapshot()->scans().size(), 3U) << "a stop of which nobody knows where is not begun";

  FeedServer server;
  const auto mixed = capture({{"odometry-from", "tcp://" + server.address().text()}});
  ASSERT_FALSE(mixed);
  EXPECT_NE(mixed.error().what.find("not placed by this feed"), std::string::npos) << mixed.error().what;
  EXPECT_FALSE(capture({{"odometry-from", drive()}, {"odometry", std::string("0,1,0")}}));
}

}  // namespace
}  // namespace tiltmap
