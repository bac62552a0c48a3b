#include "hardware/lms2xx/measurement.h"

#include <algorithm>
#include <stdexcept>

namespace tiltmap::lms2xx {

namespace {

constexpr unsigned kCountMask = 0x3FF;
constexpr unsigned kPartialBit = 1U << 13;

// Reads numbers one after the other and remembers whether they were all there.
class Reader {
 public:
  explicit Reader(std::span<const Byte> bytes) : bytes_(bytes) {}
  unsigned byte() {
    if (at_ + 1 > bytes_.size()) return missing();
    return bytes_[at_++];
  }
  unsigned word() {
    if (at_ + 2 > bytes_.size()) return missing();
    at_ += 2;
    return lms2xx::word(bytes_, at_ - 2);
  }
  std::size_t left() const { return bytes_.size() - at_; }
  bool complete() const { return complete_; }

 private:
  unsigned missing() {
    complete_ = false;
    at_ = bytes_.size();
    return 0;
  }
  std::span<const Byte> bytes_;
  std::size_t at_ = 0;
  bool complete_ = true;
};

// Words of `per_value` for each value; the first is the value itself.
void readValues(Reader& reader, Measurement& result, int per_value) {
  const unsigned header = reader.word();
  result.unit = static_cast<Unit>(header >> 14);
  if (header & kPartialBit) result.partial = static_cast<int>(header >> 11 & 3U);
  const std::size_t count = header & kCountMask;
  result.values.reserve(count);
  for (std::size_t i = 0; i < count && reader.complete(); ++i) {
    result.values.push_back(static_cast<std::uint16_t>(reader.word()));
    for (int k = 1; k < per_value; ++k) result.extra.push_back(static_cast<std::uint16_t>(reader.word()));
  }
}

void readReflectivity(Reader& reader, Measurement& result) {
  const std::size_t count = reader.word();
  result.reflectivity_first = static_cast<int>(reader.word());
  result.last = static_cast<int>(reader.word());
  for (std::size_t i = 0; i < count && reader.complete(); ++i)
    result.reflectivity.push_back(static_cast<Byte>(reader.byte()));
}

tl::unexpected<Error> broken(const std::string& what, const Telegram& telegram) {
  const Byte name = telegram.command();
  return fail(
      what,
      "telegram " + hexText(std::span(&name, 1)) + " of " + std::to_string(telegram.wireSize()) + " bytes",
      "it is left out; if it comes again, record the session and look at it");
}

unsigned headerOf(const Measurement& m) {
  unsigned header = static_cast<unsigned>(m.values.size()) & kCountMask;
  header |= static_cast<unsigned>(m.unit) << 14;
  if (m.partial) header |= kPartialBit | static_cast<unsigned>(*m.partial & 3) << 11;
  return header;
}

}  // namespace

double metresPerCount(Unit unit) {
  return unit == Unit::Centimetre ? 0.01 : unit == Unit::Millimetre ? 0.001 : 0.0;
}

bool isMeasurement(Byte command) {
  constexpr std::array<Byte, 7> kKnown{0xB0, 0xB6, 0xB7, 0xBE, 0xBF, 0xC4, 0xF5};
  return std::ranges::find(kKnown, command) != kKnown.end();
}

Result<Measurement> parseMeasurement(const Telegram& telegram) {
  Measurement result;
  result.command = telegram.command();
  if (!telegram.fromScanner() || !isMeasurement(result.command))
    return broken("this telegram holds no measured values", telegram);
  result.status = telegram.status();
  Reader reader(telegram.data());
  if (result.command == 0xB6 || result.command == 0xBF) result.mean_of = static_cast<int>(reader.byte());
  if (result.command == 0xF5 && reader.word() != 1)
    return broken("it holds several ranges of beams, of which we ask for one only", telegram);
  if (result.command == 0xB7 || result.command == 0xBF || result.command == 0xBE || result.command == 0xF5) {
    result.first = static_cast<int>(reader.word());
    result.last = static_cast<int>(reader.word());
  }
  readValues(reader, result, result.command == 0xBE ? 4 : result.command == 0xF5 ? 2 : 1);
  if (result.command == 0xC4) readReflectivity(reader, result);
  if (!reader.complete()) return broken("it is shorter than the number of values in it says", telegram);
  // The real-time indices are there or not; the length alone tells.
  if (reader.left() == 2) {
    Indices indices;
    indices.scan = static_cast<Byte>(reader.byte());
    indices.telegram = static_cast<Byte>(reader.byte());
    result.indices = indices;
  } else if (reader.left() != 0) {
    return broken("it is longer than the number of values in it says", telegram);
  }
  return result;
}

ByteVector encodeMeasurement(const Measurement& m, Byte unit_address) {
  ByteVector data;
  if (m.command == 0xB6 || m.command == 0xBF) data.push_back(static_cast<Byte>(m.mean_of.value_or(1)));
  if (m.command == 0xF5) addWord(data, 1);
  if (m.command == 0xB7 || m.command == 0xBF || m.command == 0xBE || m.command == 0xF5) {
    addWord(data, static_cast<unsigned>(m.first.value_or(1)));
    addWord(data, static_cast<unsigned>(m.last.value_or(static_cast<int>(m.values.size()))));
  }
  addWord(data, headerOf(m));
  const std::size_t extra = m.values.empty() ? 0 : m.extra.size() / m.values.size();
  for (std::size_t i = 0; i < m.values.size(); ++i) {
    addWord(data, m.values[i]);
    for (std::size_t k = 0; k < extra; ++k) addWord(data, m.extra[i * extra + k]);
  }
  if (m.command == 0xC4) {
    addWord(data, static_cast<unsigned>(m.reflectivity.size()));
    addWord(data, static_cast<unsigned>(m.reflectivity_first));
    addWord(data, static_cast<unsigned>(m.last.value_or(static_cast<int>(m.reflectivity.size()))));
    data.insert(data.end(), m.reflectivity.begin(), m.reflectivity.end());
  }
  if (m.indices) {
    data.push_back(m.indices->scan);
    data.push_back(m.indices->telegram);
  }
  return encodeAnswer(m.command, data, m.status, unit_address);
}

int distanceBits(MeasuringMode mode) {
  switch (mode) {
    case MeasuringMode::FieldsAbDazzle:
    case MeasuringMode::Reflector8:
    case MeasuringMode::FieldsAbc:
      return 13;
    case MeasuringMode::Reflector4:
    case MeasuringMode::FieldsAb:
      return 14;
    case MeasuringMode::ReflectorBit:
    case MeasuringMode::FieldA:
      return 15;
    case MeasuringMode::NoFlags:
    case MeasuringMode::Energy:
      break;
  }
  return 16;
}

Value decodeValue(std::uint16_t raw, MeasuringMode mode) {
  Value value;
  const int bits = distanceBits(mode);
  const unsigned flags = static_cast<unsigned>(raw) >> bits;
  value.distance = static_cast<std::uint16_t>(raw & ((1U << bits) - 1U));
  switch (mode) {
    case MeasuringMode::FieldsAbDazzle:
      value.dazzle = (flags & 4U) != 0;
      [[fallthrough]];
    case MeasuringMode::FieldsAb:
      value.field_a = (flags & 1U) != 0;
      value.field_b = (flags & 2U) != 0;
      break;
    case MeasuringMode::FieldsAbc:
      value.field_a = (flags & 1U) != 0;
      value.field_b = (flags & 2U) != 0;
      value.field_c = (flags & 4U) != 0;
      break;
    case MeasuringMode::FieldA:
      value.field_a = (flags & 1U) != 0;
      break;
    case MeasuringMode::Reflector8:
    case MeasuringMode::Reflector4:
    case MeasuringMode::ReflectorBit:
      value.reflector = static_cast<int>(flags);
      break;
    case MeasuringMode::NoFlags:
      break;
    case MeasuringMode::Energy:
      return value;  // no distance, so no code for a missing one
  }
  // Without flags the ranges end at 32 m, and the codes look as with 15 bits.
  const unsigned first = (1U << std::min(bits, 15)) - 9U;
  if (value.distance >= first && value.distance <= first + 8U) {
    value.code = static_cast<CellCode>(cell_code::kLmsFirst + (value.distance - first));
  }
  return value;
}

std::uint16_t encodeValue(const Value& value, MeasuringMode mode) {
  const int bits = distanceBits(mode);
  unsigned distance = value.distance;
  if (!value.measured() && mode != MeasuringMode::Energy)
    distance = (1U << std::min(bits, 15)) - 9U + (value.code - cell_code::kLmsFirst);
  unsigned flags = 0;
  switch (mode) {
    case MeasuringMode::FieldsAbDazzle:
      flags = (value.field_a ? 1U : 0U) | (value.field_b ? 2U : 0U) | (value.dazzle ? 4U : 0U);
      break;
    case MeasuringMode::FieldsAbc:
      flags = (value.field_a ? 1U : 0U) | (value.field_b ? 2U : 0U) | (value.field_c ? 4U : 0U);
      break;
    case MeasuringMode::FieldsAb:
      flags = (value.field_a ? 1U : 0U) | (value.field_b ? 2U : 0U);
      break;
    case MeasuringMode::FieldA:
      flags = value.field_a ? 1U : 0U;
      break;
    case MeasuringMode::Reflector8:
    case MeasuringMode::Reflector4:
    case MeasuringMode::ReflectorBit:
      flags = static_cast<unsigned>(value.reflector);
      break;
    case MeasuringMode::NoFlags:
    case MeasuringMode::Energy:
      break;
  }
  return static_cast<std::uint16_t>((distance & ((1U << bits) - 1U)) | flags << bits);
}

std::string codeText(CellCode code) {
  switch (code) {
    case 8183:
      return "beyond the longest range";
    case 8186:
      return "a channel could not be read";
    case 8187:
      return "too much noise";
    case 8189:
      return "calculation overflow, or a pulse too weak";
    case 8190:
      return "dazzled";
    case 8191:
      return "nothing came back";
    default:
      return "code " + std::to_string(code);
  }
}

std::size_t scanWireSize(int values, bool indices) {
  return kOverhead + 4 + 2 * static_cast<std::size_t>(values) + (indices ? 2 : 0);
}

}  // namespace tiltmap::lms2xx
