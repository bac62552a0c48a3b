// Instruments by the words of a command line, at the pseudo terminals of an emulated rig.
#include <algorithm>

#include <gtest/gtest.h>

#include "hardware/capture/instruments.h"
#include "hardware/emulator/terminal_rig.h"
#include "hardware/transport/session_log.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

class NamedInstrumentsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto rig = TerminalRig::open(clock_, *Experiment::make(ExperimentId::Exp1, 3), RigSettings{},
                                 (folder_ / "lms").string(), (folder_ / "mip").string());
    if (!rig) GTEST_SKIP() << rig.error().what;
    rig_ = std::move(*rig);
  }
  std::string log(const std::string& name) const { return (folder_ / name).string(); }
  Result<Instruments> named() {
    return namedInstruments("lms2xx:" + log("lms") + "?log=" + log("scanner.wire"),
                            "mip50:" + log("mip") + "?level=312525&log=" + log("tilt.wire"), clock_, {});
  }
  static long openings(const std::string& file) {
    const auto session = readSession(file);
    if (!session) return -1;
    return std::ranges::count_if(session->records,
                                 [](const auto& r) { return r.kind == WireRecord::Kind::Opened; });
  }

  test::TemporaryFolder folder_;
  RealClock clock_{2.0};
  std::unique_ptr<TerminalRig> rig_;
};

TEST_F(NamedInstrumentsTest, ARecordOfTheWireGoesOnWhenAnInstrumentIsFoundAgain) {
  const auto instruments = named();
  ASSERT_TRUE(instruments) << instruments.error().what;
  for (int time = 0; time < 2; ++time) {
    auto scanner = instruments->open_scanner();
    ASSERT_TRUE(scanner);
    const Status ready = (*scanner)->prepare({});
    ASSERT_TRUE(ready) << ready.error().what << ", " << ready.error().where;
    auto tilt = instruments->open_tilt();
    ASSERT_TRUE(tilt) << tilt.error().what;
    scanner->reset();
    tilt->reset();
    ASSERT_TRUE(rig_->fault("unplug-scanner"));
    ASSERT_TRUE(rig_->fault("unplug-tilt"));
  }
  EXPECT_EQ(openings(log("scanner.wire")), 2);
  EXPECT_EQ(openings(log("tilt.wire")), 2);
}

TEST_F(NamedInstrumentsTest, TheSameWordsOnceMoreBeginARecordOfTheirOwn) {
  for (int time = 0; time < 3; ++time) {
    const auto instruments = named();
    ASSERT_TRUE(instruments);
    const auto tilt = instruments->open_tilt();
    ASSERT_TRUE(tilt) << tilt.error().what;
  }
  EXPECT_EQ(openings(log("tilt.wire")), 1);
  EXPECT_EQ(openings(log("tilt-2.wire")), 1);
  EXPECT_EQ(openings(log("tilt-3.wire")), 1);
}

}  // namespace
}  // namespace tiltmap
