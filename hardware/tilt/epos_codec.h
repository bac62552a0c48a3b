// The RS-232 and USB protocols of maxon's EPOS controllers as bytes, both ways. No clocks, no ports.
//
// Everything an EPOS does is an object of CiA 301/402 that is read or written; the protocols differ in how a
// frame is wrapped, and what its operation codes are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

enum class EposProtocol {
  V1,     // EPOS 24/1, 24/5, 70/10, and EPOS2 at its RS-232 port: every step of a frame is acknowledged
  V2,     // EPOS4: frames marked by 90 02, one request, one answer
  V2Usb,  // EPOS2 at its USB port: frames as V2, operation codes and layout as V1
};
// "v1", "v2", "usb".
std::string eposProtocolName(EposProtocol protocol);
std::optional<EposProtocol> eposProtocolNamed(std::string_view name);

// An operation code and 16-bit words, sent low byte first.
struct EposFrame {
  Byte code = 0;
  std::vector<std::uint16_t> words;
  bool operator==(const EposFrame&) const = default;
};

// CRC-CCITT (1021, start 0) over code, length and words, one zero word behind them, most significant bit
// first.
std::uint16_t eposChecksum(EposProtocol protocol, const EposFrame& frame);

// The bytes of the whole frame; of V1 the first one is sent by itself and has to be answered. Throws
// std::invalid_argument for more words than a length byte can tell (255, V1 256; V1 needs one at least).
ByteVector encodeEpos(EposProtocol protocol, const EposFrame& frame);

namespace epos {
inline constexpr Byte kReady = 0x4F;    // 'O', of V1: go on, or: well received
inline constexpr Byte kRefused = 0x46;  // 'F', of V1: not now, or: garbled
inline constexpr Byte kAnswer = 0x00;   // the operation code of every answer
// The abort code for a frame that arrived damaged.
inline constexpr std::uint32_t kBadChecksum = 0x05040004;
// The EPOS forgets a frame of V1 after so much silence.
inline constexpr double kForgetsS = 0.5;
}  // namespace epos

// One object to be read or written.
struct EposRequest {
  bool write = false;
  std::uint16_t index = 0;
  Byte sub = 0;
  std::uint32_t value = 0;  // written
  Byte node = 1;
  bool operator==(const EposRequest&) const = default;
};
EposFrame eposFrame(EposProtocol protocol, const EposRequest& request);
// The other way; nothing for frames that are no such request.
std::optional<EposRequest> eposRequest(EposProtocol protocol, const EposFrame& frame);

struct EposAnswer {
  std::uint32_t error = 0;             // an abort code of CiA 301, or maxon's; 0: done
  std::optional<std::uint32_t> value;  // of what was read
  bool operator==(const EposAnswer&) const = default;
};
EposFrame eposFrame(const EposAnswer& answer);
std::optional<EposAnswer> eposAnswer(const EposFrame& frame);

// What an abort code means, with its number.
std::string eposAbortText(std::uint32_t code);

// Reads the rest of a V1 frame, whose code has come already: length, words, checksum.
class EposBodyReader {
 public:
  enum class State { Unfinished, Whole, Damaged };
  explicit EposBodyReader(Byte code = 0) { begin(code); }
  void begin(Byte code);
  // Nothing is taken behind the end.
  State push(Byte byte);
  State state() const { return state_; }
  const EposFrame& frame() const { return frame_; }  // once Whole

 private:
  EposFrame frame_;
  State state_ = State::Unfinished;
  ByteVector bytes_;
};

// Finds V2 frames in a stream however it is cut into portions. 90 02 always begins a frame, because a 90
// inside of one is sent twice; so whatever was lost, the next frame is found.
class EposStreamReader {
 public:
  struct Damaged {
    bool operator==(const Damaged&) const = default;
  };
  using Item = std::variant<EposFrame, Damaged>;

  explicit EposStreamReader(EposProtocol protocol = EposProtocol::V2) : protocol_(protocol) {}
  void push(std::span<const Byte> bytes, std::vector<Item>& items);
  void clear();

 private:
  void finish(std::vector<Item>& items);
  EposProtocol protocol_;
  bool inside_ = false, marked_ = false;  // marked: the byte before was a 90 that is not yet understood
  ByteVector bytes_;
};

}  // namespace tiltmap
