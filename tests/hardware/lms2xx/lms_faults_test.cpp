// Everything that goes wrong on a wire: nothing wrong is taken for a line, nothing stays lost, and the
// operator is told what happened and what to do.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "hardware/transport/replay_channel.h"
#include "support/lms_rig.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace lms2xx;
using namespace std::chrono_literals;
using test::LmsRig;

// With such a fault, lines are taken until `count` came; each is true.
void takeLines(const std::string& fault, int count, double patience_s = 120.0) {
  SCOPED_TRACE(fault);
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.emulator.applyFault(fault));
  int got = 0;
  for (int i = 0; i < 50 * count && got < count; ++i) {
    const auto line = rig.scanner.scan();
    if (line) {
      ++got;
      test::expectTrue(*line, rig);
    } else {
      test::expectUseful(line.error(), "scan");
      if (rig.scanner.state() == LmsState::Lost) {
        ASSERT_TRUE(rig.scanner.recover(patience_s));
      }
    }
  }
  EXPECT_EQ(got, count);
}

TEST(LmsFaults, LostFlippedDoubledAndInsertedBytes) {
  takeLines("lose-byte=0.0005", 40);
  takeLines("flip-bit=0.0005", 40);
  takeLines("duplicate-byte=0.0005", 40);
  takeLines("insert-byte=0.0005", 40);
}

TEST(LmsFaults, SplitAndMergedTelegrams) {
  takeLines("split=0.02", 20);
  takeLines("merge=0.016", 20);
  takeLines("merge=0.3", 10);
}

TEST(LmsFaults, LostAcknowledgeRefusedChecksumMissedRequestLateAnswerCutTelegram) {
  for (const char* fault : {"lose-acknowledge=1", "refuse-checksum=1", "refuse-checksum=2", "miss-request=1",
                            "miss-request=2", "late-answer=0.5", "late-answer=3", "cut-telegram=1"}) {
    SCOPED_TRACE(fault);
    LmsRig rig;
    ASSERT_TRUE(rig.scanner.connect());
    ASSERT_TRUE(rig.emulator.applyFault(fault));
    const auto line = rig.scanner.scan();
    ASSERT_TRUE(line) << line.error().what;
    test::expectTrue(*line, rig);
    // The promise on its time holds for a line that was asked for twice as well.
    EXPECT_LE(line->earliest_start, rig.sent.back().measured_from);
    EXPECT_EQ(line->raw, rig.sent.back().measurement);
    EXPECT_EQ(rig.scanner.state(), LmsState::Ready);
  }
}

TEST(LmsFaults, ALineThatArrivesDamagedAfterTheTiltWasFreedIsNotReplacedSilently) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.emulator.applyFault("cut-telegram=1"));
  int told = 0;
  const auto line = rig.scanner.scan({}, [&](Instant) { ++told; });
  ASSERT_FALSE(line);
  EXPECT_EQ(told, 1);
  test::expectUseful(line.error(), "damaged");
  EXPECT_EQ(rig.scanner.state(), LmsState::Ready)
      << "the scanner is well; the caller tilts back and asks again";
  EXPECT_TRUE(rig.scanner.scan());
}

TEST(LmsFaults, EveryRequestSurvivesALostAcknowledge) {
  LmsRig rig;
  rig.emulator.faults().lose_acknowledge = 1000;
  const auto report = rig.scanner.connect();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_TRUE(rig.scanner.configure([](Configuration& c) { c.setUnit(Unit::Millimetre); }).value());
  EXPECT_EQ(rig.emulator.configurationWrites(), 1) << "written once, although the acknowledge was lost";
}

TEST(LmsFaults, RefusedConfigurationIsNoSuccess) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  rig.emulator.faults().refuse_configuration = true;
  const auto written = rig.scanner.configure([](Configuration& c) { c.setUnit(Unit::Millimetre); });
  ASSERT_FALSE(written);
  test::expectUseful(written.error(), "refuses the configuration");
  EXPECT_EQ(rig.scanner.report().configuration.unit(), Unit::Centimetre);
  EXPECT_EQ(rig.emulator.mode(), mode::kOnRequest) << "out of the installation mode";
  EXPECT_TRUE(rig.scanner.scan()) << "and it measures on";
}

TEST(LmsFaults, WrongPasswordIsNamed) {
  LmsEmulatorSettings emulator;
  emulator.password = "OTHER_PW";
  LmsRig rig(emulator);
  ASSERT_TRUE(rig.scanner.connect());
  const auto written = rig.scanner.configure([](Configuration& c) { c.setUnit(Unit::Millimetre); });
  ASSERT_FALSE(written);
  test::expectUseful(written.error(), "password");
  EXPECT_TRUE(rig.scanner.scan());
}

