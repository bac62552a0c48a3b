#include "hardware/transport/channel_opener.h"

#include <algorithm>

#include "hardware/transport/replay_channel.h"
#include "hardware/transport/serial_port.h"
#include "hardware/transport/tcp_channel.h"

namespace tiltmap {

namespace {

constexpr std::string_view kReplay = "replay:";
constexpr std::string_view kTcp = "tcp:";

}  // namespace

ChannelOpener::ChannelOpener(DeviceUrl url, int baud, RealClock& clock)
    : url_(std::move(url)), baud_(baud), clock_(clock) {}

ChannelOpener::~ChannelOpener() = default;

Result<std::unique_ptr<ByteChannel>> ChannelOpener::open() {
  const auto given = url_.integer("baud", 300, 4000000);
  if (!given) return fail(given.error());
  if (const auto file = url_.option("log"); file && !log_) {
    auto log = SessionLog::create(*file, url_.text());
    if (!log) return fail(log.error());
    log_ = std::move(*log);
  }
  const bool network = url_.tcp_port != 0 || url_.port.starts_with(kTcp);
  auto channel = url_.port.starts_with(kReplay) ? openReplay()
                 : network                      ? openNetwork()
                                                : openPort(given->value_or(baud_));
  if (!log_) return channel;
  if (!channel) {
    log_->add(WireRecord::Kind::Lost, channel.error().what, clock_.now());
    return channel;
  }
  return std::make_unique<LoggedChannel>(std::move(*channel), log_, clock_);
}

Result<std::unique_ptr<ByteChannel>> ChannelOpener::openPort(int baud) {
  const auto path = resolvePort(url_.port, listPorts());
  if (!path) return fail(path.error());
  auto port = SerialPort::open(*path, {baud}, clock_);
  if (!port) return fail(port.error());
  return std::move(*port);
}

Result<std::unique_ptr<ByteChannel>> ChannelOpener::openNetwork() {
  const std::string where = url_.port.starts_with(kTcp) ? url_.port.substr(kTcp.size()) : url_.port;
  const auto address = parseTcpAddress(where, std::max(url_.tcp_port, url_.usual_port));
  if (!address) return fail(address.error());
  auto channel = TcpChannel::connect(*address, clock_);
  if (!channel) return fail(channel.error());
  return std::move(*channel);
}

Result<std::unique_ptr<ByteChannel>> ChannelOpener::openReplay() {
  if (!replay_) {
    const auto speed = url_.number("speed", 0.01, 1000.0);
    if (!speed) return fail(speed.error());
    auto session = readSession(url_.port.substr(kReplay.size()));
    if (!session) return fail(session.error());
    replay_ = std::make_unique<ReplayOpener>(std::move(*session), clock_, speed->value_or(1.0));
  }
  return replay_->open();
}

}  // namespace tiltmap
