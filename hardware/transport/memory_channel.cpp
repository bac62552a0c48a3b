#include "hardware/transport/memory_channel.h"

#include <algorithm>
#include <array>

namespace tiltmap {

class MemoryWire {
 public:
  struct Arrival {
    Instant at;
    Byte byte;
  };
  struct Side {
    LineSettings line;
    Pacing pacing = Pacing::Baud;
    ChannelState state = ChannelState::Open;
    std::deque<Arrival> incoming;
    Instant wire_free{};  // when the last byte that this side wrote has arrived
  };

  MemoryWire(VirtualClock& clock, std::string name) : clock_(clock), name_(std::move(name)) {}

  VirtualClock& clock_;
  std::string name_;
  std::array<Side, 2> sides_;
};

MemoryChannel::~MemoryChannel() {
  close();
}

Result<std::size_t> MemoryChannel::read(std::span<Byte> buffer, Instant deadline) {
  MemoryWire::Side& side = wire_->sides_[static_cast<std::size_t>(side_)];
  VirtualClock& clock = wire_->clock_;
  for (;;) {
    std::size_t count = 0;
    while (count < buffer.size() && !side.incoming.empty() && side.incoming.front().at <= clock.now()) {
      buffer[count++] = side.incoming.front().byte;
      side.incoming.pop_front();
    }
    if (count > 0 || buffer.empty()) return count;
    if (side.state != ChannelState::Open)
      return fail("the connection is gone", wire_->name_, "plug it in again and connect anew");
    const Instant wake = std::min(deadline, nextArrival());
    if (deadline <= clock.now()) return 0;
    if (wake == kNever) throw std::logic_error("MemoryChannel: a read without end");
    clock.step(wake);
  }
}

Status MemoryChannel::write(std::span<const Byte> bytes) {
  MemoryWire::Side& side = wire_->sides_[static_cast<std::size_t>(side_)];
  MemoryWire::Side& peer = wire_->sides_[static_cast<std::size_t>(1 - side_)];
  if (side.state != ChannelState::Open)
    return fail("the connection is gone", wire_->name_, "plug it in again and connect anew");
  const Instant begin = std::max(wire_->clock_.now(), side.wire_free);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const Instant at = side.pacing == Pacing::Baud ? begin + side.line.wireTime(i + 1) : begin;
    if (peer.state == ChannelState::Open) peer.incoming.push_back({at, bytes[i]});
    side.wire_free = at;
  }
  return {};
}

Status MemoryChannel::setLine(const LineSettings& line) {
  if (line.baud <= 0)
    return fail("a rate of " + std::to_string(line.baud) + " Bd is impossible", wire_->name_,
                "give a positive number");
  wire_->sides_[static_cast<std::size_t>(side_)].line = line;
  return {};
}

LineSettings MemoryChannel::line() const {
  return wire_->sides_[static_cast<std::size_t>(side_)].line;
}

ChannelState MemoryChannel::state() const {
  return wire_->sides_[static_cast<std::size_t>(side_)].state;
}

void MemoryChannel::close() {
  MemoryWire::Side& side = wire_->sides_[static_cast<std::size_t>(side_)];
  if (side.state == ChannelState::Open) side.state = ChannelState::Closed;
  side.incoming.clear();
}

const std::string& MemoryChannel::name() const {
  return wire_->name_;
}

LineSettings MemoryChannel::peerLine() const {
  return wire_->sides_[static_cast<std::size_t>(1 - side_)].line;
}

Instant MemoryChannel::nextArrival() const {
  const MemoryWire::Side& side = wire_->sides_[static_cast<std::size_t>(side_)];
  return side.incoming.empty() ? kNever : side.incoming.front().at;
}

MemoryPair MemoryPair::make(VirtualClock& clock, std::string name, Pacing host, Pacing device) {
  auto wire = std::make_shared<MemoryWire>(clock, std::move(name));
  wire->sides_[0].pacing = host;
  wire->sides_[1].pacing = device;
  MemoryPair pair;
  pair.host.reset(new MemoryChannel(wire, 0));
  pair.device.reset(new MemoryChannel(wire, 1));
  pair.unplug = [wire] {
    for (MemoryWire::Side& side : wire->sides_) {
      if (side.state == ChannelState::Open) side.state = ChannelState::Lost;
      side.incoming.clear();
    }
  };
  return pair;
}

}  // namespace tiltmap
