// Any bytes, as frames of an EPOS in either protocol, as requests and as answers.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "hardware/tilt/epos_codec.h"

namespace {

using namespace tiltmap;

void require(bool held) {
  if (!held) std::abort();
}

std::vector<EposStreamReader::Item> itemsOf(EposProtocol protocol, std::span<const Byte> bytes,
                                            std::size_t piece) {
  EposStreamReader reader(protocol);
  std::vector<EposStreamReader::Item> items;
  for (std::size_t at = 0; at < bytes.size(); at += piece)
    reader.push(bytes.subspan(at, std::min(piece, bytes.size() - at)), items);
  reader.clear();
  return items;
}

// What a frame means, said again, is the same frame.
void meaning(EposProtocol protocol, const EposFrame& frame) {
  if (const auto request = eposRequest(protocol, frame)) require(eposFrame(protocol, *request) == frame);
  if (const auto answer = eposAnswer(frame)) {
    require(eposFrame(*answer) == frame);
    require(!eposAbortText(answer->error).empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const Byte> bytes(data + 1, size - 1);
  for (const EposProtocol protocol : {EposProtocol::V2, EposProtocol::V2Usb}) {
    const auto items = itemsOf(protocol, bytes, data[0] % 16 + 1U);
    require(items == itemsOf(protocol, bytes, bytes.size()));
    for (const auto& item : items)
      if (const auto* frame = std::get_if<EposFrame>(&item)) {
        meaning(protocol, *frame);
        const auto again = itemsOf(protocol, encodeEpos(protocol, *frame), 1);
        require(again.size() == 1 && again.front() == EposStreamReader::Item(*frame));
      }
  }
  EposBodyReader body(bytes[0]);
  for (const Byte byte : bytes.subspan(1)) body.push(byte);
  if (body.state() == EposBodyReader::State::Whole) {
    meaning(EposProtocol::V1, body.frame());
    const ByteVector again = encodeEpos(EposProtocol::V1, body.frame());
    require(again.size() <= bytes.size() && std::equal(again.begin(), again.end(), bytes.begin()));
  }
  // The bytes as a frame of words, whatever it means.
  EposFrame made{data[0], {}};
  for (std::size_t i = 0; i + 1 < std::min<std::size_t>(bytes.size(), 500); i += 2)
    made.words.push_back(static_cast<std::uint16_t>(bytes[i] | bytes[i + 1] << 8));
  for (const EposProtocol protocol : {EposProtocol::V1, EposProtocol::V2}) {
    meaning(protocol, made);
    if (made.words.empty()) continue;
    const ByteVector encoded = encodeEpos(protocol, made);
    if (protocol == EposProtocol::V1) {
      EposBodyReader reader(encoded.front());
      for (const Byte byte : std::span(encoded).subspan(1)) reader.push(byte);
      require(reader.state() == EposBodyReader::State::Whole && reader.frame() == made);
    } else {
      const auto items = itemsOf(protocol, encoded, 3);
      require(items.size() == 1 && items.front() == EposStreamReader::Item(made));
    }
  }
  const std::string name(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (const auto protocol = eposProtocolNamed(name)) require(eposProtocolName(*protocol) == name);
  return 0;
}
