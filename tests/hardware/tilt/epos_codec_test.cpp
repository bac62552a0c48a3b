#include "hardware/tilt/epos_codec.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

ByteVector bytes(std::string_view hex) {
  const auto parsed = parseHex(hex);
  if (!parsed) throw std::invalid_argument(std::string(hex));
  return *parsed;
}

EposFrame bodyOf(const ByteVector& whole) {
  EposBodyReader reader(whole.front());
  for (std::size_t i = 1; i < whole.size(); ++i) {
    EXPECT_EQ(reader.state(), EposBodyReader::State::Unfinished);
    reader.push(whole[i]);
  }
  EXPECT_EQ(reader.state(), EposBodyReader::State::Whole) << hexText(whole);
  return reader.frame();
}

std::vector<EposStreamReader::Item> itemsOf(std::span<const Byte> stream, std::size_t piece = 1000) {
  EposStreamReader reader;
  std::vector<EposStreamReader::Item> items;
  for (std::size_t at = 0; at < stream.size(); at += piece)
    reader.push(stream.subspan(at, std::min(piece, stream.size() - at)), items);
  return items;
}

EposFrame frameOf(const ByteVector& whole) {
  const auto items = itemsOf(whole);
  EXPECT_EQ(items.size(), 1U) << hexText(whole);
  if (items.empty() || !std::holds_alternative<EposFrame>(items.front())) return {};
  return std::get<EposFrame>(items.front());
}

