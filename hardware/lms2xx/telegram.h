// SICK LMS 2xx telegrams as bytes: frame, checksum, addresses. Pure functions.
//
//   02 | address | length, 2 bytes | command | data ... [status] | CRC, 2 bytes
//
// The length counts command, data and status; telegrams from the scanner alone have a status. Numbers are
// little-endian. There is neither escaping nor an end mark (telegram listing LMS2xx, 8007954).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hardware/transport/byte_channel.h"

namespace tiltmap::lms2xx {

inline constexpr Byte kStx = 0x02;
inline constexpr Byte kAck = 0x06;
inline constexpr Byte kNak = 0x15;
inline constexpr std::size_t kOverhead = 6;          // STX, address, length, CRC
inline constexpr std::size_t kLongestPayload = 820;  // the longest known is 808
inline constexpr Byte kFromScanner = 0x80;           // set in the address of what the scanner sends
inline constexpr Byte kAnswerBit = 0x80;             // set in the command of an answer

// Commands of requests; an answer has bit 7 set as well, with the exceptions named.
namespace command {
inline constexpr Byte kReset = 0x10;  // answered by 91, then 90
inline constexpr Byte kMode = 0x20;
inline constexpr Byte kMeasure = 0x30;
inline constexpr Byte kStatus = 0x31;
inline constexpr Byte kErrors = 0x32;
inline constexpr Byte kHours = 0x35;
inline constexpr Byte kMean = 0x36;
inline constexpr Byte kRange = 0x37;
inline constexpr Byte kType = 0x3A;
inline constexpr Byte kVariant = 0x3B;
inline constexpr Byte kFields = 0x3E;
inline constexpr Byte kMeanRange = 0x3F;
inline constexpr Byte kFieldSet = 0x41;
inline constexpr Byte kReflectivity = 0x44;
inline constexpr Byte kPermanentRate = 0x66;
inline constexpr Byte kReadConfiguration = 0x74;
inline constexpr Byte kEnergy = 0x75;
inline constexpr Byte kCartesian = 0x76;
inline constexpr Byte kWriteConfiguration = 0x77;
inline constexpr Byte kReadConfiguration2 = 0x7B;
inline constexpr Byte kPowerOn = 0x90;        // from the scanner, unasked
inline constexpr Byte kResetAccepted = 0x91;  // from the scanner
inline constexpr Byte kRefused = 0x92;        // from the scanner, instead of any answer
}  // namespace command

// The checksum of those bytes: polynomial 8005 with one shift a byte, two neighbouring bytes XORed in.
std::uint16_t crc(std::span<const Byte> bytes);

// Command and data (and, from the scanner, status) of one telegram.
struct Telegram {
  Byte address = 0;
  ByteVector payload;

  bool fromScanner() const { return (address & kFromScanner) != 0; }
  Byte command() const { return payload.empty() ? Byte{0} : payload.front(); }
  // Without command and status.
  std::span<const Byte> data() const;
  // Of a telegram from the scanner.
  Byte status() const { return payload.empty() ? Byte{0} : payload.back(); }
  std::size_t wireSize() const { return payload.size() + kOverhead; }
  bool operator==(const Telegram&) const = default;
};

// The whole of it as it goes over the wire. Throws std::invalid_argument for an empty or too long payload.
ByteVector encode(const Telegram& telegram);
// What a host sends to the unit (0: to any) ...
ByteVector encodeRequest(Byte command, std::span<const Byte> data = {}, Byte address = 0);
// ... and what a unit answers; its address without bit 7.
ByteVector encodeAnswer(Byte command, std::span<const Byte> data, Byte status, Byte unit = 0);

// Little-endian numbers.
inline std::uint16_t word(std::span<const Byte> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}
inline void addWord(ByteVector& bytes, unsigned value) {
  bytes.push_back(static_cast<Byte>(value & 255U));
  bytes.push_back(static_cast<Byte>(value >> 8 & 255U));
}

}  // namespace tiltmap::lms2xx
