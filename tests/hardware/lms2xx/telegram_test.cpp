// Literal telegrams of the vendor's listing and of logs of real units, both ways: an error that encoder and
// decoder share cannot hide behind them.
#include "hardware/lms2xx/telegram.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "hardware/lms2xx/framer.h"
#include "hardware/lms2xx/requests.h"
#include "hardware/lms2xx/unit_state.h"

namespace tiltmap::lms2xx {
namespace {

ByteVector hex(const char* text) {
  return parseHex(text).value();
}

struct RequestVector {
  const char* name;
  Request request;
  const char* bytes;
  Byte address = 0;
};

std::vector<RequestVector> requestVectors() {
  using namespace request;
  const Variant v100_1{100, 100}, v100_05{100, 50}, v100_025{100, 25}, v180_1{180, 100}, v180_05{180, 50};
  return {
      {"reset", reset(), "02 00 01 00 10 34 12"},
      {"status", status(), "02 00 01 00 31 15 12"},
      {"errors", errors(), "02 00 01 00 32 16 12"},
      {"hours", operatingHours(), "02 00 01 00 35 11 12"},
      {"type", type(), "02 00 01 00 3A 1E 12"},
      {"configuration", readConfiguration(), "02 00 01 00 74 50 12"},
      {"configuration 2", readConfiguration2(), "02 00 01 00 7B 5F 12"},
      {"installation", installationMode(), "02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"},
      {"password", testPassword(), "02 00 0A 00 20 30 53 49 43 4B 5F 4C 4D 53 EE F5"},
      {"diagnostic", setMode(mode::kDiagnostic), "02 00 02 00 20 10 00 08"},
      {"stream", stream(), "02 00 02 00 20 24 34 08"},
      {"on request", onRequest(), "02 00 02 00 20 25 35 08"},
      {"stream partial", streamPartial(), "02 00 02 00 20 2A 3A 08"},
      {"38400", setRate(38400), "02 00 02 00 20 40 50 08"},
      {"19200", setRate(19200), "02 00 02 00 20 41 51 08"},
      {"9600", setRate(9600), "02 00 02 00 20 42 52 08"},
      {"500000", setRate(500000), "02 00 02 00 20 48 58 08"},
      {"scan", scan(), "02 00 02 00 30 01 31 18"},
      {"partial scan", partialScan(), "02 00 02 00 30 08 38 18"},
      {"mean of 2", meanScan(2), "02 00 02 00 36 02 3E 1E"},
      {"mean of 4, on and on", streamMean(4), "02 00 03 00 20 26 04 78 3E"},
      {"range", range(1, 361), "02 00 05 00 37 01 00 69 01 EB 75"},
      {"stream 27 to 299", streamRange(27, 299), "02 00 06 00 20 27 1B 00 2B 01 FF FE"},
      {"stream 1 to 361", streamRange(1, 361), "02 00 06 00 20 27 01 00 69 01 AB D4"},
      {"fields", rangeWithFields(1, 401), "02 00 05 00 3E 01 00 91 01 8B C4"},
      {"reflectivity", reflectivity(1, 181), "02 00 05 00 44 01 00 B5 00 68 37"},
      {"stream reflectivity", streamReflectivity(1, 181), "02 00 06 00 20 50 01 00 B5 00 68 B6"},
      {"energy", energy(1, 401), "02 00 07 00 75 01 00 01 00 91 01 7D B6"},
      {"cartesian", cartesian(1, 298), "02 00 05 00 76 01 00 2A 01 72 BA"},
      {"100/1", setVariant(v100_1), "02 00 05 00 3B 64 00 64 00 1D 0F"},
      {"100/0.5", setVariant(v100_05), "02 00 05 00 3B 64 00 32 00 B1 59"},
      {"100/0.25", setVariant(v100_025), "02 00 05 00 3B 64 00 19 00 E7 72"},
      {"180/1", setVariant(v180_1), "02 00 05 00 3B B4 00 64 00 97 49"},
      {"180/0.5", setVariant(v180_05), "02 00 05 00 3B B4 00 32 00 3B 1F"},
      {"9600 at power-on", permanentRate(false), "02 00 02 00 66 00 9C 4E"},
      {"this rate at power-on", permanentRate(true), "02 00 02 00 66 01 9D 4E"},
      {"field set", activeFieldSet(), "02 00 02 00 41 00 D2 69"},
      {"status of unit 1", status(), "02 01 01 00 31 1D 16", 1},
  };
}

TEST(Request, EveryVectorBothWays) {
  for (const RequestVector& vector : requestVectors()) {
    EXPECT_EQ(hexText(vector.request.encoded(vector.address)), vector.bytes) << vector.name;
    Framer framer(Sender::Host);
    framer.push(hex(vector.bytes));
    const auto token = framer.next();
    ASSERT_TRUE(token) << vector.name;
    const auto& telegram = std::get<Telegram>(*token);
    EXPECT_EQ(telegram.address, vector.address);
    EXPECT_EQ(telegram.command(), vector.request.command) << vector.name;
    EXPECT_EQ(ByteVector(telegram.data().begin(), telegram.data().end()), vector.request.data) << vector.name;
    EXPECT_FALSE(framer.waiting());
  }
}

TEST(Request, WritesConfigurations) {
  // Read from a listing, from the log of a real LMS 200, and computed for an LMS 291.
  for (const char* bytes :
       {"02 00 23 00 77 00 00 46 00 00 00 01 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 80 00 0A 0A 50 64 "
        "00 00 00 00 02 00 7B 4B",
        "02 00 23 00 77 00 00 70 00 00 04 01 00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
        "00 00 00 00 02 00 94 8A",
        "02 00 23 00 77 00 00 46 00 00 00 00 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 0A 0A 50 64 "
        "00 00 00 00 02 00 5A D2",
        "02 00 23 00 77 00 00 46 00 00 00 01 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 0A 0A 50 64 "
        "00 00 00 00 02 00 0A E2",
        "02 00 23 00 77 00 00 46 00 02 00 00 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 0A 0A 50 64 "
        "00 00 00 00 02 00 DF D0",
        "02 00 21 00 77 00 00 00 00 00 00 01 00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
        "00 00 00 00 FC 7E",
        "02 00 21 00 77 00 00 00 00 00 00 00 00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
        "00 00 00 00 E8 72"}) {
    Framer framer(Sender::Host);
    framer.push(hex(bytes));
    const auto token = framer.next();
    ASSERT_TRUE(token) << bytes;
    const auto data = std::get<Telegram>(*token).data();
    EXPECT_EQ(hexText(request::writeConfiguration(data).encoded()), hexText(hex(bytes)));
  }
}

TEST(Request, WritesWhatWasChangedAndNothingElse) {
  Configuration factory = Configuration::factory();
  EXPECT_EQ(hexText(request::writeConfiguration(factory.block()).encoded()),
            "02 00 23 00 77 00 00 46 00 00 00 00 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 0A 0A 50 "
            "64 00 00 00 00 02 00 5A D2");
  Configuration millimetres = factory;
  millimetres.setUnit(Unit::Millimetre);
  EXPECT_TRUE(hexText(request::writeConfiguration(millimetres.block()).encoded()).ends_with("0A E2"));
  Configuration indices = factory;
  indices.setSendsIndices(true);
  EXPECT_TRUE(hexText(request::writeConfiguration(indices.block()).encoded()).ends_with("DF D0"));
  indices.setSendsIndices(false);
  EXPECT_EQ(indices, factory);
}

TEST(Request, KnowsItsAnswer) {
  EXPECT_EQ(request::status().answer(), 0xB1);
  EXPECT_EQ(request::scan().answer(), 0xB0);
  EXPECT_EQ(request::writeConfiguration(ByteVector(34)).answer(), 0xF7);
  EXPECT_EQ(request::reset().answer(), 0x91);
  EXPECT_THROW(request::setRate(57600), std::invalid_argument);
}

TEST(Answer, EveryVectorBothWays) {
  // Short answers; those with values and states have tests of their own.
  for (const char* bytes :
       {"02 80 03 00 A0 00 10 16 0A", "02 81 03 00 A0 00 10 36 1A", "02 80 03 00 A0 01 10 14 0B",
        "02 80 03 00 A0 02 10 12 08", "02 80 02 00 91 10 79 30", "02 80 02 00 92 10 7F 33",
        "02 80 02 00 B2 10 3F 13",
        "02 80 17 00 BA 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 22 61",
        "02 80 17 00 90 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 63 5E",
        "02 81 17 00 90 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 77 52",
        "02 80 07 00 BB 01 B4 00 32 00 10 03 9D", "02 81 07 00 BB 01 B4 00 32 00 10 06 1F",
        "02 81 07 00 BB 01 B4 00 64 00 10 5E B2", "02 81 07 00 BB 01 64 00 64 00 10 4A 3F",
        "02 81 07 00 BB 01 64 00 32 00 10 12 92", "02 81 07 00 BB 01 64 00 19 00 10 BE C4",
        "02 80 07 00 BB 00 B4 00 32 00 10 23 8D", "02 80 03 00 E6 01 10 0C 86",
        "02 80 25 00 F7 01 00 00 70 00 00 00 01 00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
        "00 00 00 00 00 02 00 10 C5 7A"}) {
    Framer framer;
    framer.push(hex(bytes));
    const auto token = framer.next();
    ASSERT_TRUE(token && std::holds_alternative<Telegram>(*token)) << bytes;
    const auto& telegram = std::get<Telegram>(*token);
    EXPECT_EQ(telegram.status(), 0x10);
    EXPECT_EQ(hexText(encodeAnswer(telegram.command(), telegram.data(), telegram.status(),
                                   static_cast<Byte>(telegram.address & 0x7F))),
              hexText(hex(bytes)));
    EXPECT_EQ(telegram.wireSize(), hex(bytes).size());
  }
}

TEST(Telegram, Checksum) {
  EXPECT_EQ(crc({}), 0);
  EXPECT_EQ(crc(hex("02")), 0x0002);
  EXPECT_EQ(crc(hex("02 00")), 0x0204);
  EXPECT_EQ(crc(hex("02 00 01")), 0x0409);
  EXPECT_EQ(crc(hex("02 00 01 00")), 0x0912);
  EXPECT_EQ(crc(hex("02 00 01 00 31")), 0x1215);
  // The listing's own misprint belongs to a mistyped password.
  EXPECT_EQ(crc(hex("02 00 0A 00 20 00 53 49 43 B4 5F 4C 4D 53")), 0xB25F);
}

TEST(Telegram, HasAtLeastACommandAndAtMostWhatTheScannerSends) {
  EXPECT_THROW(encode({0, {}}), std::invalid_argument);
  EXPECT_THROW(encode({0, ByteVector(kLongestPayload + 1)}), std::invalid_argument);
  EXPECT_EQ(encode({0, ByteVector(kLongestPayload)}).size(), kLongestPayload + kOverhead);
  EXPECT_TRUE((Telegram{0x80, {0xA0}}).data().empty());
  EXPECT_TRUE((Telegram{0x80, {}}).data().empty());
}

}  // namespace
}  // namespace tiltmap::lms2xx
