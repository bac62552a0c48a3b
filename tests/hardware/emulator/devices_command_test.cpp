// `tiltmap devices` as an operator gives it, with an emulated scanner behind a pseudo terminal.
#include <optional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hardware/emulator/emulator_thread.h"
#include "hardware/emulator/epos_emulator.h"
#include "hardware/emulator/lms_emulator.h"
#include "hardware/transport/pseudo_terminal.h"
#include "support/program.h"

namespace tiltmap {
namespace {

using nlohmann::json;

TEST(DevicesCommand, ListsPorts) {
  const test::TemporaryFolder folder;
  const auto run = test::tiltmap({"devices", "--json"}, folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(json::parse(run.out)["ports"].is_array());
}

TEST(DevicesCommand, AsksAScannerRecordsAndReplaysIt) {
  const test::TemporaryFolder folder;
  RealClock clock;
  const std::string link = (folder / "scanner").string();
  auto terminal = PseudoTerminal::open(clock, link);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  json asked;
  {
    RoundView view;
    LmsEmulatorSettings settings;
    settings.baud = 38400;
    LmsEmulator emulator(clock, view, settings);
    emulator.faults().dirty_window = true;
    emulator.plug(terminal->get());
    const EmulatorThread thread(clock, {{&emulator, terminal->get()}});
    const auto run = test::tiltmap({"devices", "lms2xx:" + link + "?log=a.wire", "--json"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    asked = json::parse(run.out);
    EXPECT_NE(run.err.find("window is dirty"), std::string::npos) << run.err;
    EXPECT_EQ(emulator.baud(), 38400) << "left as it was";
    EXPECT_EQ(emulator.configurationWrites(), 0);
  }
  EXPECT_EQ(asked["type"], "LMS291;S05;V02.30");
  EXPECT_EQ(asked["baud"], 38400);
  EXPECT_EQ(asked["resolution_deg"], 0.5);
  EXPECT_EQ(asked["pollution"][0], 900);
  (*terminal)->close();

  const auto replayed = test::tiltmap({"devices", "lms2xx:replay:a.wire", "--json"}, folder.path());
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  json again = json::parse(replayed.out);
  EXPECT_EQ(again["port"].get<std::string>().substr(0, 6), "replay");
  again["port"] = asked["port"];
  EXPECT_EQ(again, asked);

  const auto gone = test::tiltmap({"devices", "lms2xx:" + link}, folder.path());
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_NE(gone.err.find("no such port"), std::string::npos) << gone.err;
  EXPECT_EQ(test::tiltmap({"devices", "lms:" + link}, folder.path()).exit_code, 2);
}

TEST(DevicesCommand, AsksATiltController) {
  const test::TemporaryFolder folder;
  RealClock clock;
  const std::string link = (folder / "tilt").string();
  auto terminal = PseudoTerminal::open(clock, link);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  EposEmulatorSettings settings;
  settings.protocol = EposProtocol::V1;
  settings.baud = 38400;
  EposEmulator emulator(clock, **terminal, settings);
  const EmulatorThread thread(clock, {{&emulator, terminal->get()}});
  const auto run = test::tiltmap({"devices", "epos:" + link, "--json"}, folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json said = json::parse(run.out);
  EXPECT_EQ(said["protocol"], "v1");
  EXPECT_EQ(said["baud"], 38400);
  EXPECT_EQ(said["status"], "0640");
  EXPECT_EQ(said["position"], 0);
  EXPECT_EQ(test::tiltmap({"devices", "mip50:" + link}, folder.path()).exit_code, 2);
}

}  // namespace
}  // namespace tiltmap
