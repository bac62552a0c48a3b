#include "hardware/tilt/epos_codec.h"

#include <array>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace tiltmap {

namespace {

constexpr Byte kMark = 0x90, kBegin = 0x02;
// Operation codes of V1 (and of V2 over an EPOS2's USB), and of V2.
constexpr Byte kReadV1 = 0x10, kWriteV1 = 0x11, kReadV2 = 0x60, kWriteV2 = 0x68;

// In V1 the length byte tells one word less than there is.
std::size_t lengthByte(EposProtocol protocol, std::size_t words) {
  return protocol == EposProtocol::V1 ? words - 1 : words;
}

void appendWord(ByteVector& bytes, std::uint16_t word) {
  bytes.push_back(static_cast<Byte>(word & 0xFF));
  bytes.push_back(static_cast<Byte>(word >> 8));
}

std::uint16_t wordAt(std::span<const Byte> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}

std::uint16_t low(std::uint32_t value) {
  return static_cast<std::uint16_t>(value & 0xFFFF);
}
std::uint16_t high(std::uint32_t value) {
  return static_cast<std::uint16_t>(value >> 16);
}
std::uint32_t both(std::uint16_t low_word, std::uint16_t high_word) {
  return static_cast<std::uint32_t>(high_word) << 16 | low_word;
}

}  // namespace

std::string eposProtocolName(EposProtocol protocol) {
  return protocol == EposProtocol::V1 ? "v1" : protocol == EposProtocol::V2 ? "v2" : "usb";
}
std::optional<EposProtocol> eposProtocolNamed(std::string_view name) {
  for (const EposProtocol protocol : {EposProtocol::V1, EposProtocol::V2, EposProtocol::V2Usb})
    if (eposProtocolName(protocol) == name) return protocol;
  return std::nullopt;
}

std::uint16_t eposChecksum(EposProtocol protocol, const EposFrame& frame) {
  unsigned crc = 0;
  const auto feed = [&crc](unsigned word) {
    for (unsigned mask = 0x8000; mask != 0; mask >>= 1) {
      const bool carry = (crc & 0x8000) != 0;
      crc = (crc << 1) & 0xFFFF;
      if (word & mask) ++crc;
      if (carry) crc ^= 0x1021;
    }
  };
  // The head is a word as it stands on the wire: in V1 the code is its high byte, in V2 its low one.
  const auto length = static_cast<unsigned>(lengthByte(protocol, frame.words.size()) & 0xFF);
  feed(protocol == EposProtocol::V1 ? static_cast<unsigned>(frame.code) << 8 | length
                                    : frame.code | length << 8);
  for (const std::uint16_t word : frame.words) feed(word);
  feed(0);
  return static_cast<std::uint16_t>(crc);
}

ByteVector encodeEpos(EposProtocol protocol, const EposFrame& frame) {
  const bool v1 = protocol == EposProtocol::V1;
  if (frame.words.size() > (v1 ? 256U : 255U) || (v1 && frame.words.empty()))
    throw std::invalid_argument("encodeEpos: the length does not fit into its byte");
  ByteVector plain{frame.code, static_cast<Byte>(lengthByte(protocol, frame.words.size()))};
  for (const std::uint16_t word : frame.words) appendWord(plain, word);
  appendWord(plain, eposChecksum(protocol, frame));
  if (v1) return plain;
  ByteVector stuffed{kMark, kBegin};
  for (const Byte byte : plain) {
    stuffed.push_back(byte);
    if (byte == kMark) stuffed.push_back(byte);
  }
  return stuffed;
}

EposFrame eposFrame(EposProtocol protocol, const EposRequest& request) {
  EposFrame frame;
  if (protocol == EposProtocol::V2) {
    // Bytes: node, index, sub-index.
    frame.code = request.write ? kWriteV2 : kReadV2;
    frame.words = {static_cast<std::uint16_t>(request.node | (request.index & 0xFF) << 8),
                   static_cast<std::uint16_t>(request.index >> 8 | request.sub << 8)};
  } else {
    frame.code = request.write ? kWriteV1 : kReadV1;
    frame.words = {request.index, static_cast<std::uint16_t>(request.node << 8 | request.sub)};
  }
  if (request.write) {
    frame.words.push_back(low(request.value));
    frame.words.push_back(high(request.value));
  }
  return frame;
}

std::optional<EposRequest> eposRequest(EposProtocol protocol, const EposFrame& frame) {
  const bool v2 = protocol == EposProtocol::V2;
  EposRequest request;
  request.write = frame.code == (v2 ? kWriteV2 : kWriteV1);
  if (!request.write && frame.code != (v2 ? kReadV2 : kReadV1)) return std::nullopt;
  if (frame.words.size() != (request.write ? 4U : 2U)) return std::nullopt;
  const unsigned first = frame.words[0], second = frame.words[1];
  if (v2) {
    request.node = static_cast<Byte>(first & 0xFF);
    request.index = static_cast<std::uint16_t>(first >> 8 | (second & 0xFF) << 8);
    request.sub = static_cast<Byte>(second >> 8);
  } else {
    request.index = frame.words[0];
    request.node = static_cast<Byte>(second >> 8);
    request.sub = static_cast<Byte>(second & 0xFF);
  }
  if (request.write) request.value = both(frame.words[2], frame.words[3]);
  return request;
}

