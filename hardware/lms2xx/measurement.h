// Measured values of an LMS 2xx: telegrams B0, B6, B7, BF, C4, BE and F5, and what the bits of a value mean.
#pragma once

#include <optional>
#include <string>

#include "core/scan/range_image.h"
#include "hardware/lms2xx/requests.h"

namespace tiltmap::lms2xx {

// Bits 14 and 15 of the header.
enum class Unit : Byte { Centimetre = 0, Millimetre = 1, Reserved2 = 2, Reserved3 = 3 };
// Length of one count, metres; 0 for the reserved ones.
double metresPerCount(Unit unit);

struct Indices {
  Byte scan = 0;      // turns of the mirror, modulo 256
  Byte telegram = 0;  // telegrams with values, modulo 256
  bool operator==(const Indices&) const = default;
};

// A block of values as it was sent: every bit is kept.
struct Measurement {
  Byte command = 0xB0;
  Unit unit = Unit::Centimetre;
  std::optional<int> partial;  // quarter degrees that the beams of this partial scan are shifted by
  std::vector<std::uint16_t> values;
  std::optional<int> mean_of;        // B6, BF
  std::optional<int> first, last;    // B7, BF, BE, and of each range of F5: 1 is the rightmost beam
  std::vector<std::uint16_t> extra;  // BE: fields A, B, C of each value in turn; F5: energy of each value
  std::vector<Byte> reflectivity;    // C4
  int reflectivity_first = 0;        // C4: the first beam that has one
  std::optional<Indices> indices;
  Byte status = 0x10;

  bool operator==(const Measurement&) const = default;
};

bool isMeasurement(Byte answer_command);
// Fails for a telegram of another kind, and where the lengths in it contradict each other. Of F5 with several
// ranges only telegrams with one are taken.
Result<Measurement> parseMeasurement(const Telegram& telegram);
// The other way.
ByteVector encodeMeasurement(const Measurement& measurement, Byte unit_address = 0);

// Configuration byte D: how many bits of a value are distance, and what the others are.
enum class MeasuringMode : Byte {
  FieldsAbDazzle = 0x00,
  Reflector8 = 0x01,
  FieldsAbc = 0x02,
  Reflector4 = 0x03,
  FieldsAb = 0x04,
  ReflectorBit = 0x05,
  FieldA = 0x06,
  NoFlags = 0x0F,
  Energy = 0x3F,
};

struct Value {
  std::uint16_t distance = 0;            // counts; of Energy, the energy
  CellCode code = cell_code::kMeasured;  // or 8183 to 8191, whatever the number of bits
  bool field_a = false, field_b = false, field_c = false, dazzle = false;
  int reflector = 0;

  bool measured() const { return code == cell_code::kMeasured; }
  bool operator==(const Value&) const = default;
};

int distanceBits(MeasuringMode mode);
Value decodeValue(std::uint16_t raw, MeasuringMode mode = MeasuringMode::FieldsAbDazzle);
std::uint16_t encodeValue(const Value& value, MeasuringMode mode = MeasuringMode::FieldsAbDazzle);
// Why there is no distance, for people.
std::string codeText(CellCode code);

// How many bytes a scan of the variant is on the wire.
std::size_t scanWireSize(int values, bool indices);

}  // namespace tiltmap::lms2xx
