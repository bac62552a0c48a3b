#include "hardware/emulator/mip50_emulator.h"

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/transport/memory_channel.h"

namespace tiltmap {
namespace {

// Spoken to in bytes, as a client by others would.
class Mip50EmulatorTest : public ::testing::Test {
 protected:
  void SetUp() override { make({}); }
  void TearDown() override { clock_.detach(*emulator_); }
  void make(const Mip50EmulatorSettings& settings, int host_baud = 19200) {
    if (emulator_) clock_.detach(*emulator_);
    pair_ = MemoryPair::make(clock_);
    (void)pair_.host->setLine({host_baud, Parity::None});
    emulator_ = std::make_unique<Mip50Emulator>(clock_, *pair_.device, settings);
    clock_.attach(*emulator_);
  }
  void send(std::string_view text) {
    ASSERT_TRUE(pair_.host->write({reinterpret_cast<const Byte*>(text.data()), text.size()}));
  }
  std::string hear(double seconds) {
    std::string heard;
    const Instant end = clock_.now() + durationOf(seconds);
    std::array<Byte, 64> buffer;
    while (clock_.now() < end) {
      const auto count = pair_.host->read(buffer, end);
      if (!count) break;
      heard.append(reinterpret_cast<const char*>(buffer.data()), *count);
    }
    return heard;
  }
  std::string ask(std::string_view text, double seconds = 0.2) {
    send(text);
    return hear(seconds);
  }
  void start() {
    hear(0.1);
    for (const char* command : {"f1xG", "E1xG", "C1x2r2t2G", "V1x120G", "n1xG"}) ask(command);
    ASSERT_EQ(ask("H1xG", 20.0), "\r\nX0");
  }
  double degrees() { return emulator_->angle(clock_.now()) / kDegree; }