EposFrame eposFrame(const EposAnswer& answer) {
  EposFrame frame{epos::kAnswer, {low(answer.error), high(answer.error)}};
  if (answer.value) {
    frame.words.push_back(low(*answer.value));
    frame.words.push_back(high(*answer.value));
  }
  return frame;
}

std::optional<EposAnswer> eposAnswer(const EposFrame& frame) {
  if (frame.code != epos::kAnswer || (frame.words.size() != 2 && frame.words.size() != 4))
    return std::nullopt;
  EposAnswer answer{both(frame.words[0], frame.words[1]), std::nullopt};
  if (frame.words.size() == 4) answer.value = both(frame.words[2], frame.words[3]);
  return answer;
}

std::string eposAbortText(std::uint32_t code) {
  static constexpr std::array<std::pair<std::uint32_t, const char*>, 18> kTexts{{
      {0x06020000, "there is no such object"},
      {0x06090011, "the object has no such sub-index"},
      {0x06010000, "the object cannot be accessed so"},
      {0x06010001, "the object cannot be read"},
      {0x06010002, "the object cannot be written"},
      {0x06040043, "the parameter is incompatible"},
      {0x06040047, "the device is incompatible with it"},
      {0x06090030, "the value lies outside of its range"},
      {0x08000020, "the data cannot be stored"},
      {0x08000022, "not in the present state of the device"},
      {epos::kBadChecksum, "the frame arrived damaged"},
      {0x05040005, "out of memory"},
      {0x0F00FFC0, "the device is in a wrong state of the network"},
      {0x0F00FFBF, "an illegal command"},
      {0x0F00FFBE, "a wrong password"},
      {0x0F00FFBC, "the device is not in service mode"},
      {0x0F00FFB9, "a wrong node"},
      {0x08000000, "a general error"},
  }};
  char number[16];
  std::snprintf(number, sizeof number, "%08X", static_cast<unsigned>(code));
  for (const auto& [known, text] : kTexts)
    if (known == code) return std::string(text) + " (" + number + ")";
  return std::string("abort code ") + number;
}

void EposBodyReader::begin(Byte code) {
  frame_ = {code, {}};
  state_ = State::Unfinished;
  bytes_.clear();
}

EposBodyReader::State EposBodyReader::push(Byte byte) {
  if (state_ != State::Unfinished) return state_;
  bytes_.push_back(byte);
  const std::size_t words = bytes_.front() + std::size_t{1};
  if (bytes_.size() < 1 + 2 * words + 2) return state_;
  for (std::size_t i = 0; i < words; ++i) frame_.words.push_back(wordAt(bytes_, 1 + 2 * i));
  state_ =
      wordAt(bytes_, 1 + 2 * words) == eposChecksum(EposProtocol::V1, frame_) ? State::Whole : State::Damaged;
  return state_;
}

void EposStreamReader::clear() {
  inside_ = marked_ = false;
  bytes_.clear();
}

void EposStreamReader::finish(std::vector<Item>& items) {
  EposFrame frame{bytes_[0], {}};
  const std::size_t words = bytes_[1];
  for (std::size_t i = 0; i < words; ++i) frame.words.push_back(wordAt(bytes_, 2 + 2 * i));
  if (wordAt(bytes_, 2 + 2 * words) == eposChecksum(protocol_, frame))
    items.emplace_back(std::move(frame));
  else
    items.emplace_back(Damaged{});
  inside_ = false;
  bytes_.clear();
}

void EposStreamReader::push(std::span<const Byte> bytes, std::vector<Item>& items) {
  for (const Byte byte : bytes) {
    if (marked_) {
      marked_ = false;
      if (byte == kBegin || (byte != kMark && inside_)) {
        // A new frame, or something that cannot stand inside of one.
        if (inside_) items.emplace_back(Damaged{});
        bytes_.clear();
        inside_ = byte == kBegin;
        continue;
      }
      if (byte != kMark) continue;
      if (!inside_) {
        // Of two marks in noise the second may be the one that begins a frame.
        marked_ = true;
        continue;
      }
    } else if (byte == kMark) {
      marked_ = true;
      continue;
    }
    if (!inside_) continue;
    bytes_.push_back(byte);
    if (bytes_.size() >= 2 && bytes_.size() == 4 + 2 * static_cast<std::size_t>(bytes_[1])) finish(items);
  }
}

}  // namespace tiltmap
