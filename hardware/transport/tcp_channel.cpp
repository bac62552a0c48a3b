#include "hardware/transport/tcp_channel.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr int kWriteLimitMs = 2000;
constexpr int kGiveUpMs = 5000;  // of what was sent and not acknowledged
constexpr std::size_t kMostPending = 1 << 20;

void setOption(int socket, int level, int name, int value) {
  (void)setsockopt(socket, level, name, &value, sizeof value);
}

void prepareSocket(int socket) {
  setOption(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  setOption(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  setOption(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kGiveUpMs);
  // Of a connection that only listens, a cable that was pulled is noticed after about ten seconds.
  setOption(socket, IPPROTO_TCP, TCP_KEEPIDLE, 5);
  setOption(socket, IPPROTO_TCP, TCP_KEEPINTVL, 2);
  setOption(socket, IPPROTO_TCP, TCP_KEEPCNT, 3);
}

// Milliseconds until the deadline, as poll() wants them: rounded up, at most a second.
int waitFor(RealClock& clock, Instant deadline) {
  if (deadline == Instant::min()) return 0;
  if (deadline == kNever) return 1000;
  const auto left = clock.systemTime(deadline) - std::chrono::steady_clock::now();
  if (left <= std::chrono::steady_clock::duration::zero()) return 0;
  return static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(
                              std::min<std::chrono::steady_clock::duration>(left, std::chrono::seconds(1)))
                              .count());
}

Error connectError(int number, const std::string& where) {
  const std::string check =
      "check the instrument's supply, its address and the cable, and that this machine "
      "is in the same network (`ping`)";
  if (number == ECONNREFUSED)
    return {"the machine is there and refuses the connection", where,
            "check the port; another program may have it, and after switching on it takes a while"};
  if (number == ETIMEDOUT) return {"nothing answers at that address", where, check};
  return {std::string("cannot connect: ") + std::strerror(number), where, check};
}

// 0, or the number of the error.
int connectWithin(int socket, const addrinfo& to, double limit_s) {
  if (::connect(socket, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd watched{socket, POLLOUT, 0};
  if (::poll(&watched, 1, static_cast<int>(1000.0 * limit_s)) <= 0) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  if (getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  return error;
}

}  // namespace

std::string TcpAddress::text() const {
  const bool bare = host.find(':') == std::string::npos;
  return (bare ? host : "[" + host + "]") + ":" + std::to_string(port);
}

Result<TcpAddress> parseTcpAddress(const std::string& text, int usual_port) {
  const auto wrong = [&] {
    return fail("that is no address in a network", text, "write HOST or HOST:PORT, as 192.168.0.1:2111");
  };
  TcpAddress address{text, usual_port};
  std::string port;
  if (!text.empty() && text.front() == '[') {
    const auto end = text.find(']');
    if (end == std::string::npos) return wrong();
    address.host = text.substr(1, end - 1);
    if (end + 1 < text.size()) {
      if (text[end + 1] != ':') return wrong();
      port = text.substr(end + 2);
      if (port.empty()) return wrong();
    }
  } else if (const auto colon = text.find(':'); colon != std::string::npos) {
    if (text.find(':', colon + 1) != std::string::npos) return wrong();
    address.host = text.substr(0, colon);
    port = text.substr(colon + 1);
    if (port.empty()) return wrong();
  }
  if (!port.empty()) {
    const auto number = parseInteger(port);
    if (!number || *number < 1 || *number > 65535) return wrong();
    address.port = static_cast<int>(*number);
  }
  if (address.port == 0) return wrong();
  const auto strange = [](char c) { return c <= ' ' || c == '/' || c == '?'; };
  if (address.host.empty() || std::ranges::any_of(address.host, strange)) return wrong();
  return address;
}

Result<std::unique_ptr<TcpChannel>> TcpChannel::connect(const TcpAddress& address, RealClock& clock,
                                                        double limit_s) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int failed =
          getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
      failed != 0)
    return fail(std::string("that name is not known: ") + gai_strerror(failed), address.text(),
                "give its number, as 192.168.0.1");
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> all(found, freeaddrinfo);
  int error = ETIMEDOUT;
  for (const addrinfo* each = found; each; each = each->ai_next) {
    const int socket = ::socket(each->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket < 0) continue;
    error = connectWithin(socket, *each, limit_s);
    if (error == 0) {
      prepareSocket(socket);
      return std::unique_ptr<TcpChannel>(new TcpChannel(socket, address.text(), clock));
    }
    ::close(socket);
  }
  return fail(connectError(error, address.text()));
}

TcpChannel::~TcpChannel() {
  close();
}

void TcpChannel::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  if (state_ == ChannelState::Open) state_ = ChannelState::Closed;
}