  VirtualClock clock_;
  MemoryPair pair_;
  std::unique_ptr<Mip50Emulator> emulator_;
};

TEST_F(Mip50EmulatorTest, BootsWithItsBanner) {
  EXPECT_EQ(hear(0.1), "\r\nP0 ASCII - Commandmode\r\n");
  EXPECT_EQ(hear(1.0), "");
  EXPECT_NEAR(degrees(), 0.0, 1e-4);
}

TEST_F(Mip50EmulatorTest, TheStartSequenceAndAMove) {
  hear(0.1);
  EXPECT_EQ(ask("f1xG\r\n"), "\r\nX0");
  EXPECT_EQ(ask("E1xG\n\r"), "\r\nM#20    1          0\r\n\r\nX0");
  EXPECT_EQ(ask("C1x2r2t2G"), "\r\nX0");
  EXPECT_EQ(ask("V1x120G"), "\r\nX0");
  EXPECT_EQ(ask("n1xG"), "\r\nX0");
  EXPECT_EQ(ask("A1x100G"), "\r\nE#177 1 'A'\r\n") << "not before home is known";
  EXPECT_EQ(ask("H1xG", 20.0), "\r\nX0");
  EXPECT_NEAR(degrees(), -36.0, 1e-4);
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1          0\r\n\r\nX0");
  send("A1x42800G");
  EXPECT_EQ(hear(0.3), "") << "acknowledged when the motion has ended";
  EXPECT_EQ(hear(0.3), "\r\nX0");
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1      42800\r\n\r\nX0");
  EXPECT_EQ(ask("q1x15pG"), "\r\nM#26    1   15       1526\r\n\r\nX0");
  EXPECT_EQ(ask("q1x99pG"), "\r\nE#175 1 'q'\r\n");
  EXPECT_EQ(ask("w1x10p500G"), "\r\nE#177 1 'w'\r\n");
  EXPECT_EQ(ask("R1x-800G", 0.5), "\r\nX0");
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1      42000\r\n\r\nX0");
  EXPECT_EQ(ask("f1xG"), "\r\nX0");
  EXPECT_EQ(ask("A1x0G"), "\r\nE#180 1 'A'\r\n");
}

TEST_F(Mip50EmulatorTest, RefusalsAreAsStrictAsTheyCanBe) {
  start();
  EXPECT_EQ(ask("Z1xG"), "\r\nE#172 1 '?'\r\n");
  EXPECT_EQ(ask(std::string(120, '1') + "G"), "\r\nE#173 1 '?'\r\n");
  EXPECT_EQ(ask("V1x0G"), "\r\nE#174 1 'V'\r\n");
  EXPECT_EQ(ask("P2xG"), "") << "another axis";
  send("A1x42800G");
  hear(0.1);
  EXPECT_EQ(ask("P1xG", 0.1), "\r\nE#178 1 'P'\r\n") << "the motion has not ended";
}

TEST_F(Mip50EmulatorTest, ByteByByteAtItsRate) {
  hear(0.1);
  send("P1xG");
  hear(0.0021 + 0.001);
  const Instant begin = clock_.now();
  std::array<Byte, 1> byte;
  for (int i = 0; i < 10; ++i) ASSERT_EQ(pair_.host->read(byte, clock_.now() + durationOf(1.0)).value(), 1U);
  EXPECT_NEAR(secondsOf(clock_.now() - begin), 10 * 10.0 / 19200, 0.0006);
}

TEST_F(Mip50EmulatorTest, AnotherRateIsNotHeard) {
  make({}, 9600);
  hear(0.1);
  EXPECT_EQ(ask("P1xG", 1.0), "");
}

TEST_F(Mip50EmulatorTest, InTheTextMenuACarriageReturnStopsTheMotor) {
  Mip50EmulatorSettings settings;
  settings.text_menu = true;
  make(settings);
  EXPECT_EQ(ask("P1xG"), "");
  EXPECT_EQ(ask("$P"), "\r\nP0 ASCII - Commandmode\r\n");
  EXPECT_EQ(ask("E1xG"), "\r\nM#20    1          0\r\n\r\nX0");
  make(settings);
  ask("P1xG\r\n");
  ask("$P");
  EXPECT_EQ(ask("n1xG"), "\r\nE#176 1 'n'\r\n");
  EXPECT_NE(ask("E1xG"), "\r\nM#20    1          0\r\n\r\nX0");
  EXPECT_EQ(ask("n1xG"), "\r\nX0");
}

TEST_F(Mip50EmulatorTest, FaultsOfTheDrive) {
  start();
  emulator_->inject(Mip50Fault::Stall);
  EXPECT_EQ(ask("A1x42800G", 3.0), "") << "nothing is told";
  EXPECT_FALSE(emulator_->regulated());
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1      12840\r\n\r\nX0");
  EXPECT_EQ(ask("A1x42800G"), "\r\nE#180 1 'A'\r\n");
  EXPECT_EQ(ask("n1xG"), "\r\nE#176 1 'n'\r\n");
  start();
  emulator_->inject(Mip50Fault::FollowError);
  EXPECT_EQ(ask("A1x10000G", 3.0), "");
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1       8000\r\n\r\nX0");
  start();
  emulator_->inject(Mip50Fault::LostSteps);
  EXPECT_EQ(ask("A1x10000G", 1.0), "\r\nX0");
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1       9600\r\n\r\nX0");
  EXPECT_EQ(ask("A1x9999999G", 20.0), "") << "the end stop";
  EXPECT_NEAR(degrees(), 62.0, 0.01);
}

TEST_F(Mip50EmulatorTest, FaultsOfTheLine) {
  start();
  emulator_->inject(Mip50Fault::LateReply);
  EXPECT_EQ(ask("n1xG", 1.0), "");
  EXPECT_EQ(hear(1.0), "\r\nX0");
  emulator_->inject(Mip50Fault::LostDone);
  EXPECT_EQ(ask("P1xG", 2.0), "\r\nM#21    1          0\r\n");
  emulator_->inject(Mip50Fault::LostByte);
  EXPECT_EQ(ask("n1xG").size(), 3U);
  emulator_->inject(Mip50Fault::InsertedByte);
  EXPECT_EQ(ask("n1xG").size(), 5U);
  emulator_->inject(Mip50Fault::FlippedByte);
  const std::string flipped = ask("n1xG");
  EXPECT_EQ(flipped.size(), 4U);
  EXPECT_NE(flipped, "\r\nX0");
  emulator_->inject(Mip50Fault::Silence);
  EXPECT_EQ(ask("n1xG") + ask("P1xG"), "");
  emulator_->inject(Mip50Fault::Recover);
  EXPECT_EQ(ask("n1xG"), "\r\nX0");
}

TEST_F(Mip50EmulatorTest, AfterAPowerCutItDoesNotKnowWhereItIs) {
  start();
  ask("A1x100000G", 3.0);
  const double before = degrees();
  emulator_->inject(Mip50Fault::PowerCut);
  EXPECT_EQ(ask("P1xG", 1.0), "");
  EXPECT_EQ(hear(2.0), "\r\nP0 ASCII - Commandmode\r\n");
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1          0\r\n\r\nX0");
  EXPECT_NEAR(degrees(), before, 1e-9) << "the gear holds";
  start();
  EXPECT_NEAR(degrees(), -36.0, 1e-4);
  // In the middle of a move: it stands where it was caught.
  send("A1x100000G");
  hear(0.3);
  emulator_->inject(Mip50Fault::PowerCut);
  EXPECT_EQ(hear(3.0), "\r\nP0 ASCII - Commandmode\r\n");
  EXPECT_EQ(ask("P1xG"), "\r\nM#21    1          0\r\n\r\nX0");
  EXPECT_GT(degrees(), -36.0);
  EXPECT_LT(degrees(), -30.0);
}

TEST_F(Mip50EmulatorTest, EveryFaultHasItsWord) {
  for (const Mip50Fault fault : allMip50Faults()) EXPECT_EQ(mip50FaultNamed(mip50FaultName(fault)), fault);
  EXPECT_FALSE(mip50FaultNamed("nonsense"));
}

}  // namespace
}  // namespace tiltmap
