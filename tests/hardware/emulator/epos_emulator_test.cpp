// The emulated EPOS byte for byte, as any client finds it.
#include "hardware/emulator/epos_emulator.h"

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/transport/memory_channel.h"

namespace tiltmap {
namespace {

class EposEmulatorTest : public ::testing::Test {
 protected:
  void make(EposProtocol protocol, int baud = 115200) {
    if (emulator_) clock_.detach(*emulator_);
    pair_ = MemoryPair::make(clock_, "test");
    ASSERT_TRUE(pair_.host->setLine({baud, Parity::None}));
    settings_.protocol = protocol;
    emulator_ = std::make_unique<EposEmulator>(clock_, *pair_.device, settings_);
    clock_.attach(*emulator_);
  }
  void TearDown() override {
    if (emulator_) clock_.detach(*emulator_);
  }
  // What comes back within the time, after these bytes.
  std::string said(std::string_view hex, double wait_s = 0.05) {
    EXPECT_TRUE(pair_.host->write(*parseHex(hex)));
    clock_.sleepFor(durationOf(wait_s));
    std::array<Byte, 256> buffer;
    ByteVector all;
    while (true) {
      const auto count = pair_.host->read(buffer, clock_.now());
      if (!count || *count == 0) break;
      all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
    }
    return hexText(all);
  }
  // An object of a V2 unit: the answer.
  EposAnswer asked(const EposRequest& request, double wait_s = 0.02) {
    const std::string text =
        said(hexText(encodeEpos(EposProtocol::V2, eposFrame(EposProtocol::V2, request))), wait_s);
    EposStreamReader reader;
    std::vector<EposStreamReader::Item> items;
    reader.push(*parseHex(text), items);
    EXPECT_EQ(items.size(), 1U) << text;
    if (items.empty() || !std::holds_alternative<EposFrame>(items.front())) return {0xFFFFFFFF, {}};
    return eposAnswer(std::get<EposFrame>(items.front())).value_or(EposAnswer{0xFFFFFFFF, {}});
  }
  EposAnswer write(std::uint16_t index, std::uint32_t value, Byte sub = 0) {
    return asked({true, index, sub, value, 1});
  }
  std::uint32_t status() { return asked({false, 0x6041, 0, 0, 1}).value.value_or(0xFFFF); }

