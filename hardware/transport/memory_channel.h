// A wire inside the program, on a virtual clock: for tests, and for the emulators where there are no pseudo
// terminals.
#pragma once

#include <deque>
#include <functional>
#include <memory>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

// Whether a side's bytes take their time on the wire. An emulator that sends each byte at its own instant
// says None; a driver hands over a telegram at once and says Baud.
enum class Pacing { Baud, None };

class MemoryWire;

// One end. Reading waits by letting the virtual clock go on. The other end may outlive this one.
class MemoryChannel : public DeviceWire {
 public:
  ~MemoryChannel() override;
  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override;
  ChannelState state() const override;
  void close() override;
  const std::string& name() const override;
  LineSettings peerLine() const override;
  Instant nextArrival() const override;

 private:
  friend struct MemoryPair;
  MemoryChannel(std::shared_ptr<MemoryWire> wire, int side) : wire_(std::move(wire)), side_(side) {}
  std::shared_ptr<MemoryWire> wire_;
  int side_;
};

struct MemoryPair {
  std::unique_ptr<MemoryChannel> host;    // a driver's
  std::unique_ptr<MemoryChannel> device;  // an emulator's
  // Pulls the plug: both sides become Lost, bytes on the wire are gone.
  std::function<void()> unplug;

  // The clock must outlive both ends.
  static MemoryPair make(VirtualClock& clock, std::string name = "in memory", Pacing host = Pacing::Baud,
                         Pacing device = Pacing::None);
};

}  // namespace tiltmap
