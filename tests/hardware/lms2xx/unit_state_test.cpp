#include "hardware/lms2xx/unit_state.h"

#include <gtest/gtest.h>

#include "hardware/lms2xx/framer.h"

namespace tiltmap::lms2xx {
namespace {

Telegram telegramOf(const std::string& text) {
  Framer framer;
  framer.push(parseHex(text).value());
  const auto token = framer.next();
  if (!token || !std::holds_alternative<Telegram>(*token)) return {};
  return std::get<Telegram>(*token);
}

std::string zeros(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "00 ";
  return text;
}

// V02.30, on request, 180 degrees with 0.5, centimetres; the rate's code and the checksum differ.
std::string statusText(const std::string& baud, const std::string& checksum) {
  return "02 80 9A 00 B1 56 30 32 2E 33 30 20 25 " + zeros(58) + "94 00 " + zeros(38) +
         "B4 00 32 00 02 02 00 00 00 " + baud + " 02 00 00 01 00 01 56 30 31 2E 32 37 20 " + zeros(22) +
         "10 " + checksum;
}

TEST(UnitStatus, ThePrintedTelegramBothWays) {
  for (const auto& [baud, code, checksum] : std::vector<std::tuple<int, std::string, std::string>>{
           {9600, "67 80", "8B 57"}, {38400, "19 80", "CE 95"}}) {
    const std::string text = statusText(code, checksum);
    const Telegram telegram = telegramOf(text);
    ASSERT_EQ(telegram.wireSize(), 160U) << text;
    const auto status = parseStatus(telegram);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->version, "V02.30");
    EXPECT_EQ(status->mode, mode::kOnRequest);
    EXPECT_EQ(status->baud, baud);
    EXPECT_EQ(status->motor_us, 148);
    EXPECT_EQ(status->variant, (Variant{180, 50}));
    EXPECT_EQ(status->unit, Unit::Centimetre);
    EXPECT_TRUE(status->laser_on);
    EXPECT_FALSE(status->keeps_rate);
    EXPECT_FALSE(status->defective);
    EXPECT_EQ(status->boot_version, "V01.27");
    EXPECT_EQ(hexText(encodeAnswer(0xB1, statusData(*status), 0x10)), hexText(parseHex(text).value()));
    // Without what was sent the named fields still make the same telegram, but for two that have no name.
    UnitStatus bare = *status;
    bare.raw.clear();
    const ByteVector made = statusData(bare);
    ASSERT_EQ(made.size(), status->raw.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < made.size(); ++i) different += made[i] != status->raw[i];
    EXPECT_LE(different, 4U);
  }
}

TEST(UnitStatus, EveryFieldIsKept) {
  UnitStatus status;
  status.version = "V01.02";
  status.mode = mode::kStream;
  status.defective = true;
  for (std::size_t i = 0; i < 8; ++i) status.pollution[i] = static_cast<std::uint16_t>(1000 + i);
  for (std::size_t i = 0; i < 4; ++i) status.reference_pollution[i] = static_cast<std::uint16_t>(2000 + i);
  status.motor_us = 150;
  status.measuring_mode = MeasuringMode::Reflector8;
  status.variant = {100, 25};
  status.baud = 500000;
  status.keeps_rate = true;
  status.address = 5;
  status.unit = Unit::Millimetre;
  status.laser_on = true;
  status.boot_version = "V09.99";
  const auto again = parseStatus(Telegram{0x80, [&] {
                                            ByteVector payload{0xB1};
                                            const ByteVector data = statusData(status);
                                            payload.insert(payload.end(), data.begin(), data.end());
                                            payload.push_back(0x10);
                                            return payload;
                                          }()});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->version, status.version);
  EXPECT_EQ(again->mode, status.mode);
  EXPECT_TRUE(again->defective);
  EXPECT_EQ(again->pollution, status.pollution);
  EXPECT_EQ(again->reference_pollution, status.reference_pollution);
  EXPECT_EQ(again->motor_us, 150);
  EXPECT_EQ(again->measuring_mode, MeasuringMode::Reflector8);
  EXPECT_EQ(again->variant, status.variant);
  EXPECT_EQ(again->baud, 500000);
  EXPECT_TRUE(again->keeps_rate);
  EXPECT_EQ(again->address, 5);
  EXPECT_EQ(again->unit, Unit::Millimetre);
  EXPECT_EQ(again->boot_version, "V09.99");
  EXPECT_FALSE(parseStatus(Telegram{0x80, ByteVector(100, 0xB1)})) << "too short";
}