  VirtualClock clock_;
  EposEmulatorSettings settings_;
  MemoryPair pair_;
  std::unique_ptr<EposEmulator> emulator_;
};

TEST_F(EposEmulatorTest, EveryStepOfVersionOneIsAcknowledged) {
  make(EposProtocol::V1);
  EXPECT_EQ(said("11"), "4F");
  // The rest of 6040 = 0006: well received, and the answer's code.
  EXPECT_EQ(said("03 40 60 00 01 06 00 00 00 C3 71"), "4F 00");
  EXPECT_EQ(said("4F"), "01 00 00 00 00 51 AA");
  // Not well received: once more.
  EXPECT_EQ(said("46"), "01 00 00 00 00 51 AA");
  EXPECT_EQ(said("4F"), "");
  EXPECT_EQ(said("10"), "4F");
  EXPECT_EQ(said("01 41 60 00 01 AB F0"), "4F 00");
  EXPECT_EQ(said("4F").substr(0, 23), "03 00 00 00 00 21 06 00");
  EXPECT_EQ(said("4F"), "");
}

TEST_F(EposEmulatorTest, VersionOneRefusesWhatItDoesNotKnowAndForgetsWhatStops) {
  make(EposProtocol::V1);
  EXPECT_EQ(said("60"), "46");
  EXPECT_EQ(said("10"), "4F");
  EXPECT_EQ(said("01 41 60 00 01 AB F1"), "46") << "the checksum is wrong";
  EXPECT_EQ(said("10"), "4F");
  EXPECT_EQ(said("01 41", 0.6), "") << "the rest does not come";
  EXPECT_EQ(said("10"), "4F") << "from the beginning";
}

TEST_F(EposEmulatorTest, AnotherRateIsNotUnderstood) {
  make(EposProtocol::V2, 38400);
  EXPECT_EQ(said("90 02 60 02 01 41 60 00 22 D1"), "");
}

TEST_F(EposEmulatorTest, VersionTwoAnswersAndTellsWhatIsDamaged) {
  make(EposProtocol::V2);
  EXPECT_EQ(said("90 02 60 02 01 64 60 00 29 5A"),
            hexText(encodeEpos(EposProtocol::V2, eposFrame(EposAnswer{0, 0}))));
  EXPECT_EQ(said("90 02 60 02 01 64 60 00 29 5B"),
            hexText(encodeEpos(EposProtocol::V2, eposFrame(EposAnswer{epos::kBadChecksum, {}}))));
  EXPECT_EQ(said("55 66 90 90 90 02 60 02 01 64 60 00 29 5A"),
            hexText(encodeEpos(EposProtocol::V2, eposFrame(EposAnswer{0, 0}))))
      << "whatever came before";
}

TEST_F(EposEmulatorTest, ObjectsHaveTheirRights) {
  make(EposProtocol::V2);
  EXPECT_EQ(asked({false, 0x1234, 0, 0, 1}), (EposAnswer{0x06020000, {}}));
  EXPECT_EQ(hexText(encodeEpos(EposProtocol::V2, eposFrame(asked({false, 0x5555, 0, 0, 1})))),
            "90 02 00 02 00 00 02 06 A4 01");
  EXPECT_EQ(asked({false, 0x6099, 3, 0, 1}).error, 0x06090011U);
  EXPECT_EQ(write(0x6041, 5).error, 0x06010002U);
  EXPECT_EQ(write(0x6081, 0).error, 0x06090030U);
  EXPECT_EQ(write(0x6060, 9).error, 0x06090030U);
  EXPECT_EQ(asked({false, 0x6041, 0, 0, 5}).error, 0x0F00FFB9U);
  EXPECT_EQ(write(0x6081, 1234).error, 0U);
  EXPECT_EQ(asked({false, 0x6081, 0, 0, 1}).value, 1234U);
}

TEST_F(EposEmulatorTest, TheDriveGoesThroughItsStates) {
  make(EposProtocol::V2);
  EXPECT_EQ(status() & 0x6F, 0x40U);
  write(0x6040, 0x0F);
  EXPECT_EQ(status() & 0x6F, 0x40U) << "not from there";
  write(0x6040, 0x06);
  EXPECT_EQ(status() & 0x6F, 0x21U);
  write(0x6040, 0x07);
  EXPECT_EQ(status() & 0x6F, 0x23U);
  write(0x6040, 0x0F);
  EXPECT_EQ(status(), 0x0637U) << "enabled, target reached";
  write(0x6040, 0x00);
  EXPECT_EQ(status() & 0x6F, 0x40U);
}

TEST_F(EposEmulatorTest, ASetPointIsTakenAtTheRisingEdgeAlone) {
  make(EposProtocol::V2);
  for (const std::uint32_t word : {0x06U, 0x07U, 0x0FU}) write(0x6040, word);
  write(0x607A, 20000);
  write(0x6040, 0x3F);
  EXPECT_EQ(status() & 0x1400, 0x1000U) << "taken, not reached";
  clock_.sleepFor(durationOf(3.0));
  EXPECT_EQ(status(), 0x1637U) << "reached, still acknowledged";
  EXPECT_EQ(asked({false, 0x6064, 0, 0, 1}).value, 20000U);
  write(0x607A, 40000);
  write(0x6040, 0x3F);
  clock_.sleepFor(durationOf(3.0));
  EXPECT_EQ(asked({false, 0x6064, 0, 0, 1}).value, 20000U) << "no rising edge";
  write(0x6040, 0x0F);
  EXPECT_EQ(status(), 0x0637U);
  write(0x6040, 0x3F);
  EXPECT_EQ(write(0x6060, 6).error, 0x08000022U) << "not while it moves";
  write(0x6040, 0x010F);
  const auto halted = asked({false, 0x6064, 0, 0, 1}).value;
  clock_.sleepFor(durationOf(1.0));
  EXPECT_EQ(asked({false, 0x6064, 0, 0, 1}).value, halted);
  write(0x6040, 0x0F);
  // Relative.
  write(0x607A, static_cast<std::uint32_t>(-1000));
  write(0x6040, 0x7F);
  clock_.sleepFor(durationOf(3.0));
  EXPECT_EQ(asked({false, 0x6064, 0, 0, 1}).value, *halted - 1000);
}

TEST_F(EposEmulatorTest, AMotorThatIsBlockedTrips) {
  make(EposProtocol::V2);
  for (const std::uint32_t word : {0x06U, 0x07U, 0x0FU}) write(0x6040, word);
  emulator_->inject(EposFault::Stall);
  write(0x607A, 20000);
  write(0x6040, 0x3F);
  clock_.sleepFor(durationOf(3.0));
  EXPECT_EQ(status() & 0x6F, 0x08U);
  EXPECT_EQ(asked({false, 0x603F, 0, 0, 1}).value, 0x8611U);
  write(0x6040, 0x00);
  write(0x6040, 0x80);
  EXPECT_EQ(status() & 0x6F, 0x40U);
}

TEST_F(EposEmulatorTest, FaultsHaveNames) {
  make(EposProtocol::V2);
  for (const EposFault fault : allEposFaults()) EXPECT_EQ(eposFaultNamed(eposFaultName(fault)), fault);
  EXPECT_FALSE(emulator_->applyFault("nonsense"));
}

}  // namespace
}  // namespace tiltmap
