#include "hardware/transport/memory_channel.h"

#include <array>
#include <stdexcept>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

TEST(LineSettings, TenBitsAByteElevenWithParity) {
  EXPECT_EQ((LineSettings{9600}).wireTime(96), 100ms);
  EXPECT_EQ((LineSettings{500000}).wireTime(1), 20us);
  EXPECT_EQ((LineSettings{11000, Parity::Even}).wireTime(10), 10ms);
}

TEST(HexText, BothWays) {
  const ByteVector bytes{0x02, 0x80, 0xd6, 0x0f};
  EXPECT_EQ(hexText(bytes), "02 80 D6 0F");
  EXPECT_EQ(parseHex("02 80 D6 0F").value(), bytes);
  EXPECT_EQ(parseHex("0280d60f").value(), bytes);
  EXPECT_TRUE(parseHex("")->empty());
  EXPECT_EQ(parseHex("02 8").error().where, "character 4");
  EXPECT_FALSE(parseHex("02 8 0"));
  EXPECT_FALSE(parseHex("0x02"));
}

TEST(MemoryChannel, BytesTakeTheirTime) {
  VirtualClock clock;
  MemoryPair pair = MemoryPair::make(clock);
  ASSERT_TRUE(pair.host->setLine({9600}));
  EXPECT_EQ(pair.device->peerLine().baud, 9600);
  const ByteVector sent{1, 2, 3};
  ASSERT_TRUE(pair.host->write(sent));
  std::array<Byte, 8> buffer;
  EXPECT_EQ(pair.device->read(buffer, Instant::min()).value(), 0U);
  EXPECT_EQ(pair.device->nextArrival(), Instant{} + (LineSettings{9600}).wireTime(1));
  // One byte after the other, each at its own instant.
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(pair.device->read(buffer, clock.now() + 1s).value(), 1U);
    EXPECT_EQ(buffer[0], sent[i]);
    EXPECT_EQ(clock.now(), Instant{} + (LineSettings{9600}).wireTime(i + 1));
  }
  EXPECT_EQ(pair.device->nextArrival(), kNever);
  // Deadlines are kept.
  EXPECT_EQ(pair.device->read(buffer, clock.now() + 1s).value(), 0U);
  EXPECT_EQ(clock.now(), Instant{} + (LineSettings{9600}).wireTime(3) + 1s);
  EXPECT_THROW((void)pair.device->read(buffer, kNever), std::logic_error);
}

TEST(MemoryChannel, ASecondTelegramWaitsForTheFirst) {
  VirtualClock clock;
  MemoryPair pair = MemoryPair::make(clock);
  ASSERT_TRUE(pair.host->write(ByteVector(10, 7)));
  ASSERT_TRUE(pair.host->write(ByteVector(10, 8)));
  clock.sleepFor((LineSettings{9600}).wireTime(20) - 1us);
  std::array<Byte, 32> buffer;
  EXPECT_EQ(pair.device->read(buffer, clock.now()).value(), 19U);
}

TEST(MemoryChannel, TheUnpacedSideArrivesAtOnce) {
  VirtualClock clock;
  MemoryPair pair = MemoryPair::make(clock);
  ASSERT_TRUE(pair.device->write(ByteVector(100, 7)));
  std::array<Byte, 60> buffer;
  EXPECT_EQ(pair.host->read(buffer, clock.now()).value(), 60U);
  ASSERT_TRUE(pair.host->discardInput());
  EXPECT_EQ(pair.host->read(buffer, clock.now()).value(), 0U);
}

TEST(MemoryChannel, PulledPlugIsLostOnBothSides) {
  VirtualClock clock;
  MemoryPair pair = MemoryPair::make(clock, "port A");
  ASSERT_TRUE(pair.device->write(ByteVector(3, 7)));
  pair.unplug();
  std::array<Byte, 8> buffer;
  const auto read = pair.host->read(buffer, clock.now() + 1s);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().where, "port A");
  EXPECT_EQ(pair.host->state(), ChannelState::Lost);
  EXPECT_FALSE(pair.device->write(ByteVector(1, 7)));
  EXPECT_EQ(pair.device->state(), ChannelState::Lost);
  pair.host->close();
  EXPECT_EQ(pair.host->state(), ChannelState::Lost) << "closing a lost port does not make it a closed one";
}

TEST(MemoryChannel, OneEndMayOutliveTheOther) {
  VirtualClock clock;
  MemoryPair pair = MemoryPair::make(clock);
  pair.host.reset();
  EXPECT_TRUE(pair.device->write(ByteVector(3, 7)));
  std::array<Byte, 8> buffer;
  EXPECT_EQ(pair.device->read(buffer, clock.now() + 1s).value(), 0U);
}

}  // namespace
}  // namespace tiltmap