TEST(StatusByte, WarnsOfWhatTheOperatorCanDoSomethingAbout) {
  EXPECT_TRUE(warningsOf({0x10}).empty());
  EXPECT_TRUE(warningsOf({0x11}).empty()) << "information";
  ASSERT_EQ(warningsOf({0x90}).size(), 1U);
  EXPECT_NE(warningsOf({0x90})[0].find("window is dirty"), std::string::npos);
  EXPECT_EQ(warningsOf({0xD4}).size(), 3U);
  EXPECT_NE(warningsOf({0x13})[0].find("an error"), std::string::npos);
  EXPECT_TRUE((StatusByte{0x30}).restartInput());
}

TEST(UnitType, PartsBetweenSemicolons) {
  const Telegram answer =
      telegramOf("02 80 17 00 BA 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 22 61");
  const UnitType type = parseType(answer.data());
  EXPECT_EQ(type.text, "LMS200;301063;V02.10");
  EXPECT_EQ(type.model, "LMS200");
  EXPECT_EQ(type.variant, "301063");
  EXPECT_EQ(type.version, "V02.10");
  EXPECT_FALSE(type.sendsReflectivity());
  const ByteVector s14{'L', 'M', 'S', '2', '9', '1', ';', 'S', '1', '4', 0, 0xFF};
  EXPECT_TRUE(parseType(s14).sendsReflectivity());
  EXPECT_EQ(parseType(s14).version, "");
  EXPECT_EQ(parseType({}).model, "");
}

TEST(Configuration, ReadWrittenAndRefused) {
  const std::string block =
      "00 00 46 00 00 00 00 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 0A 0A 50 64 00 00 00 00 02 "
      "00 ";
  const auto read = parseConfiguration(telegramOf("02 80 24 00 F4 " + block + "10 AA 4F"));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, Configuration::factory());
  EXPECT_EQ(read->unit(), Unit::Centimetre);
  EXPECT_FALSE(read->sendsIndices());
  EXPECT_EQ(read->measuringMode(), MeasuringMode::FieldsAbDazzle);
  EXPECT_EQ(hexText(encodeAnswer(0xF4, read->block(), 0x10)), "02 80 24 00 F4 " + block + "10 AA 4F");

  const auto accepted = parseWriteAnswer(telegramOf("02 80 25 00 F7 01 " + block + "10 53 CE"));
  ASSERT_TRUE(accepted);
  EXPECT_TRUE(accepted->accepted);
  EXPECT_EQ(accepted->in_force, *read);
  const auto refused = parseWriteAnswer(telegramOf("02 80 25 00 F7 00 " + block + "10 F3 9E"));
  ASSERT_TRUE(refused);
  EXPECT_FALSE(refused->accepted);
  EXPECT_EQ(refused->in_force, *read) << "a refusal tells what stays in force";
  EXPECT_FALSE(parseWriteAnswer(telegramOf("02 80 02 00 92 10 7F 33")));
  EXPECT_FALSE(parseConfiguration(telegramOf("02 80 03 00 A0 00 10 16 0A")));
}

TEST(Variant, AnswerTellsWhatIsInForce) {
  const auto accepted = parseVariantAnswer(telegramOf("02 80 07 00 BB 01 B4 00 32 00 10 03 9D"));
  ASSERT_TRUE(accepted);
  EXPECT_TRUE(accepted->accepted);
  EXPECT_EQ(accepted->in_force, (Variant{180, 50}));
  const auto refused = parseVariantAnswer(telegramOf("02 80 07 00 BB 00 B4 00 32 00 10 23 8D"));
  ASSERT_TRUE(refused);
  EXPECT_FALSE(refused->accepted);
  EXPECT_FALSE(parseVariantAnswer(telegramOf("02 80 03 00 A0 00 10 16 0A")));
}

TEST(StoredErrors, PairsOfTypeAndNumber) {
  EXPECT_TRUE(parseErrors(telegramOf("02 80 02 00 B2 10 3F 13")).empty());
  const auto errors = parseErrors(Telegram{0x80, {0xB2, 3, 17, 2, 5, 0x13}});
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[1].type, 2);
  EXPECT_EQ(errors[1].number, 5);
}

}  // namespace
}  // namespace tiltmap::lms2xx
