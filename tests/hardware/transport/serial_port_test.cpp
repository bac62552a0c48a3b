// The real port class against a pseudo terminal: there is no other port on a machine that tests run on.
#include "hardware/transport/serial_port.h"

#include <array>

#include <gtest/gtest.h>

#include "hardware/transport/device_url.h"
#include "hardware/transport/pseudo_terminal.h"
#include "hardware/transport/session_log.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

ByteVector readAll(ByteChannel& channel, Clock& clock, std::size_t length) {
  ByteVector all;
  std::array<Byte, 100> buffer;
  while (all.size() < length) {
    const auto count = channel.read(buffer, clock.now() + 10s);
    if (!count || *count == 0) break;
    all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
  }
  return all;
}

ByteVector everyByte() {
  ByteVector bytes(256);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<Byte>(i);
  return bytes;
}

TEST(SerialPort, CarriesEveryByteBothWaysAtEveryRate) {
  RealClock clock;
  auto terminal = PseudoTerminal::open(clock);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  auto port = SerialPort::open((*terminal)->name(), {9600}, clock);
  ASSERT_TRUE(port) << port.error().what;
  const ByteVector bytes = everyByte();
  for (const int baud : {9600, 19200, 38400, 57600, 500000}) {
    ASSERT_TRUE((*port)->setLine({baud}));
    EXPECT_EQ((*port)->line().baud, baud);
    EXPECT_EQ((*terminal)->peerLine().baud, baud);
    ASSERT_TRUE((*port)->write(bytes));
    EXPECT_EQ(readAll(**terminal, clock, 256), bytes);
    ASSERT_TRUE((*terminal)->write(bytes));
    EXPECT_EQ(readAll(**port, clock, 256), bytes);
  }
  std::array<Byte, 4> buffer;
  EXPECT_EQ((*port)->read(buffer, clock.now() + 5ms).value(), 0U);
  EXPECT_EQ((*port)->read(buffer, Instant::min()).value(), 0U);
  EXPECT_EQ((*port)->state(), ChannelState::Open);
  (*port)->close();
  EXPECT_EQ((*port)->state(), ChannelState::Closed);
  EXPECT_FALSE((*port)->write(bytes));
  EXPECT_FALSE((*port)->read(buffer, clock.now() + 1s));
  EXPECT_FALSE((*port)->setLine({9600}));
  EXPECT_TRUE(SerialPort::open((*terminal)->name(), {9600}, clock)) << "free again";
}

TEST(SerialPort, APortThatGoesAwayIsLostNotSilent) {
  RealClock clock;
  auto terminal = PseudoTerminal::open(clock);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  auto port = SerialPort::open((*terminal)->name(), {9600}, clock);
  ASSERT_TRUE(port);
  ASSERT_TRUE((*terminal)->write(ByteVector{7}));
  EXPECT_EQ(readAll(**port, clock, 1), ByteVector{7});
  (*terminal)->close();
  std::array<Byte, 4> buffer;
  const auto read = (*port)->read(buffer, clock.now() + 10s);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().what.find("unplugged"), std::string::npos);
  EXPECT_EQ((*port)->state(), ChannelState::Lost);
  EXPECT_FALSE((*port)->write(ByteVector{1}));
}

TEST(SerialPort, SaysWhyAPortCannotBeOpened) {
  RealClock clock;
  const auto absent = SerialPort::open("/dev/tty-that-is-not-there", {9600}, clock);
  ASSERT_FALSE(absent);
  EXPECT_NE(absent.error().remedy.find("tiltmap devices"), std::string::npos);
  EXPECT_FALSE(SerialPort::open("/dev/null", {9600}, clock)) << "no serial port";
}

TEST(OpenChannel, OpensWhatTheUrlNamesAndRecordsIt) {
  const test::TemporaryFolder folder;
  RealClock clock;
  const std::string link = (folder / "scanner").string(), log = (folder / "log.wire").string();
  auto terminal = PseudoTerminal::open(clock, link);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  {
    const auto url = parseDeviceUrl("lms2xx:" + link + "?baud=19200&log=" + log, scannerSchemes());
    ASSERT_TRUE(url);
    auto channel = openChannel(*url, 9600, clock);
    ASSERT_TRUE(channel) << channel.error().what;
    EXPECT_EQ((*terminal)->peerLine().baud, 19200);
    ASSERT_TRUE((*channel)->write(ByteVector{1, 2}));
    EXPECT_EQ(readAll(**terminal, clock, 2), (ByteVector{1, 2}));
    EXPECT_FALSE(openChannel(*url, 9600, clock)) << "the log is there already, and the port in use";
  }
  const auto replay = parseDeviceUrl("lms2xx:replay:" + log + "?speed=10", scannerSchemes());
  ASSERT_TRUE(replay);
  auto channel = openChannel(*replay, 9600, clock);
  ASSERT_TRUE(channel) << channel.error().what;
  EXPECT_EQ((*channel)->line().baud, 19200);
  EXPECT_TRUE((*channel)->write(ByteVector{1, 2}));
  EXPECT_FALSE((*channel)->write(ByteVector{1, 2}));
  EXPECT_FALSE(openChannel({"lms2xx", "replay:/nowhere", {}}, 9600, clock));
}

}  // namespace
}  // namespace tiltmap
