// The instrument's end of a pseudo terminal: what any serial program may open instead of a port.
#pragma once

#include <memory>
#include <optional>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

// A pseudo terminal neither paces bytes nor garbles them at a wrong rate: the emulator sends each byte at its
// instant and asks peerLine() what the client has set. The terminal stays while clients come and go.
class PseudoTerminal : public DeviceWire {
 public:
  // `link`: a symbolic link to make to it (an old link there is replaced, a file is not); empty: none.
  static Result<std::unique_ptr<PseudoTerminal>> open(RealClock& clock, const std::string& link = {});
  ~PseudoTerminal() override;
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  // "/dev/pts/5": what a client opens.
  const std::string& name() const override { return name_; }
  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  // What a client leaves unread waits, as in the buffers of a port; it is lost where it becomes more than 64
  // KiB or nothing is taken for half a second.
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override { return line_; }
  ChannelState state() const override { return master_ < 0 ? ChannelState::Closed : ChannelState::Open; }
  // Also removes the link. A client finds its port gone.
  void close() override;
  LineSettings peerLine() const override;
  Instant nextArrival() const override { return kNever; }
  int descriptor() const override { return master_; }

 private:
  explicit PseudoTerminal(RealClock& clock) : clock_(clock) {}
  Status flush();
  RealClock& clock_;
  int master_ = -1;
  int slave_ = -1;  // kept open, so that the terminal outlives a client that leaves
  std::string name_, link_;
  LineSettings line_;
  ByteVector pending_;
  std::chrono::steady_clock::time_point moved_{};  // when the client last took some of it
};

}  // namespace tiltmap
