// A scanner that gets lost in the middle of its work: power, plug, silence, another rate. It is found again,
// and what did not come is counted.
#include <algorithm>

#include <gtest/gtest.h>

#include "hardware/transport/session_log.h"
#include "support/lms_rig.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace lms2xx;
using namespace std::chrono_literals;
using test::LmsRig;

TEST(LmsLoss, PowerCutAndReturnAt9600) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.scan());
  rig.emulator.cutPower(3s);
  const auto line = rig.scanner.scan();
  ASSERT_FALSE(line);
  test::expectUseful(line.error(), "does not answer");
  EXPECT_EQ(rig.scanner.state(), LmsState::Lost);
  EXPECT_FALSE(rig.scanner.scan()) << "not before it is connected anew";
  const auto back = rig.scanner.recover(90.0);
  ASSERT_TRUE(back) << back.error().what;
  EXPECT_EQ(back->found_at_baud, 9600);
  EXPECT_EQ(rig.emulator.baud(), 38400);
  EXPECT_EQ(rig.emulator.variant(), (Variant{180, 50}));
  EXPECT_TRUE(rig.scanner.scan());
}

TEST(LmsLoss, PowerCutInTheMiddleOfAStream) {
  LmsSettings settings;
  settings.baud = 9600;  // so that the power-on telegram is understood
  settings.variant = {180, 100};
  LmsRig rig({}, settings);
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.startStream());
  ASSERT_TRUE(rig.scanner.next());
  rig.emulator.cutPower(100ms);
  auto line = rig.scanner.next();
  while (line) line = rig.scanner.next();
  test::expectUseful(line.error(), "silent");
  EXPECT_EQ(rig.scanner.state(), LmsState::Lost);
  ASSERT_TRUE(rig.scanner.recover(60.0));
  EXPECT_EQ(rig.emulator.variant(), (Variant{180, 100})) << "set again";
  ASSERT_TRUE(rig.scanner.startStream());
  EXPECT_TRUE(rig.scanner.next());
}

TEST(LmsLoss, AScannerThatRestartsSaysSo) {
  LmsEmulatorSettings emulator;
  emulator.boot_s = 0.2;
  LmsSettings settings;
  settings.baud = 9600;
  LmsRig rig(emulator, settings);
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.startStream());
  ASSERT_TRUE(rig.scanner.next());
  rig.emulator.cutPower(100ms);
  auto line = rig.scanner.next();
  while (line) line = rig.scanner.next();
  test::expectUseful(line.error(), "power was interrupted");
  EXPECT_TRUE(rig.scanner.recover(60.0));
}

TEST(LmsLoss, UnpluggedAndBackUnderAnotherName) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.startStream());
  ASSERT_TRUE(rig.scanner.next());
  rig.unplug();
  rig.plugged_in = false;
  const auto line = rig.scanner.next();
  ASSERT_FALSE(line);
  test::expectUseful(line.error(), "gone");
  EXPECT_EQ(rig.scanner.state(), LmsState::Lost);
  const auto none = rig.scanner.recover(5.0);
  ASSERT_FALSE(none);
  test::expectUseful(none.error(), "no such port");
  rig.port = "port B";
  rig.plugged_in = true;
  const auto back = rig.scanner.recover(30.0);
  ASSERT_TRUE(back) << back.error().what;
  EXPECT_EQ(back->port, "port B");
  EXPECT_TRUE(rig.scanner.scan());
}

TEST(LmsLoss, SilentDeathIsNoticed) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.startStream());
  ASSERT_TRUE(rig.scanner.next());
  rig.emulator.faults().silent = true;
  const double begin = rig.seconds();
  const auto line = rig.scanner.next();
  ASSERT_FALSE(line);
  test::expectUseful(line.error(), "silent");
  EXPECT_LT(rig.seconds() - begin, 3.0);
  const auto back = rig.scanner.recover(30.0);
  ASSERT_FALSE(back);
  test::expectUseful(back.error(), "tried 38400, 9600, 19200, 500000 Bd");
  EXPECT_NE(back.error().remedy.find("RS-422"), std::string::npos);
}

TEST(LmsLoss, WrongRateInTheMiddleOfASession) {
  for (const char* fault : {"wrong-rate=9600", "wrong-rate=19200", "wrong-rate=500000"}) {
    SCOPED_TRACE(fault);
    LmsRig rig;
    ASSERT_TRUE(rig.scanner.connect());
    ASSERT_TRUE(rig.emulator.applyFault(fault));
    const auto line = rig.scanner.scan();
    ASSERT_FALSE(line);
    test::expectUseful(line.error(), "does not answer");
    ASSERT_TRUE(rig.scanner.recover(60.0));
    EXPECT_EQ(rig.emulator.baud(), 38400);
    EXPECT_TRUE(rig.scanner.scan());
  }
}

TEST(LmsLoss, AnAdapterThatCannotDoTheRateLeavesTheScannerWhereItIs) {
  class Slow : public LoggedChannel {
   public:
    using LoggedChannel::LoggedChannel;
    Status setLine(const LineSettings& line) override {
      if (line.baud > 115200) return fail("the port cannot do it", name(), "use a lower rate");
      return LoggedChannel::setLine(line);
    }
  };
  const test::TemporaryFolder folder;
  LmsSettings settings;
  settings.baud = 500000;
  LmsRig rig({}, settings);
  rig.wrap = [&](std::unique_ptr<ByteChannel> channel) -> std::unique_ptr<ByteChannel> {
    return std::make_unique<Slow>(std::move(channel), SessionLog::create(folder / "log", "x").value(),
                                  rig.clock);
  };
  const auto report = rig.scanner.connect();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(report->baud, 9600);
  ASSERT_EQ(report->warnings.size(), 1U);
  EXPECT_NE(report->warnings[0].find("staying at 9600"), std::string::npos);
  EXPECT_TRUE(rig.scanner.scan());
}

TEST(LmsLoss, AStreamCountsWhatIsLost) {
  for (const bool indices : {false, true}) {
    LmsSettings settings;
    settings.indices = indices;
    settings.baud = 500000;
    LmsRig rig({}, settings);
    ASSERT_TRUE(rig.scanner.connect());
    ASSERT_TRUE(rig.emulator.applyFault("flip-bit=0.0003"));
    rig.sent.clear();
    ASSERT_TRUE(rig.scanner.startStream());
    int got = 0, lost = 0;
    std::size_t at = 0;
    while (got < 300) {
      const auto line = rig.scanner.next();
      ASSERT_TRUE(line) << line.error().what;
      // The next one sent that looks like this, and as many before it as it says.
      std::size_t skipped = 0;
      while (at < rig.sent.size() && rig.sent[at].measurement != line->raw) ++at, ++skipped;
      ASSERT_LT(at, rig.sent.size());
      ++at;
      if (got > 0) {
        EXPECT_EQ(line->lost_before, static_cast<int>(skipped));
      }
      lost += line->lost_before;
      ++got;
    }
    EXPECT_GT(lost, 10) << "the fault was there";
    EXPECT_EQ(rig.scanner.statistics().lost_lines, static_cast<std::size_t>(lost));
  }
}

}  // namespace
}  // namespace tiltmap