// Version 1 goes back to an acknowledge that was seen from a real EPOS2, version 2 to two vectors of the
// maker's manual; the single lines are computed.
struct RequestVector {
  EposRequest request;
  const char* v1;
  const char* v2;
};
const RequestVector kRequests[] = {
    {{true, 0x6040, 0, 0x0006, 1},
     "11 03 40 60 00 01 06 00 00 00 C3 71",
     "90 02 68 04 01 40 60 00 06 00 00 00 22 99"},
    {{true, 0x6040, 0, 0x0007, 1},
     "11 03 40 60 00 01 07 00 00 00 F3 46",
     "90 02 68 04 01 40 60 00 07 00 00 00 12 AE"},
    {{true, 0x6040, 0, 0x000F, 1},
     "11 03 40 60 00 01 0F 00 00 00 52 EF",
     "90 02 68 04 01 40 60 00 0F 00 00 00 B3 07"},
    {{true, 0x6040, 0, 0x0000, 1},
     "11 03 40 60 00 01 00 00 00 00 63 C3",
     "90 02 68 04 01 40 60 00 00 00 00 00 82 2B"},
    {{true, 0x6040, 0, 0x0080, 1},
     "11 03 40 60 00 01 80 00 00 00 39 F8",
     "90 02 68 04 01 40 60 00 80 00 00 00 D8 10"},
    {{true, 0x6060, 0, 1, 1},
     "11 03 60 60 00 01 01 00 00 00 A5 9A",
     "90 02 68 04 01 60 60 00 01 00 00 00 DA 67"},
    {{true, 0x6060, 0, 6, 1},
     "11 03 60 60 00 01 06 00 00 00 35 1F",
     "90 02 68 04 01 60 60 00 06 00 00 00 4A E2"},
    {{true, 0x6081, 0, 1000, 1},
     "11 03 81 60 00 01 E8 03 00 00 5B 9F",
     "90 02 68 04 01 81 60 00 E8 03 00 00 4C F5"},
    {{true, 0x6083, 0, 10000, 1},
     "11 03 83 60 00 01 10 27 00 00 F4 48",
     "90 02 68 04 01 83 60 00 10 27 00 00 A6 CD"},
    {{true, 0x6084, 0, 10000, 1},
     "11 03 84 60 00 01 10 27 00 00 B0 51",
     "90 02 68 04 01 84 60 00 10 27 00 00 BE 0A"},
    {{true, 0x6086, 0, 0, 1},
     "11 03 86 60 00 01 00 00 00 00 53 14",
     "90 02 68 04 01 86 60 00 00 00 00 00 18 A0"},
    {{true, 0x6065, 0, 2000, 1},
     "11 03 65 60 00 01 D0 07 00 00 8B E0",
     "90 02 68 04 01 65 60 00 D0 07 00 00 ED 2C"},
    {{true, 0x607A, 0, 100000, 1},
     "11 03 7A 60 00 01 A0 86 01 00 BC 3E",
     "90 02 68 04 01 7A 60 00 A0 86 01 00 3E AB"},
    {{true, 0x607A, 0, 6945, 1},
     "11 03 7A 60 00 01 21 1B 00 00 EE DD",
     "90 02 68 04 01 7A 60 00 21 1B 00 00 6C 48"},
    {{true, 0x607A, 0, static_cast<std::uint32_t>(-6945), 1},
     "11 03 7A 60 00 01 DF E4 FF FF 11 73",
     "90 02 68 04 01 7A 60 00 DF E4 FF FF 93 E6"},
    {{true, 0x6040, 0, 0x003F, 1},
     "11 03 40 60 00 01 3F 00 00 00 F7 2A",
     "90 02 68 04 01 40 60 00 3F 00 00 00 16 C2"},
    {{true, 0x6040, 0, 0x007F, 1},
     "11 03 40 60 00 01 7F 00 00 00 5A 37",
     "90 02 68 04 01 40 60 00 7F 00 00 00 BB DF"},
    {{true, 0x6040, 0, 0x010F, 1},
     "11 03 40 60 00 01 0F 01 00 00 E6 99",
     "90 02 68 04 01 40 60 00 0F 01 00 00 07 71"},
    {{true, 0x6098, 0, 35, 1},
     "11 03 98 60 00 01 23 00 00 00 36 CE",
     "90 02 68 04 01 98 60 00 23 00 00 00 2B DC"},
    {{true, 0x607C, 0, 0, 1},
     "11 03 7C 60 00 01 00 00 00 00 85 C8",
     "90 02 68 04 01 7C 60 00 00 00 00 00 E9 7C"},
    {{true, 0x6099, 1, 100, 1},
     "11 03 99 60 01 01 64 00 00 00 3B 44",
     "90 02 68 04 01 99 60 01 64 00 00 00 65 46"},
    {{true, 0x6099, 2, 10, 1},
     "11 03 99 60 02 01 0A 00 00 00 83 2A",
     "90 02 68 04 01 99 60 02 0A 00 00 00 EF 08"},
    {{true, 0x609A, 0, 1000, 1},
     "11 03 9A 60 00 01 E8 03 00 00 0F E3",
     "90 02 68 04 01 9A 60 00 E8 03 00 00 57 1E"},
    {{true, 0x6040, 0, 0x001F, 1},
     "11 03 40 60 00 01 1F 00 00 00 31 AC",
     "90 02 68 04 01 40 60 00 1F 00 00 00 D0 44"},
    {{false, 0x6041, 0, 0, 1}, "10 01 41 60 00 01 AB F0", "90 02 60 02 01 41 60 00 22 D1"},
    {{false, 0x6064, 0, 0, 1}, "10 01 64 60 00 01 9D 9D", "90 02 60 02 01 64 60 00 29 5A"},
};
struct AnswerVector {
  EposAnswer answer;
  const char* v1;
  const char* v2;
};
const AnswerVector kAnswers[] = {
    {{0, std::nullopt}, "00 01 00 00 00 00 51 AA", "90 02 00 02 00 00 00 00 40 8B"},
    {{0, static_cast<std::uint32_t>(100000)},
     "00 03 00 00 00 00 A0 86 01 00 58 7A",
     "90 02 00 04 00 00 00 00 A0 86 01 00 29 FA"},
    {{0, static_cast<std::uint32_t>(-6945)},
     "00 03 00 00 00 00 DF E4 FF FF F5 37",
     "90 02 00 04 00 00 00 00 DF E4 FF FF 84 B7"},
    {{0, 0x0637}, "00 03 00 00 00 00 37 06 00 00 E8 4A", "90 02 00 04 00 00 00 00 37 06 00 00 99 CA"},
    {{0, 0x1637}, "00 03 00 00 00 00 37 16 00 00 4F 51", "90 02 00 04 00 00 00 00 37 16 00 00 3E D1"},
    {{0, 0x0008}, "00 03 00 00 00 00 08 00 00 00 E5 84", "90 02 00 04 00 00 00 00 08 00 00 00 94 04"},
    {{0x06020000, std::nullopt}, "00 01 00 00 02 06 B5 20", "90 02 00 02 00 00 02 06 A4 01"},
};

