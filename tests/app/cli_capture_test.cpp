// Capturing as an operator does it: words in, lines in the project, whatever happens on the way.
#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/project.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap::test {
namespace {

class CliCaptureTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0); }
  ProgramRun run(const std::vector<std::string>& words) { return tiltmap(words, folder_.path()); }
  SnapshotPtr snapshot() {
    const auto project = Project::open(folder_ / "p.tiltmap", Access::ReadOnly);
    return project ? (*project)->snapshot() : nullptr;
  }
  int lines() {
    const SnapshotPtr now = snapshot();
    int sum = 0;
    if (now)
      for (const ScanEntry& scan : now->scans()) sum += scan.lines;
    return sum;
  }
  TemporaryFolder folder_;
};

TEST_F(CliCaptureTest, AnEmulatedDriveComesWithOdometryAndTruth) {
  const ProgramRun captured =
      run({"capture", "p.tiltmap", "--emulate", "exp1", "--speed", "0", "--stops", "2"});
  ASSERT_EQ(captured.exit_code, 0) << captured.err;
  EXPECT_NE(captured.out.find("captured 2 stops, 202 lines"), std::string::npos) << captured.out;
  EXPECT_NE(captured.out.find("120 counts/ms, 2 counts/ms2, 50 ms settling"), std::string::npos)
      << captured.out;
  const SnapshotPtr now = snapshot();
  ASSERT_TRUE(now);
  ASSERT_EQ(now->scans().size(), 2U);
  EXPECT_EQ(now->scans()[1].lines, 101);
  EXPECT_TRUE(now->hasStage(Stage::Truth));
  EXPECT_EQ(run({"evaluate", "p.tiltmap", "--stage", "odometry"}).exit_code, 0);
  // Once more would be another world.
  EXPECT_EQ(run({"capture", "p.tiltmap", "--emulate", "exp1", "--speed", "0"}).exit_code, 1);
  const ProgramRun resumed = run({"capture", "p.tiltmap", "--resume"});
  EXPECT_EQ(resumed.exit_code, 1);
  EXPECT_NE(resumed.err.find("completed"), std::string::npos) << resumed.err;
}

TEST_F(CliCaptureTest, TheSameLinesAsTheSimulation) {
  ASSERT_EQ(run({"capture", "p.tiltmap", "--emulate", "exp1", "--speed", "0", "--stops", "1", "--seed", "5"})
                .exit_code,
            0);
  ASSERT_EQ(run({"new", "s.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "s.tiltmap", "--experiment", "exp1", "--stops", "1", "--seed", "5"}).exit_code,
            0);
  const auto simulated = Project::open(folder_ / "s.tiltmap", Access::ReadOnly);
  ASSERT_TRUE(simulated);
  const auto truth = *(*simulated)->snapshot()->scans()[0].image();
  const auto captured = *snapshot()->scans()[0].image();
  int same = 0;
  for (std::size_t cell = 0; cell < truth->cells(); ++cell)
    same += truth->code(cell) == captured->code(cell) && truth->range(cell) == captured->range(cell) ? 1 : 0;
  // An angle in whole counts is not quite the nominal one: now and then a range falls into the next
  // centimetre.
  EXPECT_GT(same, 0.99 * static_cast<double>(truth->cells()));
}

TEST_F(CliCaptureTest, KilledInTheMiddleItGoesOnWithTheNextLine) {
  for (const int wanted : {20, 150}) {
    const pid_t child =
        wanted == 20
            ? startTiltmap({"capture", "p.tiltmap", "--emulate", "exp1", "--speed", "0", "--stops", "4"},
                           folder_.path())
            : startTiltmap({"capture", "p.tiltmap", "--resume", "--speed", "0"}, folder_.path());
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (lines() < wanted && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const int before = lines();
    kill(child, SIGKILL);
    EXPECT_EQ(waitForTiltmap(child, folder_.path()).exit_code, 128 + SIGKILL);
    EXPECT_GE(before, wanted);
    EXPECT_GE(lines(), before);
    EXPECT_LT(lines(), 404);
    EXPECT_EQ(run({"verify", "p.tiltmap"}).exit_code, 0);
  }
  const ProgramRun resumed = run({"capture", "p.tiltmap", "--resume", "--speed", "0"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(lines(), 404);
  EXPECT_EQ(snapshot()->scans().size(), 4U);
}

TEST_F(CliCaptureTest, MistakesAreTold) {
  const auto mistake = [&](std::vector<std::string> words, const char* said) {
    words.insert(words.begin(), {"capture", "p.tiltmap"});
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, 1) << said;
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
  };
  mistake({}, "no scanner is named");
  mistake({"--resume"}, "no capture to go on with");
  mistake({"--scanner", "lms2xx:/dev/ttyNONE", "--tilt", "mip50:/dev/ttyNONE"}, "ttyNONE");
  mistake({"--scanner", "lms2x:/dev/ttyNONE", "--tilt", "mip50:/dev/ttyNONE"}, "did you mean lms2xx");
  mistake({"--emulate", "exp1", "--odometry=1,2,3"}, "its own instruments");
  EXPECT_EQ(run({"capture", "p.tiltmap", "--emulate", "moon"}).exit_code, 2);
  EXPECT_TRUE(snapshot()->scans().empty());
}

// An emulator in a process of its own: its words lead the driver to it, and control lines work.
TEST_F(CliCaptureTest, TheEmulatorSaysHowToReachIt) {
  const pid_t child = startTiltmap(
      {"emulate", "--experiment", "exp1", "--scanner-link", "lms", "--tilt-link", "mip"}, folder_.path());
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!std::filesystem::exists(folder_ / "mip") && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  while (fileText(folder_ / "out.txt").find("Ctrl-C") == std::string::npos &&
         std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "lms"));
  kill(child, SIGINT);
  const ProgramRun ended = waitForTiltmap(child, folder_.path());
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_NE(ended.out.find("--scanner lms2xx:lms --tilt \"mip50:mip?level="), std::string::npos) << ended.out;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "lms")) << "the links go with it";
}

}  // namespace
}  // namespace tiltmap::test
