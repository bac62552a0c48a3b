#include "hardware/lms2xx/measurement.h"

#include <numeric>

#include <gtest/gtest.h>

#include "hardware/lms2xx/framer.h"

namespace tiltmap::lms2xx {
namespace {

Telegram telegramOf(const ByteVector& bytes) {
  Framer framer;
  framer.push(bytes);
  const auto token = framer.next();
  if (!token || !std::holds_alternative<Telegram>(*token)) return {};
  return std::get<Telegram>(*token);
}

Measurement decoded(const ByteVector& bytes) {
  const auto result = parseMeasurement(telegramOf(bytes));
  EXPECT_TRUE(result) << result.error().what;
  return result.value_or(Measurement{});
}

struct ScanVector {
  const char* name;
  Measurement scan;
  const char* begins;
  const char* ends;
  std::size_t size;
  Byte unit = 0;
};

std::vector<std::uint16_t> constant(std::size_t count) {
  return std::vector<std::uint16_t>(count, 500);
}
std::vector<std::uint16_t> ramp(std::uint16_t first) {
  std::vector<std::uint16_t> values(361);
  std::iota(values.begin(), values.end(), first);
  return values;
}
Measurement scanOf(std::vector<std::uint16_t> values) {
  Measurement scan;
  scan.values = std::move(values);
  return scan;
}
Measurement partialOf(int quarters, std::size_t count) {
  Measurement scan = scanOf(constant(count));
  scan.partial = quarters;
  return scan;
}

std::vector<ScanVector> scanVectors() {
  Measurement polluted = scanOf(constant(361)), millimetres = scanOf(ramp(1000)),
              indexed = scanOf(constant(361));
  polluted.status = 0x90;
  millimetres.unit = Unit::Millimetre;
  indexed.indices = Indices{0x22, 0x11};
  const Measurement far = scanOf(std::vector<std::uint16_t>(361, 0x1FFF));
  return {
      {"three", scanOf({500, 501, 502}), "02 80 0A 00 B0 03 00 F4 01 F5 01 F6 01 10 42 08", "10 42 08", 16},
      {"5 m", scanOf(constant(361)), "02 80 D6 02 B0 69 01 F4 01", "F4 01 F4 01 10 C4 59", 732},
      {"5 m, unit 1", scanOf(constant(361)), "02 81 D6 02 B0 69 01 F4 01", "F4 01 F4 01 10 7A B2", 732, 1},
      {"5 m, dirty", polluted, "02 80 D6 02 B0 69 01 F4 01", "F4 01 F4 01 90 44 59", 732},
      {"nothing there", far, "02 80 D6 02 B0 69 01 FF 1F", "FF 1F FF 1F 10 5D 69", 732},
      {"ramp", scanOf(ramp(0)), "02 80 D6 02 B0 69 01 00 00 01 00", "67 01 68 01 10 48 C4", 732},
      {"ramp, mm", millimetres, "02 80 D6 02 B0 69 41 E8 03", "4F 05 50 05 10 86 0C", 732},
      {"indices", indexed, "02 80 D8 02 B0 69 01 F4 01", "F4 01 22 11 10 3B FA", 734},
      {"180/1", scanOf(constant(181)), "02 80 6E 01 B0 B5 00 F4 01", "F4 01 F4 01 10 A0 89", 372},
      {"x.00", partialOf(0, 181), "02 80 6E 01 B0 B5 20 F4 01", "F4 01 F4 01 10 B8 07", 372},
      {"x.25", partialOf(1, 180), "02 80 6C 01 B0 B4 28 F4 01", "F4 01 F4 01 10 12 C2", 370},
      {"x.50", partialOf(2, 180), "02 80 6C 01 B0 B4 30 F4 01", "F4 01 F4 01 10 32 1B", 370},
      {"x.75", partialOf(3, 180), "02 80 6C 01 B0 B4 38 F4 01", "F4 01 F4 01 10 D1 D3", 370},
      {"100/0.25", scanOf(constant(401)), "02 80 26 03 B0 91 01 F4 01", "F4 01 F4 01 10 E2 32", 812},
  };
}

TEST(Measurement, EveryVectorBothWays) {
  for (const ScanVector& vector : scanVectors()) {
    const ByteVector bytes = encodeMeasurement(vector.scan, vector.unit);
    const std::string text = hexText(bytes);
    EXPECT_TRUE(text.starts_with(vector.begins)) << vector.name << ": " << text.substr(0, 60);
    EXPECT_TRUE(text.ends_with(vector.ends)) << vector.name << ": " << text.substr(text.size() - 30);
    EXPECT_EQ(bytes.size(), vector.size) << vector.name;
    EXPECT_EQ(decoded(bytes), vector.scan) << vector.name;
    EXPECT_EQ(scanWireSize(static_cast<int>(vector.scan.values.size()), vector.scan.indices.has_value()),
              vector.size);
  }
}

TEST(Measurement, TheThesisConfigurationBeginsAsPrinted) {
  // 180 degrees, 0.5, centimetres.
  EXPECT_TRUE(hexText(encodeMeasurement(scanOf(constant(361)))).starts_with("02 80 D6 02 B0 69 01"));
  for (const auto& [variant, header] :
       std::vector<std::pair<Variant, const char*>>{{{180, 50}, "D6 02 B0 69 01"},
                                                    {{180, 100}, "6E 01 B0 B5 00"},
                                                    {{100, 100}, "CE 00 B0 65 00"},
                                                    {{100, 50}, "96 01 B0 C9 00"},
                                                    {{100, 25}, "26 03 B0 91 01"}}) {
    EXPECT_TRUE(variant.legal());
    const ByteVector bytes = encodeMeasurement(scanOf(constant(static_cast<std::size_t>(variant.values()))));
    EXPECT_EQ(hexText(std::span(bytes).subspan(2, 5)), header);
  }
  EXPECT_FALSE((Variant{180, 25}).legal());
  EXPECT_FALSE((Variant{90, 50}).legal());
  EXPECT_EQ((Variant{100, 25}).startDegrees(), 40.0);
  EXPECT_EQ((Variant{180, 50}).turns(), 2);
}

TEST(Measurement, SubRangeAndReflectivity) {
  Measurement range = scanOf({500, 501, 502, 503, 504});
  range.command = 0xB7;
  range.first = 1;
  range.last = 5;
  const char* range_bytes = "02 80 12 00 B7 01 00 05 00 05 00 F4 01 F5 01 F6 01 F7 01 F8 01 10 71 29";
  EXPECT_EQ(hexText(encodeMeasurement(range)), range_bytes);
  EXPECT_EQ(decoded(parseHex(range_bytes).value()), range);

  Measurement bright = scanOf({500, 501, 502});
  bright.command = 0xC4;
  bright.reflectivity = {10, 20, 30};
  bright.reflectivity_first = 1;
  bright.last = 3;
  const char* bright_bytes = "02 80 13 00 C4 03 00 F4 01 F5 01 F6 01 03 00 01 00 03 00 0A 14 1E 10 25 8D";
  EXPECT_EQ(hexText(encodeMeasurement(bright)), bright_bytes);
  EXPECT_EQ(decoded(parseHex(bright_bytes).value()), bright);
}

TEST(Measurement, TheOtherKindsThereAndBack) {
  Measurement mean = scanOf(ramp(3));
  mean.command = 0xB6;
  mean.mean_of = 4;
  EXPECT_EQ(decoded(encodeMeasurement(mean)), mean);
  Measurement mean_range = scanOf({1, 2, 3});
  mean_range.command = 0xBF;
  mean_range.mean_of = 2;
  mean_range.first = 10;
  mean_range.last = 12;
  mean_range.indices = Indices{255, 0};
  EXPECT_EQ(decoded(encodeMeasurement(mean_range)), mean_range);
  Measurement fields = scanOf({7, 8});
  fields.command = 0xBE;
  fields.first = 1;
  fields.last = 2;
  fields.extra = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(decoded(encodeMeasurement(fields)), fields);
  Measurement energy = scanOf({7, 8});
  energy.command = 0xF5;
  energy.first = 1;
  energy.last = 2;
  energy.extra = {12000, 13000};
  EXPECT_EQ(decoded(encodeMeasurement(energy)), energy);
}

TEST(Measurement, WhatContradictsItselfIsRefused) {
  const auto refused = [](Byte command, std::initializer_list<int> data) {
    ByteVector bytes;
    for (const int byte : data) bytes.push_back(static_cast<Byte>(byte));
    const auto result = parseMeasurement(telegramOf(encodeAnswer(command, bytes, 0x10)));
    return !result && !result.error().what.empty() && !result.error().remedy.empty();
  };
  EXPECT_TRUE(refused(0xB0, {}));
  EXPECT_TRUE(refused(0xB0, {3, 0, 1, 0, 2, 0}));        // one value short
  EXPECT_TRUE(refused(0xB0, {1, 0, 1, 0, 2}));           // a byte too many
  EXPECT_TRUE(refused(0xB0, {1, 0, 1, 0, 2, 0, 3, 0}));  // a value too many
  EXPECT_TRUE(refused(0xC4, {1, 0, 1, 0, 9, 0, 1, 0, 9, 0, 7}));
  EXPECT_TRUE(refused(0xF5, {2, 0, 1, 0, 1, 0, 1, 0, 5, 0, 6, 0}));
  EXPECT_TRUE(refused(0xA0, {0}));
  EXPECT_FALSE(parseMeasurement(Telegram{0x00, {0xB0, 0, 0, 0x10}})) << "from a host";
  EXPECT_FALSE(parseMeasurement(Telegram{}));
  EXPECT_TRUE(parseMeasurement(telegramOf(encodeAnswer(0xB0, ByteVector{0, 0}, 0x10)))->values.empty());
}

TEST(Value, FlagsAndCodesOfEveryMode) {
  using M = MeasuringMode;
  // Five metres with field A and dazzled is not 87 metres.
  const Value v = decodeValue(0xA1F4);
  EXPECT_EQ(v.distance, 500);
  EXPECT_TRUE(v.field_a && v.dazzle && !v.field_b && v.measured());
  EXPECT_TRUE(decodeValue(0x4000).field_b);
  EXPECT_TRUE(decodeValue(0x8000, M::FieldsAbc).field_c);
  EXPECT_EQ(decodeValue(0xE001, M::Reflector8).reflector, 7);
  EXPECT_EQ(decodeValue(0xC001, M::Reflector4).reflector, 3);
  EXPECT_EQ(decodeValue(0x8001, M::ReflectorBit).reflector, 1);
  EXPECT_TRUE(decodeValue(0x8001, M::FieldA).field_a);
  EXPECT_TRUE(decodeValue(0x8001, M::FieldsAb).field_b);
  EXPECT_EQ(decodeValue(0x2001, M::Reflector4).distance, 0x2001);
  EXPECT_EQ(decodeValue(0x3039, M::Energy).distance, 12345);
  EXPECT_TRUE(decodeValue(0x1FFF, M::Energy).measured());
  // The greatest distance and every code, with 13, 14 and 15 bits.
  for (const auto& [mode, top] : std::vector<std::pair<M, int>>{
           {M::FieldsAbDazzle, 0x1FFF}, {M::FieldsAb, 0x3FFF}, {M::FieldA, 0x7FFF}, {M::NoFlags, 0x7FFF}}) {
    EXPECT_TRUE(decodeValue(static_cast<std::uint16_t>(top - 9), mode).measured());
    for (int code = 8183; code <= 8191; ++code) {
      const Value value = decodeValue(static_cast<std::uint16_t>(top - (8191 - code)), mode);
      EXPECT_EQ(value.code, code);
      EXPECT_FALSE(value.measured());
    }
  }
  EXPECT_EQ(decodeValue(0x1FF6).distance, 8182) << "81.82 m is the furthest";
}

TEST(Value, EveryBitSurvives) {
  for (const MeasuringMode mode :
       {MeasuringMode::FieldsAbDazzle, MeasuringMode::Reflector8, MeasuringMode::FieldsAbc,
        MeasuringMode::Reflector4, MeasuringMode::FieldsAb, MeasuringMode::ReflectorBit,
        MeasuringMode::FieldA, MeasuringMode::NoFlags, MeasuringMode::Energy})
    for (unsigned raw = 0; raw <= 0xFFFF; ++raw)
      ASSERT_EQ(encodeValue(decodeValue(static_cast<std::uint16_t>(raw), mode), mode), raw)
          << static_cast<int>(mode);
}

TEST(Value, CodesHaveWords) {
  for (const CellCode code : std::vector<CellCode>{8183, 8186, 8187, 8189, 8190, 8191})
    EXPECT_EQ(codeText(code).find("code"), std::string::npos);
  EXPECT_EQ(codeText(8184), "code 8184");
  EXPECT_EQ(metresPerCount(Unit::Centimetre), 0.01);
  EXPECT_EQ(metresPerCount(Unit::Millimetre), 0.001);
  EXPECT_EQ(metresPerCount(Unit::Reserved2), 0.0);
}

}  // namespace
}  // namespace tiltmap::lms2xx
