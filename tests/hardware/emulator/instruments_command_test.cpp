// Emulated instruments of each make in a process of their own, asked and captured with as an operator does.
#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/geometry/pose.h"
#include "core/project/project.h"
#include "support/program.h"

namespace tiltmap {
namespace {

using nlohmann::json;

struct Make {
  const char* scanner;
  const char* tilt;
  int columns;
  double start_deg;
};

class InstrumentsCommand : public ::testing::TestWithParam<Make> {};

TEST_P(InstrumentsCommand, AreFoundAskedAndCapturedWith) {
  const Make& make = GetParam();
  const test::TemporaryFolder folder;
  const test::TemporaryFolder emulator_folder;
  const pid_t emulator = test::startTiltmap(
      {"emulate", "--experiment", "exp1", "--scanner-model", make.scanner, "--tilt-model", make.tilt},
      emulator_folder.path());
  std::string said;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (said.find("Ctrl-C") == std::string::npos && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    said = test::fileText(emulator_folder / "out.txt");
  }
  // --scanner SCHEME:PORT --tilt "SCHEME:PORT?level=N"
  const auto between = [&](const std::string& before, char after) {
    const auto at = said.find(before);
    return at == std::string::npos
               ? std::string()
               : said.substr(at + before.size(), said.find(after, at + before.size()) - at - before.size());
  };
  const std::string scanner = between("--scanner ", ' '), tilt = between("--tilt \"", '"');
  EXPECT_FALSE(scanner.empty()) << said;
  EXPECT_FALSE(tilt.empty()) << said;

  const auto asked = test::tiltmap({"devices", scanner, "--json"}, folder.path());
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  if (asked.exit_code == 0) {
    EXPECT_NEAR(json::parse(asked.out)["start_deg"].get<double>(), make.start_deg, 1e-3);
  }
  EXPECT_EQ(test::tiltmap({"new", "p.tiltmap"}, folder.path()).exit_code, 0);
  const auto captured = test::tiltmap(
      {"capture", "p.tiltmap", "--scanner", scanner, "--tilt", tilt, "--lines", "3", "--start=-30"},
      folder.path());
  EXPECT_EQ(captured.exit_code, 0) << captured.err;
  kill(emulator, SIGINT);
  EXPECT_EQ(test::waitForTiltmap(emulator, emulator_folder.path()).exit_code, 0);

  const auto project = Project::open(folder / "p.tiltmap", Access::ReadOnly);
  ASSERT_TRUE(project);
  const auto snapshot = (*project)->snapshot();
  ASSERT_EQ(snapshot->scans().size(), 1U);
  const ScanEntry& scan = snapshot->scans().front();
  EXPECT_EQ(scan.lines, 3);
  EXPECT_EQ(scan.columns, make.columns);
  EXPECT_NEAR(scan.geometry.azimuth_start_rad / kDegree, make.start_deg, 1e-3);
  const auto image = scan.image();
  ASSERT_TRUE(image);
  EXPECT_GT((*image)->validCells(), static_cast<std::size_t>(make.columns) / 10);
  EXPECT_NEAR((*image)->lineTilt(2) / kDegree, -28.4, 0.03);
}
INSTANTIATE_TEST_SUITE_P(Makes, InstrumentsCommand,
                         ::testing::Values(Make{"lms511", "epos", 381, -5.0},
                                           Make{"urg04lx", "epos-v1", 682, 90.0 - 340 * 0.3515625},
                                           Make{"utm30lx-ew", "mip50", 1081, -45.0}),
                         [](const auto& test) {
                           std::string name = test.param.scanner;
                           std::erase(name, '-');
                           return name;
                         });

TEST(InstrumentsCommand, WordsThatAreNoneAreRefused) {
  const test::TemporaryFolder folder;
  for (const auto& words : {std::vector<std::string>{"emulate", "--scanner-model", "lms"},
                            {"emulate", "--tilt-model", "mip"},
                            {"devices", "urg:tcp:"},
                            {"devices", "lms1xx:127.0.0.1:0"},
                            {"devices", "epos:x?protocol=v9"}}) {
    const auto run = test::tiltmap(words, folder.path());
    EXPECT_NE(run.exit_code, 0) << words.back();
    EXPECT_FALSE(run.err.empty());
  }
}

}  // namespace
}  // namespace tiltmap