TEST(LmsFaults, RefusedVariantSaysWhatStays) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  rig.emulator.faults().refuse_variant = true;
  const auto set = rig.scanner.setVariant({100, 25});
  ASSERT_FALSE(set);
  test::expectUseful(set.error(), "stays at 180 degrees by 0.50");
  EXPECT_FALSE(rig.scanner.setVariant({180, 25})) << "there is none such";
  EXPECT_EQ(rig.scanner.scan()->range_m.size(), 361U);
}

TEST(LmsFaults, ADirtyWindowIsShown) {
  LmsRig rig;
  rig.emulator.faults().dirty_window = true;
  const auto report = rig.scanner.connect();
  ASSERT_TRUE(report);
  ASSERT_EQ(report->warnings.size(), 1U);
  EXPECT_NE(report->warnings[0].find("window is dirty"), std::string::npos);
  const auto line = rig.scanner.scan();
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->status.polluted());
  EXPECT_EQ(report->status.pollution[0], 900);
}

TEST(LmsFaults, DazzledIsNotFar) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  rig.emulator.faults().dazzled = true;
  const auto line = rig.scanner.scan();
  ASSERT_TRUE(line);
  for (const CellCode code : line->code) {
    EXPECT_EQ(code, cell_code::kLmsDazzled);
    EXPECT_FALSE(cell_code::isFar(code));
  }
}

TEST(LmsFaults, AnyFaultsAtOnceGiveTrueLinesOrNone) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    LmsEmulatorSettings emulator;
    emulator.seed = seed;
    LmsRig rig(emulator);
    ASSERT_TRUE(rig.scanner.connect());
    RandomStream random(seed);
    const auto names = LmsEmulator::faultNames();
    for (int i = 0; i < 30; ++i) {
      const std::string& name = names[random.below(names.size())];
      if (name != "silent" && random.below(3) == 0) {
        ASSERT_TRUE(rig.emulator.applyFault(name));
      }
      const auto line = rig.scanner.scan();
      if (line) {
        test::expectTrue(*line, rig);
        continue;
      }
      EXPECT_FALSE(line.error().remedy.empty());
      if (rig.scanner.state() != LmsState::Lost) continue;
      ASSERT_TRUE(rig.emulator.applyFault("none"));
      ASSERT_TRUE(rig.scanner.recover(120.0));
    }
  }
}

TEST(LmsFaults, NamesOfFaults) {
  LmsRig rig;
  for (const std::string& name : LmsEmulator::faultNames())
    EXPECT_TRUE(rig.emulator.applyFault(name)) << name;
  EXPECT_FALSE(rig.emulator.faults().silent) << "`none` is the last";
  const auto wrong = rig.emulator.applyFault("dirty-windw");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().remedy.find("did you mean dirty-window"), std::string::npos);
  EXPECT_FALSE(rig.emulator.applyFault("flip-bit=often"));
  EXPECT_FALSE(rig.emulator.applyFault("flip-bit=1.5"));
}

TEST(LmsFaults, ARecordedSessionWithFaultsAndAnUnpluggedPortReplaysToTheSameLines) {
  const test::TemporaryFolder folder;
  std::vector<std::string> then, now;
  // What an operator would see, line by line.
  const auto session = [](LmsScanner& scanner, const std::function<void(int)>& disturb) {
    std::vector<std::string> seen;
    const auto note = [&](const auto& result) {
      seen.push_back(result ? "done" : result.error().what);
      return result.has_value();
    };
    note(scanner.connect());
    for (int i = 0; i < 30; ++i) {
      disturb(i);
      const auto line = scanner.scan();
      if (note(line))
        seen.back() = std::to_string(line->raw.values[17]) + " " + std::to_string(line->raw.values[300]);
      if (scanner.state() != LmsState::Ready) note(scanner.recover(20.0));
    }
    return seen;
  };
  {
    LmsRig rig;
    const std::shared_ptr<SessionLog> log = SessionLog::create(folder / "log", "lms2xx:x").value();
    rig.wrap = [&](std::unique_ptr<ByteChannel> channel) -> std::unique_ptr<ByteChannel> {
      return std::make_unique<LoggedChannel>(std::move(channel), log, rig.clock);
    };
    rig.refused = [&](const Error& error) { log->add(WireRecord::Kind::Lost, error.what, rig.clock.now()); };
    then = session(rig.scanner, [&](int i) {
      if (i == 2) rig.emulator.faults().flip_bit = 0.001;
      if (i == 12) {
        rig.emulator.faults() = {};
        rig.unplug();
        rig.plugged_in = false;
      }
      if (i == 14) rig.plugged_in = true;
    });
  }
  VirtualClock clock;
  ReplayOpener opener(readSession(folder / "log").value(), clock);
  LmsScanner scanner([&] { return opener.open(); }, clock);
  now = session(scanner, [](int) {});
  EXPECT_EQ(now, then);
  EXPECT_EQ(std::ranges::count(then, "there is no such port"), 2) << "recovering gave up, twice";
  EXPECT_GT(std::ranges::count_if(then, [](const std::string& text) { return text.find(' ') < 5; }), 10);
}

}  // namespace
}  // namespace tiltmap
