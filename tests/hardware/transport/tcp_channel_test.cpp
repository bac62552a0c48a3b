#include "hardware/transport/tcp_channel.h"

#include <thread>

#include <gtest/gtest.h>

#include "hardware/transport/channel_opener.h"

namespace tiltmap {
namespace {

TEST(TcpAddress, HostAndPort) {
  const auto address = [](const char* text) { return parseTcpAddress(text, 2111).value(); };
  EXPECT_EQ(address("192.168.0.1"), (TcpAddress{"192.168.0.1", 2111}));
  EXPECT_EQ(address("scanner.local:2112"), (TcpAddress{"scanner.local", 2112}));
  EXPECT_EQ(address("[::1]:10940"), (TcpAddress{"::1", 10940}));
  EXPECT_EQ(address("[fe80::1]"), (TcpAddress{"fe80::1", 2111}));
  EXPECT_EQ(address("[::1]:10940").text(), "[::1]:10940");
  for (const char* text : {"", ":2111", "host:", "host:x", "host:0", "host:65536", "a:b:c", "[::1", "[::1]x",
                           "/dev/ttyUSB0", "a b"})
    EXPECT_FALSE(parseTcpAddress(text, 2111)) << text;
  EXPECT_FALSE(parseTcpAddress("host", 0));
}

class TcpTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto wire = TcpWire::listen(clock_);
    ASSERT_TRUE(wire) << wire.error().what;
    wire_ = std::move(*wire);
    channel_ = connected();
  }
  std::unique_ptr<TcpChannel> connected() {
    auto channel = TcpChannel::connect({"127.0.0.1", wire_->port()}, clock_);
    EXPECT_TRUE(channel) << channel.error().what;
    return channel ? std::move(*channel) : nullptr;
  }
  Instant soon() { return clock_.now() + durationOf(5.0); }
  static std::string read(ByteChannel& from, Instant deadline) {
    std::array<Byte, 64> buffer;
    const auto count = from.read(buffer, deadline);
    return count ? std::string(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count))
                 : "failed";
  }
  static ByteVector bytes(std::string_view text) { return {text.begin(), text.end()}; }

  RealClock clock_;
  std::unique_ptr<TcpWire> wire_;
  std::unique_ptr<TcpChannel> channel_;
};

TEST_F(TcpTest, BytesGoBothWays) {
  ASSERT_TRUE(channel_->write(bytes("hello")));
  EXPECT_EQ(read(*wire_, soon()), "hello");
  EXPECT_EQ(wire_->clients(), 1);
  ASSERT_TRUE(wire_->write(bytes("yes")));
  EXPECT_EQ(read(*channel_, soon()), "yes");
  EXPECT_EQ(read(*channel_, clock_.now()), "") << "nothing more, without waiting";
  EXPECT_EQ(read(*channel_, clock_.now() + durationOf(0.02)), "");
  EXPECT_EQ(channel_->state(), ChannelState::Open);
  EXPECT_TRUE(channel_->setLine({9600, Parity::None}));
  EXPECT_LT(channel_->line().wireTime(1000), durationOf(0.001));
  EXPECT_NE(channel_->name().find("127.0.0.1:"), std::string::npos);
}

TEST_F(TcpTest, AMebibyteComesThrough) {
  const ByteVector large(1 << 20, 'x');
  std::size_t received = 0;
  std::jthread sender([&] { EXPECT_TRUE(channel_->write(large)); });
  const Instant end = clock_.now() + durationOf(20.0);
  std::array<Byte, 65536> buffer;
  while (received < large.size() && clock_.now() < end) {
    const auto count = wire_->read(buffer, clock_.now() + durationOf(0.2));
    ASSERT_TRUE(count);
    received += *count;
  }
  EXPECT_EQ(received, large.size());
}

TEST_F(TcpTest, AConnectionThatEndsIsLostAndANewOneTakesItsPlace) {
  EXPECT_EQ(read(*wire_, clock_.now()), "");
  wire_->hangUp();
  EXPECT_EQ(read(*channel_, soon()), "failed");
  EXPECT_EQ(channel_->state(), ChannelState::Lost);
  EXPECT_FALSE(channel_->write(bytes("x")));
  channel_ = connected();
  ASSERT_TRUE(channel_->write(bytes("again")));
  EXPECT_EQ(read(*wire_, soon()), "again");
  EXPECT_EQ(wire_->clients(), 2);
  // A second client pushes the first one out.
  const auto other = connected();
  ASSERT_TRUE(other->write(bytes("other")));
  EXPECT_EQ(read(*wire_, soon()), "other");
  EXPECT_EQ(read(*channel_, soon()), "failed");
  channel_->close();
  EXPECT_EQ(channel_->state(), ChannelState::Lost);
}

TEST_F(TcpTest, NobodyListens) {
  const int port = wire_->port();
  wire_->close();
  EXPECT_FALSE(wire_->write(bytes("x")));
  const auto refused = TcpChannel::connect({"127.0.0.1", port}, clock_);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("refuses"), std::string::npos) << refused.error().what;
  EXPECT_FALSE(TcpChannel::connect({"no such host", 1}, clock_));
}

TEST_F(TcpTest, UrlsLeadThere) {
  const auto url = parseDeviceUrl("lms1xx:" + wire_->name() + "?latency=4", scannerSchemes());
  ASSERT_TRUE(url) << url.error().what;
  EXPECT_EQ(url->port, wire_->name());
  EXPECT_EQ(url->tcp_port, 2111);
  auto channel = ChannelOpener(*url, 9600, clock_).open();
  ASSERT_TRUE(channel) << channel.error().what;
  ASSERT_TRUE((*channel)->write(bytes("x")));
  EXPECT_EQ(read(*wire_, soon()), "x");
  const auto wrong = parseDeviceUrl("lms1xx:/dev/ttyUSB0", scannerSchemes());
  ASSERT_TRUE(wrong);
  EXPECT_FALSE(ChannelOpener(*wrong, 9600, clock_).open());
}

}  // namespace
}  // namespace tiltmap
