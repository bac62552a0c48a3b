#include "hardware/cola/cola_codec.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

using namespace cola;

ByteVector bytes(std::string_view hex) {
  const auto parsed = parseHex(hex);
  if (!parsed) throw std::invalid_argument(std::string(hex));
  return *parsed;
}

std::vector<Reader::Item> itemsOf(std::span<const Byte> stream, std::size_t piece = 100000) {
  Reader reader;
  std::vector<Reader::Item> items;
  for (std::size_t at = 0; at < stream.size(); at += piece)
    reader.push(stream.subspan(at, std::min(piece, stream.size() - at)), items);
  return items;
}

struct Vector {
  Telegram telegram;
  const char* hex;
};
const Vector kVectors[] = {
    {{Dialect::A, "sRN LMDscandata"}, "02 73 52 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 03"},
    {{Dialect::B, "sRN LMDscandata"},
     "02 02 02 02 00 00 00 0F 73 52 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 05"},
    {{Dialect::A, "sMN SetAccessMode 03 F4724744"},
     "02 73 4D 4E 20 53 65 74 41 63 63 65 73 73 4D 6F 64 65 20 30 33 20 46 34 37 32 34 37 34 34 03"},
    {{Dialect::B, std::string("sMN SetAccessMode \x03\xF4\x72\x47\x44")},
     "02 02 02 02 00 00 00 17 73 4D 4E 20 53 65 74 41 63 63 65 73 73 4D 6F 64 65 20 03 F4 72 47 44 B3"},
    {{Dialect::B, std::string("sEN LMDscandata \x01")},
     "02 02 02 02 00 00 00 11 73 45 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 20 01 33"},
    {{Dialect::B, std::string("sEN LMDscandata \0", 17)},
     "02 02 02 02 00 00 00 11 73 45 4E 20 4C 4D 44 73 63 61 6E 64 61 74 61 20 00 32"},
    {{Dialect::B, "sMN LMCstartmeas"},
     "02 02 02 02 00 00 00 10 73 4D 4E 20 4C 4D 43 73 74 61 72 74 6D 65 61 73 68"},
    {{Dialect::B, "sMN Run"}, "02 02 02 02 00 00 00 07 73 4D 4E 20 52 75 6E 19"},
    {{Dialect::A, "sRN STlms"}, "02 73 52 4E 20 53 54 6C 6D 73 03"},
};

TEST(ColaCodec, EveryTelegramBothWays) {
  for (const Vector& vector : kVectors) {
    EXPECT_EQ(hexText(encode(vector.telegram)), vector.hex);
    EXPECT_EQ(itemsOf(bytes(vector.hex)), (std::vector<Reader::Item>{vector.telegram})) << vector.hex;
    EXPECT_EQ(itemsOf(bytes(vector.hex), 1), (std::vector<Reader::Item>{vector.telegram})) << vector.hex;
  }
}

constexpr const char* kThreePoints =
    "sSN LMDscandata 1 1 89A27F 0 0 3 3 27477BA9 2747813B 0 0 7 0 0 1388 168 0 1 DIST1 3F800000 00000000 "
    "186A0 1388 3 3E8 3E9 3EA 0 0 0 0 0 0";

TEST(ColaCodec, AScanBothWays) {
  const auto scan = parseScan(kThreePoints);
  ASSERT_TRUE(scan) << scan.error().what << scan.error().where;
  EXPECT_EQ(scan->serial, 0x89A27FU);
  EXPECT_EQ(scan->telegrams, 3U);
  EXPECT_EQ(scan->measured_us, 0x27477BA9U);
  EXPECT_EQ(scan->sent_us, 0x2747813BU);
  EXPECT_EQ(scan->outputs_high, 7U);
  EXPECT_EQ(scan->frequency_chz, 5000U);
  EXPECT_TRUE(scan->encoders.empty());
  ASSERT_EQ(scan->channels16.size(), 1U);
  const Channel& distances = scan->channels16.front();
  EXPECT_EQ(distances.name, "DIST1");
  EXPECT_EQ(distances.scale, 1.0F);
  EXPECT_EQ(distances.start, 100000);
  EXPECT_EQ(distances.step, 5000U);
  EXPECT_EQ(distances.values, (std::vector<std::uint16_t>{1000, 1001, 1002}));
  EXPECT_TRUE(scan->channels8.empty());
  EXPECT_EQ(scan->rest.size(), 5U);
  EXPECT_EQ(scanText(*scan), kThreePoints);
  EXPECT_EQ(scan->channel("RSSI1"), nullptr);
}

TEST(ColaCodec, AScanWithEverythingBothWays) {
  cola::Scan scan;
  scan.asked = true;
  scan.status_low = kDirty;
  scan.encoders = {{1000, -5}, {7, 8}};
  scan.channels16 = {{"DIST1", 2.0F, 0.0F, -450000, 2500, {0, 1, 15, 16, 65535}},
                     {"RSSI1", 1.0F, -0.5F, -450000, 2500, {1, 2, 3, 4, 5}}};
  scan.channels8 = {{"RSSI2", 1.0F, 0.0F, -450000, 2500, {255, 0, 1, 2, 3}}};
  scan.rest = {"0", "1", "4", "name", "0", "0", "0"};
  const std::string text = scanText(scan);
  EXPECT_NE(text.find(" FFF92230 9C4 5 "), std::string::npos) << text;
  EXPECT_NE(text.find(" 40000000 "), std::string::npos) << text;
  const auto again = parseScan(text);
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, scan);
  EXPECT_EQ(again->channel("RSSI2")->values.front(), 255);
}