TEST(EposCodec, EveryRequestBothWays) {
  for (const RequestVector& vector : kRequests) {
    const auto v1 = encodeEpos(EposProtocol::V1, eposFrame(EposProtocol::V1, vector.request));
    EXPECT_EQ(hexText(v1), vector.v1);
    EXPECT_EQ(eposRequest(EposProtocol::V1, bodyOf(bytes(vector.v1))), vector.request) << vector.v1;
    const auto v2 = encodeEpos(EposProtocol::V2, eposFrame(EposProtocol::V2, vector.request));
    EXPECT_EQ(hexText(v2), vector.v2);
    EXPECT_EQ(eposRequest(EposProtocol::V2, frameOf(bytes(vector.v2))), vector.request) << vector.v2;
  }
}

TEST(EposCodec, EveryAnswerBothWays) {
  for (const AnswerVector& vector : kAnswers) {
    EXPECT_EQ(hexText(encodeEpos(EposProtocol::V1, eposFrame(vector.answer))), vector.v1);
    EXPECT_EQ(eposAnswer(bodyOf(bytes(vector.v1))), vector.answer) << vector.v1;
    EXPECT_EQ(hexText(encodeEpos(EposProtocol::V2, eposFrame(vector.answer))), vector.v2);
    EXPECT_EQ(eposAnswer(frameOf(bytes(vector.v2))), vector.answer) << vector.v2;
  }
}

// An EPOS2 over USB: codes and layout of version 1 in frames of version 2.
TEST(EposCodec, TheUsbPortOfAnEpos2) {
  const EposRequest request{false, 0x6041, 0, 0, 1};
  const char* hex = "90 02 10 02 41 60 00 01 64 CF";
  EXPECT_EQ(hexText(encodeEpos(EposProtocol::V2Usb, eposFrame(EposProtocol::V2Usb, request))), hex);
  EXPECT_EQ(eposRequest(EposProtocol::V2Usb, frameOf(bytes(hex))), request);
  EXPECT_FALSE(eposRequest(EposProtocol::V2, frameOf(bytes(hex)))) << "an EPOS4 does not know it";
}

// Both of the maker's manual; the answer shows the mark within a frame sent twice.
TEST(EposCodec, TheManualsOwnExamples) {
  const EposRequest request{false, 0x30B0, 0, 0, 1};
  const char* asked = "90 02 60 02 01 B0 30 00 2E 62";
  const char* answered = "90 02 00 04 00 00 00 00 01 90 90 00 00 9A 5C";
  EXPECT_EQ(hexText(encodeEpos(EposProtocol::V2, eposFrame(EposProtocol::V2, request))), asked);
  EXPECT_EQ(eposRequest(EposProtocol::V2, frameOf(bytes(asked))), request);
  const EposAnswer answer{0, 0x00009001};
  EXPECT_EQ(hexText(encodeEpos(EposProtocol::V2, eposFrame(answer))), answered);
  EXPECT_EQ(eposAnswer(frameOf(bytes(answered))), answer);
}

TEST(EposCodec, WhatIsNoRequestIsNone) {
  EXPECT_FALSE(eposRequest(EposProtocol::V1, {0x10, {1, 2, 3}}));
  EXPECT_FALSE(eposRequest(EposProtocol::V1, {0x11, {1, 2}}));
  EXPECT_FALSE(eposRequest(EposProtocol::V1, {0x60, {1, 2}}));
  EXPECT_FALSE(eposRequest(EposProtocol::V2, {0x10, {1, 2}}));
  EXPECT_FALSE(eposAnswer({0x01, {0, 0}}));
  EXPECT_FALSE(eposAnswer({0x00, {0}}));
  EXPECT_FALSE(eposAnswer({0x00, {0, 0, 0}}));
}

