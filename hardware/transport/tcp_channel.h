// Instruments at a network: a client's connection, and the instrument's side of one for emulators.
#pragma once

#include <memory>
#include <optional>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

struct TcpAddress {
  std::string host;
  int port = 0;
  std::string text() const;
  bool operator==(const TcpAddress&) const = default;
};
// "192.168.0.1", "scanner.local:2111", "[fe80::1]:2111"; the usual port where none is given.
Result<TcpAddress> parseTcpAddress(const std::string& text, int usual_port);

// Plain bytes over TCP. Rates mean nothing here: setLine() is kept and does nothing. A connection that the
// other side gave up is Lost; one whose cable was pulled is noticed when something is sent, by who misses the
// answers, or after about ten seconds.
class TcpChannel : public ByteChannel {
 public:
  // Waits for at most limit_s, real seconds, until the other side accepts. The clock must outlive it.
  static Result<std::unique_ptr<TcpChannel>> connect(const TcpAddress& address, RealClock& clock,
                                                     double limit_s = 3.0);
  ~TcpChannel() override;
  TcpChannel(const TcpChannel&) = delete;
  TcpChannel& operator=(const TcpChannel&) = delete;

  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override { return line_; }
  ChannelState state() const override { return state_; }
  void close() override;
  const std::string& name() const override { return name_; }

 private:
  TcpChannel(int socket, std::string name, RealClock& clock)
      : clock_(clock), socket_(socket), name_(std::move(name)) {}
  tl::unexpected<Error> lost(const std::string& why);
  RealClock& clock_;
  int socket_;
  std::string name_;
  ChannelState state_ = ChannelState::Open;
  LineSettings line_{100'000'000, Parity::None};  // so that wireTime() is that of a network
};

// Listens at this machine alone. One client at a time: a new one takes the place of the one before.
class TcpWire : public DeviceWire {
 public:
  // Port 0: any that is free.
  static Result<std::unique_ptr<TcpWire>> listen(RealClock& clock, int port = 0);
  ~TcpWire() override;
  TcpWire(const TcpWire&) = delete;
  TcpWire& operator=(const TcpWire&) = delete;

  // "127.0.0.1:41235": what a client connects to.
  const std::string& name() const override { return name_; }
  int port() const { return port_; }
  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  // Nothing where there is no client. What a client leaves unread is lost when it becomes more than 1 MiB.
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override { return line_; }
  ChannelState state() const override { return server_ < 0 ? ChannelState::Closed : ChannelState::Open; }
  // A client finds the connection ended, and nobody listening any more.
  void close() override;
  LineSettings peerLine() const override { return line_; }
  Instant nextArrival() const override { return kNever; }
  int descriptor() const override { return client_ >= 0 ? client_ : server_; }
  int clients() const override { return clients_; }
  void hangUp() override;

 private:
  explicit TcpWire(RealClock& clock) : clock_(clock) {}
  void welcome();
  void flush();
  RealClock& clock_;
  int server_ = -1, client_ = -1;
  int port_ = 0, clients_ = 0;
  std::string name_;
  LineSettings line_{100'000'000, Parity::None};
  ByteVector pending_;
};

}  // namespace tiltmap