TEST(ColaCodec, AScanThatEndsEarlyIsRefusedWhereverItEnds) {
  const std::string whole = kThreePoints;
  const std::size_t channels_end = whole.find(" 0 0 0 0 0 0");
  for (std::size_t end = 0; end < channels_end; ++end) {
    const auto scan = parseScan(std::string_view(whole).substr(0, end));
    if (!scan) continue;
    // Cut within a number it may still be one; the values then are as many as were told.
    ADD_FAILURE() << end;
  }
  EXPECT_FALSE(
      parseScan("sSN LMDscandata 1 1 89A27F 0 0 3 3 27477BA9 2747813B 0 0 7 0 0 1388 168 0 FFFFFFFF"));
  EXPECT_FALSE(parseScan("sAN SetAccessMode 1"));
  EXPECT_FALSE(parseScan(""));
}

TEST(ColaCodec, NumbersAreHexadecimalOrSigned) {
  EXPECT_EQ(number("1388"), 5000U);
  EXPECT_EQ(number("+5000"), 5000U);
  EXPECT_EQ(signedNumber("-450000"), -450000);
  EXPECT_EQ(signedNumber("FFF92230"), -450000);
  EXPECT_EQ(signedNumber("FFFF3CB0"), -50000);
  EXPECT_EQ(signedNumber("225510"), 2250000);
  for (const char* text : {"", "+", "-", "G", "1 ", " 1", "123456789", "+99999999999", "--5", "+-5", "0x1"})
    EXPECT_FALSE(number(text)) << text;
  EXPECT_EQ(realNumber("3F800000"), 1.0F);
  EXPECT_EQ(realNumber("40000000"), 2.0F);
  EXPECT_EQ(hexReal(2.0F), "40000000");
  EXPECT_EQ(hexReal(0.0F), "00000000");
  EXPECT_FALSE(realNumber("7F800000")) << "infinite";
  EXPECT_FALSE(realNumber("7FC00000")) << "not a number";
  EXPECT_FALSE(realNumber("+1"));
}

TEST(ColaCodec, SettingsBothWays) {
  const ScanSetting setting{2500, 2500, -450000, 2250000};
  EXPECT_EQ(settingRequest(setting), "sMN mLMPsetscancfg +2500 +1 +2500 -450000 +2250000");
  EXPECT_EQ(requestedSetting(settingRequest(setting)), setting);
  EXPECT_EQ(settingWords(setting), "9C4 1 9C4 FFF92230 225510");
  EXPECT_EQ(*parseSetting({"9C4", "1", "9C4", "FFF92230", "225510"}), setting);
  EXPECT_FALSE(parseSetting({"9C4", "1"}));
  EXPECT_FALSE(parseSetting({"9C4", "1", "x", "0", "0"}));
  EXPECT_FALSE(requestedSetting("sMN Run"));
}

TEST(ColaCodec, TelegramsAreFoundAfterAnyNoiseHoweverTheyCome) {
  RandomStream random(11);
  for (int round = 0; round < 200; ++round) {
    std::vector<Telegram> sent;
    ByteVector wire;
    for (int i = 0; i < 5; ++i) {
      for (std::uint64_t k = random.below(8); k > 0; --k)
        wire.push_back(static_cast<Byte>(3 + random.below(253)));  // no beginning
      Telegram telegram{random.below(2) ? Dialect::A : Dialect::B, "s"};
      for (std::uint64_t k = random.below(30); k > 0; --k)
        telegram.text +=
            static_cast<char>(telegram.dialect == Dialect::A ? 32 + random.below(90) : random.below(256));
      const ByteVector encoded = encode(telegram);
      wire.insert(wire.end(), encoded.begin(), encoded.end());
      sent.push_back(std::move(telegram));
    }
    std::vector<Telegram> found;
    for (const auto& item : itemsOf(wire, 1 + random.below(9)))
      if (const auto* telegram = std::get_if<Telegram>(&item)) found.push_back(*telegram);
    EXPECT_EQ(found, sent);
  }
}

TEST(ColaCodec, ACutTelegramDoesNotSwallowTheNext) {
  ByteVector wire = bytes("02 73 52 41 20 53 54");
  const ByteVector next = encode({Dialect::A, "sRN STlms"});
  wire.insert(wire.end(), next.begin(), next.end());
  const auto items = itemsOf(wire);
  ASSERT_EQ(items.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<Reader::Damaged>(items[0]));
  EXPECT_EQ(std::get<Telegram>(items[1]).text, "sRN STlms");
}

TEST(ColaCodec, WhatIsTooLongOrWrongIsDamaged) {
  EXPECT_EQ(itemsOf(bytes("02 02 02 02 00 00 00 07 73 4D 4E 20 52 75 6E 18")),
            std::vector<Reader::Item>{Reader::Damaged{}});
  EXPECT_EQ(itemsOf(bytes("02 02 02 02 7F 00 00 07")), std::vector<Reader::Item>{Reader::Damaged{}});
  ByteVector endless(Reader::kLongest + 10, 'x');
  endless.front() = 2;
  EXPECT_EQ(itemsOf(endless), std::vector<Reader::Item>{Reader::Damaged{}});
  EXPECT_THROW(encode({Dialect::A, "a\x03"}), std::invalid_argument);
}

TEST(ColaCodec, ErrorsAreExplained) {
  EXPECT_NE(errorText(1).find("access"), std::string::npos);
  EXPECT_NE(errorText(3).find("variable"), std::string::npos);
  EXPECT_NE(errorText(99).find("99"), std::string::npos);
}

}  // namespace
}  // namespace tiltmap
