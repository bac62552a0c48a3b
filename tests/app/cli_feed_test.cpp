// A capture whose stops are placed by the vehicle's own computer over TCP: words in, poses in the project.
#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "core/project/project.h"
#include "hardware/emulator/terminal_rig.h"
#include "tests/support/feed_server.h"
#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

class CliFeedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto rig = TerminalRig::open(clock_, *Experiment::make(ExperimentId::Exp1, 7), {});
    if (!rig) GTEST_SKIP() << rig.error().what;
    rig_ = std::move(*rig);
    ASSERT_EQ(tiltmap({"new", "p.tiltmap"}, folder_.path()).exit_code, 0);
  }
  // A vehicle that stands there and says so all the time, in the axes of most robots.
  ProgramRun capture(double x_m, double y_m, std::vector<std::string> more = {}) {
    FeedServer server(port_);
    port_ = server.address().port;
    std::jthread vehicle([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        server.send(FeedServer::line(stamp_s_ += 0.1, x_m, y_m));
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      }
    });
    std::vector<std::string> words{"capture",         "p.tiltmap",
                                   "--lines",         "2",
                                   "--scanner",       RigSettings().scannerUrl(rig_->scannerPort()),
                                   "--tilt",          RigSettings().tiltUrl(rig_->tiltPort()),
                                   "--odometry-from", "tcp://" + server.address().text()};
    words.insert(words.end(), more.begin(), more.end());
    return tiltmap(words, folder_.path());
  }
  SnapshotPtr snapshot() { return (*Project::open(folder_ / "p.tiltmap", Access::ReadOnly))->snapshot(); }

  TemporaryFolder folder_;
  RealClock clock_;
  std::unique_ptr<TerminalRig> rig_;
  int port_ = 0;
  double stamp_s_ = 100.0;
};

TEST_F(CliFeedTest, EachStopStandsWhereTheVehicleSaidItWas) {
  const ProgramRun first = capture(10.0, 5.0);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  ASSERT_TRUE(rig_->moveTo(1));
  const ProgramRun second = capture(14.5, 4.0);
  ASSERT_EQ(second.exit_code, 0) << second.err;
  const SnapshotPtr now = snapshot();
  ASSERT_EQ(now->scans().size(), 2U);
  for (const ScanEntry& scan : now->scans()) EXPECT_EQ(scan.lines, 2);
  // The feed's x is where the vehicle looks: a scan's own is to its right.
  const auto expectAt = [&](std::size_t stop, double x, double y) {
    const PoseDifference off = difference(now->scans()[stop].odometry(), Pose::planar(x, y, -90.0 * kDegree));
    EXPECT_LT(off.translation_m, 1e-6) << now->scans()[stop].odometry().translation().transpose();
    EXPECT_LT(off.rotation_rad, 1e-6);
  };
  expectAt(0, 10.0, 5.0);
  expectAt(1, 14.5, 4.0);
  const Pose step = now->scans()[0].odometry().inverse() * now->scans()[1].odometry();
  EXPECT_NEAR(step.translation().y(), 4.5, 1e-6) << "forward";
  EXPECT_NEAR(step.translation().x(), 1.0, 1e-6) << "to the right";
}

TEST_F(CliFeedTest, AFeedThatSaysNothingBeginsNoStop) {
  FeedServer server;
  const ProgramRun run = tiltmap(
      {"capture", "p.tiltmap", "--lines", "2", "--patience", "1", "--scanner",
       RigSettings().scannerUrl(rig_->scannerPort()), "--tilt", RigSettings().tiltUrl(rig_->tiltPort()),
       "--odometry-from", "tcp://" + server.address().text()},
      folder_.path());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("no odometry has come"), std::string::npos) << run.err;
  EXPECT_TRUE(snapshot()->scans().empty());
}

}  // namespace
}  // namespace tiltmap::test
