#include "hardware/lms2xx/telegram.h"

#include <algorithm>
#include <stdexcept>

namespace tiltmap::lms2xx {

std::uint16_t crc(std::span<const Byte> bytes) {
  unsigned remainder = 0, previous = 0;
  for (const Byte byte : bytes) {
    const bool top = (remainder & 0x8000U) != 0;
    remainder = remainder << 1 & 0xffffU;
    if (top) remainder ^= 0x8005U;
    remainder ^= previous << 8 | byte;
    previous = byte;
  }
  return static_cast<std::uint16_t>(remainder);
}

std::span<const Byte> Telegram::data() const {
  const std::size_t behind = fromScanner() ? 1 : 0;
  if (payload.size() < 1 + behind) return {};
  return std::span(payload).subspan(1, payload.size() - 1 - behind);
}

ByteVector encode(const Telegram& telegram) {
  if (telegram.payload.empty() || telegram.payload.size() > kLongestPayload)
    throw std::invalid_argument("lms2xx::encode: a payload has 1 to 820 bytes");
  ByteVector bytes;
  bytes.reserve(telegram.wireSize());
  bytes.push_back(kStx);
  bytes.push_back(telegram.address);
  addWord(bytes, static_cast<unsigned>(telegram.payload.size()));
  bytes.insert(bytes.end(), telegram.payload.begin(), telegram.payload.end());
  addWord(bytes, crc(bytes));
  return bytes;
}

ByteVector encodeRequest(Byte command, std::span<const Byte> data, Byte address) {
  Telegram telegram{address, ByteVector(data.size() + 1)};
  telegram.payload.front() = command;
  std::ranges::copy(data, telegram.payload.begin() + 1);
  return encode(telegram);
}

ByteVector encodeAnswer(Byte command, std::span<const Byte> data, Byte status, Byte unit) {
  Telegram telegram{static_cast<Byte>(unit | kFromScanner), ByteVector(data.size() + 2)};
  telegram.payload.front() = command;
  std::ranges::copy(data, telegram.payload.begin() + 1);
  telegram.payload.back() = status;
  return encode(telegram);
}

}  // namespace tiltmap::lms2xx