tl::unexpected<Error> TcpChannel::lost(const std::string& why) {
  if (state_ == ChannelState::Open) state_ = ChannelState::Lost;
  return fail(state_ == ChannelState::Closed ? "the connection was closed" : "the connection is lost" + why,
              name_, "check the instrument's supply and its network cable");
}

Result<std::size_t> TcpChannel::read(std::span<Byte> buffer, Instant deadline) {
  for (;;) {
    if (state_ != ChannelState::Open) return lost("");
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (count > 0) return static_cast<std::size_t>(count);
    if (count == 0) return lost(": the other side has ended it");
    if (errno != EAGAIN && errno != EINTR) return lost(std::string(": ") + std::strerror(errno));
    const int wait = waitFor(clock_, deadline);
    if (wait == 0) return 0;
    pollfd watched{socket_, POLLIN, 0};
    (void)::poll(&watched, 1, wait);
  }
}

Status TcpChannel::write(std::span<const Byte> bytes) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kWriteLimitMs);
  while (!bytes.empty()) {
    if (state_ != ChannelState::Open) return lost("");
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      continue;
    }
    if (count < 0 && errno != EAGAIN && errno != EINTR) return lost(std::string(": ") + std::strerror(errno));
    if (std::chrono::steady_clock::now() >= end) return lost(": the instrument takes nothing");
    pollfd watched{socket_, POLLOUT, 0};
    (void)::poll(&watched, 1, 50);
  }
  return {};
}

Status TcpChannel::setLine(const LineSettings&) {
  return {};
}

Result<std::unique_ptr<TcpWire>> TcpWire::listen(RealClock& clock, int port) {
  std::unique_ptr<TcpWire> wire(new TcpWire(clock));
  wire->server_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (wire->server_ >= 0) setOption(wire->server_, SOL_SOCKET, SO_REUSEADDR, 1);
  if (wire->server_ < 0 || ::bind(wire->server_, generic, size) != 0 || ::listen(wire->server_, 4) != 0 ||
      getsockname(wire->server_, generic, &size) != 0)
    return fail(std::string("cannot listen: ") + std::strerror(errno), "127.0.0.1:" + std::to_string(port),
                "choose another port, or 0 for any");
  wire->port_ = ntohs(address.sin_port);
  wire->name_ = "127.0.0.1:" + std::to_string(wire->port_);
  return wire;
}

TcpWire::~TcpWire() {
  close();
}

void TcpWire::close() {
  hangUp();
  if (server_ >= 0) ::close(server_);
  server_ = -1;
}

void TcpWire::hangUp() {
  if (client_ >= 0) ::close(client_);
  client_ = -1;
  pending_.clear();
}

void TcpWire::welcome() {
  const int fresh = ::accept4(server_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fresh < 0) return;
  hangUp();
  prepareSocket(fresh);
  client_ = fresh;
  ++clients_;
}

Result<std::size_t> TcpWire::read(std::span<Byte> buffer, Instant deadline) {
  for (;;) {
    if (server_ < 0) return fail("nobody listens there any more", name_, "open another one");
    welcome();
    flush();
    if (client_ >= 0) {
      const ssize_t count = ::recv(client_, buffer.data(), buffer.size(), 0);
      if (count > 0) return static_cast<std::size_t>(count);
      if (count == 0 || (errno != EAGAIN && errno != EINTR)) hangUp();
    }
    const int wait = waitFor(clock_, deadline);
    if (wait == 0) return 0;
    pollfd watched[2] = {{server_, POLLIN, 0}, {client_, POLLIN, 0}};
    (void)::poll(watched, 2, wait);
  }
}

Status TcpWire::write(std::span<const Byte> bytes) {
  if (server_ < 0) return fail("nobody listens there any more", name_, "open another one");
  if (client_ < 0) return {};
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  flush();
  if (pending_.size() > kMostPending) pending_.clear();
  return {};
}

void TcpWire::flush() {
  std::size_t sent = 0;
  while (client_ >= 0 && sent < pending_.size()) {
    const ssize_t count = ::send(client_, pending_.data() + sent, pending_.size() - sent, MSG_NOSIGNAL);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
    } else {
      if (errno != EAGAIN && errno != EINTR) {
        hangUp();
        return;
      }
      break;
    }
  }
  pending_.erase(pending_.begin(),
                 pending_.begin() + static_cast<std::ptrdiff_t>(std::min(sent, pending_.size())));
}

Status TcpWire::setLine(const LineSettings&) {
  return {};
}

}  // namespace tiltmap
