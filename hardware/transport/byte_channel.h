// The one thing that every instrument is reached through: bytes both ways, and the settings of the line.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "hardware/transport/clock.h"

namespace tiltmap {

using Byte = std::uint8_t;
using ByteVector = std::vector<Byte>;

enum class Parity { None, Even, Odd };

// 8 data bits and 1 stop bit always.
struct LineSettings {
  int baud = 9600;
  Parity parity = Parity::None;

  bool operator==(const LineSettings&) const = default;
  // Start, data, parity and stop bits of so many bytes.
  Duration wireTime(std::size_t bytes) const;
};

enum class ChannelState {
  Open,
  Closed,  // by us
  Lost,    // unplugged, or the other side is gone; reading and writing fail from now on
};

// One owner and one thread at a time. Failures are Results whose text an operator understands; a channel
// that failed with state Lost does not come back: open another one.
class ByteChannel {
 public:
  virtual ~ByteChannel() = default;

  // Waits until at least one byte is there, then takes what is there, at most buffer.size(); 0 at the
  // deadline. A deadline that has passed asks without waiting.
  virtual Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) = 0;
  // Hands over the whole of it in one call, without waiting for the last byte to leave the wire
  // (line().wireTime(n) says how long that takes).
  virtual Status write(std::span<const Byte> bytes) = 0;
  // Takes effect for what is written afterwards; the caller waits until earlier bytes have left.
  virtual Status setLine(const LineSettings& line) = 0;
  virtual LineSettings line() const = 0;
  // Throws away what has arrived and was not read.
  virtual Status discardInput();
  virtual ChannelState state() const = 0;
  virtual void close() = 0;
  // The port as an operator knows it: "/dev/ttyUSB0", "in memory".
  virtual const std::string& name() const = 0;
};

// The instrument's side of a wire, for emulators.
class DeviceWire : public ByteChannel {
 public:
  // What the other side has set its line to: an instrument understands its own rate only.
  virtual LineSettings peerLine() const = 0;
  // When the next byte will be there to read; kNever where that is not known in advance.
  virtual Instant nextArrival() const = 0;
  // To wait on with poll(); -1 where there is none.
  virtual int descriptor() const { return -1; }
  // How many clients there have been, where that can be told: a network's instrument forgets what a client
  // had ordered when another one comes.
  virtual int clients() const { return 1; }
  // Ends the connection with the client, where there is such a thing.
  virtual void hangUp() {}
};

// "02 80 D6 02": for messages, logs and tests.
std::string hexText(std::span<const Byte> bytes);
// The other way; blanks between bytes are optional. Fails at the first character that is none.
Result<ByteVector> parseHex(std::string_view text);

}  // namespace tiltmap
