#include "hardware/transport/byte_channel.h"

#include <array>

namespace tiltmap {

Duration LineSettings::wireTime(std::size_t bytes) const {
  const std::int64_t bits = parity == Parity::None ? 10 : 11;
  return Duration(static_cast<std::int64_t>(bytes) * bits * 1'000'000'000 / baud);
}

Status ByteChannel::discardInput() {
  std::array<Byte, 4096> waste;
  for (;;) {
    const auto count = read(waste, Instant::min());
    if (!count) return fail(count.error());
    if (*count == 0) return {};
  }
}

std::string hexText(std::span<const Byte> bytes) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  text.reserve(bytes.size() * 3);
  for (const Byte byte : bytes) {
    if (!text.empty()) text += ' ';
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

Result<ByteVector> parseHex(std::string_view text) {
  const auto digit = [](char c) -> int {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  ByteVector bytes;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    const int high = digit(text[i]), low = i + 1 < text.size() ? digit(text[i + 1]) : -1;
    if (high < 0 || low < 0)
      return fail("there are no two hexadecimal digits", "character " + std::to_string(i + 1),
                  "bytes are written as two digits each, 0 to F");
    bytes.push_back(static_cast<Byte>(high * 16 + low));
    i += 2;
  }
  return bytes;
}

}  // namespace tiltmap