TEST(EposCodec, ABodyThatIsDamagedIsSeen) {
  const ByteVector whole = bytes("00 03 00 00 00 00 37 06 00 00 E8 4A");
  // Not the length: with another one the frame ends elsewhere.
  for (std::size_t i = 2; i < whole.size(); ++i) {
    EposBodyReader reader(0);
    for (std::size_t k = 1; k < whole.size(); ++k)
      reader.push(k == i ? static_cast<Byte>(whole[k] ^ 0x10) : whole[k]);
    EXPECT_EQ(reader.state(), EposBodyReader::State::Damaged) << i;
  }
}

TEST(EposCodec, LengthsThatDoNotFitAreABrokenContract) {
  EXPECT_THROW(encodeEpos(EposProtocol::V1, {0x10, {}}), std::invalid_argument);
  EXPECT_THROW(encodeEpos(EposProtocol::V2, {0x60, std::vector<std::uint16_t>(256)}), std::invalid_argument);
  EXPECT_NO_THROW(encodeEpos(EposProtocol::V1, {0x10, std::vector<std::uint16_t>(256)}));
}

// Any frames, cut anywhere, noise between them: every one is found, whatever stands before it.
TEST(EposCodec, FramesAreFoundAfterAnyNoise) {
  RandomStream random(7);
  for (int round = 0; round < 300; ++round) {
    std::vector<EposFrame> sent;
    ByteVector wire;
    for (int i = 0; i < 5; ++i) {
      for (std::uint64_t k = random.below(6); k > 0; --k) {
        // Noise of which the half are marks.
        wire.push_back(random.below(2) ? 0x90 : static_cast<Byte>(random.below(256)));
      }
      // A mark at the end of noise would be taken as the frame's first half of "90 90".
      if (!wire.empty() && wire.back() == 0x90) wire.push_back(0x00);
      EposFrame frame{static_cast<Byte>(random.below(256)), {}};
      for (std::uint64_t k = random.below(5); k > 0; --k)
        frame.words.push_back(static_cast<std::uint16_t>(random.below(3) ? random.below(65536) : 0x9090));
      const ByteVector encoded = encodeEpos(EposProtocol::V2, frame);
      wire.insert(wire.end(), encoded.begin(), encoded.end());
      sent.push_back(std::move(frame));
    }
    std::vector<EposFrame> found;
    for (const auto& item : itemsOf(wire, 1 + random.below(9)))
      if (const auto* frame = std::get_if<EposFrame>(&item)) found.push_back(*frame);
    EXPECT_EQ(found, sent) << hexText(wire);
  }
}

TEST(EposCodec, ACutFrameDoesNotSwallowTheNext) {
  ByteVector wire = bytes("90 02 00 04 00 00 00");
  const ByteVector next = bytes("90 02 00 02 00 00 00 00 40 8B");
  wire.insert(wire.end(), next.begin(), next.end());
  const auto items = itemsOf(wire);
  ASSERT_EQ(items.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<EposStreamReader::Damaged>(items[0]));
  EXPECT_EQ(std::get<EposFrame>(items[1]), (EposFrame{0, {0, 0}}));
}

TEST(EposCodec, AbortsAreExplained) {
  EXPECT_NE(eposAbortText(0x06020000).find("no such object"), std::string::npos);
  EXPECT_NE(eposAbortText(0x08000022).find("state"), std::string::npos);
  EXPECT_NE(eposAbortText(0x12345678).find("12345678"), std::string::npos);
}

TEST(EposCodec, ProtocolsHaveNames) {
  for (const EposProtocol protocol : {EposProtocol::V1, EposProtocol::V2, EposProtocol::V2Usb})
    EXPECT_EQ(eposProtocolNamed(eposProtocolName(protocol)), protocol);
  EXPECT_FALSE(eposProtocolNamed("v3"));
}

}  // namespace
}  // namespace tiltmap
