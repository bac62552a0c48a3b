#include "hardware/scip/scip_codec.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/geometry/pose.h"
#include "hardware/transport/byte_channel.h"

namespace tiltmap {
namespace {

using namespace scip;

std::vector<ReplyReader::Item> itemsOf(std::string_view stream, std::size_t piece = 100000) {
  ReplyReader reader;
  std::vector<ReplyReader::Item> items;
  for (std::size_t at = 0; at < stream.size(); at += piece) reader.push(stream.substr(at, piece), items);
  return items;
}
Reply onlyReply(std::string_view stream) {
  const auto items = itemsOf(stream);
  EXPECT_EQ(items.size(), 1U) << stream;
  if (items.size() != 1 || !std::holds_alternative<Reply>(items[0])) return {};
  return std::get<Reply>(items[0]);
}

TEST(ScipCodec, NumbersBothWays) {
  struct Vector {
    const char* text;
    std::uint32_t value;
  };
  for (const Vector& vector : {Vector{"CB", 1234}, {"1Dh", 5432}, {"m2@0", 16000000}}) {
    EXPECT_EQ(decodeNumber(vector.text), vector.value);
    EXPECT_EQ(encodeNumber(vector.value, static_cast<int>(std::string_view(vector.text).size())),
              vector.text);
  }
  for (const char* text : {"", "C ", "C/", "Cp", "12345"}) EXPECT_FALSE(decodeNumber(text)) << text;
}

TEST(ScipCodec, CheckCharacters) {
  EXPECT_EQ(checkCharacter("00"), 'P');
  EXPECT_EQ(checkCharacter("99"), 'b');
  EXPECT_EQ(checkCharacter("0E"), 'e');
}

TEST(ScipCodec, AnAnswerBothWays) {
  const auto bytes = *parseHex("51 54 0A 30 30 50 0A 0A");
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_EQ(encodeReply({"QT", "00", {}}), text);
  EXPECT_EQ(onlyReply(text), (Reply{"QT", "00", {}}));
  EXPECT_EQ(itemsOf(text, 1), itemsOf(text));
}

TEST(ScipCodec, PropertiesBothWays) {
  // As a scanner of type URG-04LX tells them; the check character stands behind the semicolon.
  const Properties known{{"DMIN", "20"},  {"DMAX", "5600"}, {"AMIN", "44"},
                         {"AMAX", "725"}, {"AFRT", "384"},  {"SCAN", "600"}};
  const std::vector<std::string> lines{"DMIN:20;4",  "DMAX:5600;_", "AMIN:44;7",
                                       "AMAX:725;o", "AFRT:384;6",  "SCAN:600;e"};
  EXPECT_EQ(encodeProperties(known), lines);
  const auto parsed = parseProperties(lines);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(*parsed, known);
  EXPECT_EQ(property(known, "AFRT"), "384");
  EXPECT_EQ(property(known, "ARES"), "");
  // Firmware that counts the semicolon as well.
  const std::string text = "DMIN:20;";
  EXPECT_TRUE(parseProperties({text + checkCharacter(text)}));
  for (const char* line : {"DMIN:20;5", "DMIN:20", "DMIN20;4", "", ";", "DMIN:20;4x"})
    EXPECT_FALSE(parseProperties({line})) << line;
}

TEST(ScipCodec, ParametersSayWhereTheBeamsGo) {
  Parameters urg;
  urg.model = "URG-04LX";
  EXPECT_EQ(urg.columns(), 682);
  // Step 384 looks ahead; the first one 340 steps of 360/1024 deg to the right of it.
  EXPECT_NEAR(urg.azimuthStart() / kDegree, 90.0 - 340 * 360.0 / 1024.0, 1e-9);
  EXPECT_NEAR((urg.azimuthStart() + 340 * urg.azimuthStep()) / kDegree, 90.0, 1e-9);
  const Parameters utm{"UTM-30LX", 23, 60000, 1440, 0, 1080, 540, 2400};
  EXPECT_NEAR(utm.azimuthStart() / kDegree, -45.0, 1e-9);
  EXPECT_NEAR(utm.azimuthStep() / kDegree, 0.25, 1e-9);
  EXPECT_EQ(utm.columns(), 1081);
  for (const Parameters& each : {urg, utm}) {
    const auto again = parseParameters(parameterProperties(each));
    ASSERT_TRUE(again) << again.error().what;
    EXPECT_EQ(*again, each);
  }
  Properties lacking = parameterProperties(urg);
  lacking.pop_back();
  EXPECT_FALSE(parseParameters(lacking));
  for (const auto& [key, value] : {std::pair{"ARES", "0"},
                                   {"SCAN", "0"},
                                   {"AMAX", "20"},
                                   {"AMIN", "-4"},
                                   {"AMAX", "2000"},
                                   {"DMIN", "x"}}) {
    Properties wrong = parameterProperties(urg);
    for (auto& [name, text] : wrong)
      if (name == key) text = value;
    EXPECT_FALSE(parseParameters(wrong)) << key << value;
  }
}

TEST(ScipCodec, OrdersBothWays) {
  const ScanOrder stream{"MD", 44, 725, 1, 0, 0};
  EXPECT_EQ(encodeOrder(stream), "MD0044072501000");
  EXPECT_EQ(parseOrder("MD0044072501000"), stream);
  EXPECT_EQ(parseOrder("GD0044072501"), (ScanOrder{"GD", 44, 725, 1, 0, 0}));
  EXPECT_EQ(parseOrder("ME0000108003207"), (ScanOrder{"ME", 0, 1080, 3, 2, 7}));
  EXPECT_EQ(encodeOrder({"ME", 0, 1080, 3, 2, 7}), "ME0000108003207");
  EXPECT_EQ(encodeOrder({"GS", 1, 2, 1, 0, 0}), "GS0001000201");
  EXPECT_EQ((ScanOrder{"ME", 0, 1080, 3, 2, 7}).values(), 361);
  for (const char* text : {"", "MD", "MD004407250100", "MD00440725010000", "MD00440725010x0",
                           "QT0044072501000", "MD0725004401000", "GD004407250100"})
    EXPECT_FALSE(parseOrder(text)) << text;
}

ScanData dataOf(std::size_t count, bool light, RandomStream& random, std::uint32_t most) {
  ScanData data;
  data.time_ms = static_cast<std::uint32_t>(random.below(1 << 24));
  for (std::size_t i = 0; i < count; ++i) {
    data.values.push_back(static_cast<std::uint32_t>(random.below(most)));
    if (light) data.intensities.push_back(static_cast<std::uint32_t>(random.below(most)));
  }
  return data;
}

TEST(ScipCodec, ScansBothWays) {
  RandomStream random(2);
  for (const ScanOrder& order : {ScanOrder{"MD", 44, 725, 1, 0, 0},
                                 {"MS", 0, 30, 1, 0, 0},
                                 {"ME", 0, 1080, 1, 0, 0},
                                 {"GD", 7, 7, 1, 0, 0},
                                 {"MD", 0, 1080, 4, 0, 0}}) {
    const ScanData data = dataOf(static_cast<std::size_t>(order.values()), order.intensities(), random,
                                 order.characters() == 2 ? 4096 : 262144);
    const auto lines = encodeScan(data, order.characters());
    const auto again = parseScan(lines, order);
    ASSERT_TRUE(again) << again.error().what;
    EXPECT_EQ(*again, data);
    for (std::size_t i = 1; i + 1 < lines.size(); ++i) EXPECT_EQ(lines[i].size(), 65U);
    // Any one character that is another one is seen, and so is a line that is missing.
    for (int round = 0; round < 50; ++round) {
      auto wrong = lines;
      std::string& line = wrong[static_cast<std::size_t>(random.below(wrong.size()))];
      line[static_cast<std::size_t>(random.below(line.size()))] ^= 1;
      EXPECT_FALSE(parseScan(wrong, order));
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      auto wrong = lines;
      wrong.erase(wrong.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_FALSE(parseScan(wrong, order)) << i;
    }
  }
  EXPECT_FALSE(parseScan({}, {}));
  EXPECT_THROW(encodeScan({0, {1, 2}, {1}}, 3), std::invalid_argument);
}

TEST(ScipCodec, AfterNoiseTheNextAnswerButOneIsUnderstood) {
  RandomStream random(4);
  for (int round = 0; round < 200; ++round) {
    std::string wire;
    for (std::uint64_t k = random.below(60); k > 0; --k) wire += static_cast<char>(random.below(256));
    const Reply reply{"MD0044072501000", "99", encodeScan(dataOf(50, false, random, 5000), 3)};
    for (int i = 0; i < 3; ++i) wire += encodeReply(reply);
    std::size_t whole = 0;
    for (const auto& item : itemsOf(wire, 1 + random.below(50)))
      if (const auto* found = std::get_if<Reply>(&item); found && *found == reply) ++whole;
    EXPECT_GE(whole, 2U);
  }
}

TEST(ScipCodec, WhatIsNoAnswerIsDamagedAndTakesNoMemory) {
  for (const char* text : {"QT\n\n", "QT\n00Q\n\n", "QT\n00\n\n", "x\n\n"})
    EXPECT_EQ(itemsOf(text), std::vector<ReplyReader::Item>{ReplyReader::Damaged{}}) << text;
  EXPECT_TRUE(itemsOf("\n\n\n").empty());
  const std::string endless(ReplyReader::kLongest + 500, 'x');
  EXPECT_EQ(itemsOf(endless + "\n\n"), std::vector<ReplyReader::Item>{ReplyReader::Damaged{}});
  std::string many;
  for (int i = 0; i < 30000; ++i) many += "xx\n";
  EXPECT_EQ(itemsOf(many + "\nQT\n00P\n\n"),
            (std::vector<ReplyReader::Item>{ReplyReader::Damaged{}, Reply{"QT", "00", {}}}));
}

TEST(ScipCodec, StatusesAreExplained) {
  EXPECT_NE(statusText("0E").find("command"), std::string::npos);
  EXPECT_NE(statusText("10").find("laser"), std::string::npos);
  EXPECT_NE(statusText("77").find("77"), std::string::npos);
}

}  // namespace
}  // namespace tiltmap
