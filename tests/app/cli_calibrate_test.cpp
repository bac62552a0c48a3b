// A simulated scanner with planted errors, calibrated on the command line.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

TEST(CliCalibrate, PlantedErrorsAreTabledAppliedAndTakenBack) {
  TemporaryFolder folder;
  const auto run = [&](std::vector<std::string> words) { return tiltmap(words, folder.path()); };
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "loop", "--seed", "3", "--stops", "8", "--plant",
                 "tilt-zero=0.5,lever-arm-y=0.05,range-offset=0.03"})
                .exit_code,
            0);
  const ProgramRun early = run({"calibrate", "p.tiltmap"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_NE(early.err.find("tiltmap register"), std::string::npos) << early.err;
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);

  const ProgramRun table = run({"calibrate", "p.tiltmap"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  for (const char* word : {"range offset", "lever arm y", "no scans tell it", "not applied", "sigma"})
    EXPECT_NE(table.out.find(word), std::string::npos) << word << "\n" << table.out;

  const ProgramRun applied = run({"calibrate", "p.tiltmap", "--apply", "--out", "c.json", "--json"});
  ASSERT_EQ(applied.exit_code, 0) << applied.err;
  const json report = json::parse(applied.out);
  EXPECT_TRUE(report["applied"].get<bool>());
  EXPECT_NEAR(report["geometry"]["range_offset_m"].get<double>(), 0.03, 0.004);
  EXPECT_NE(run({"history", "p.tiltmap"}).out.find("calibrate: "), std::string::npos);
  EXPECT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);

  ASSERT_EQ(run({"calibrate", "p.tiltmap", "--from", "c.json", "--apply"}).exit_code, 0);
  EXPECT_EQ(run({"calibrate", "p.tiltmap", "--from", "c.json"}).exit_code, 1);
  EXPECT_EQ(run({"calibrate", "p.tiltmap", "--out", "p.tiltmap"}).exit_code, 1);
  EXPECT_EQ(run({"calibrate", "p.tiltmap", "--scans", "99"}).exit_code, 1);
  EXPECT_EQ(run({"calibrate", "p.tiltmap", "--aply"}).exit_code, 2);

  const ProgramRun body = run({"body-mask", "p.tiltmap"});
  EXPECT_EQ(body.exit_code, 0) << body.err;
  EXPECT_NE(body.out.find("no cell shows the machine"), std::string::npos) << body.out;
}

}  // namespace
}  // namespace tiltmap::test
