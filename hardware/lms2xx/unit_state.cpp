#include "hardware/lms2xx/unit_state.h"

#include <algorithm>

#include "core/base/text.h"

namespace tiltmap::lms2xx {

namespace {

// Offsets in the data of B1, one less than the telegram listing's, which count the command.
constexpr std::size_t kVersion = 0, kMode = 7, kHealth = 8, kPollution = 18, kReference = 34, kMotor = 66,
                      kMeasuring = 101, kAngle = 106, kResolution = 108, kBaud = 115, kPermanent = 118,
                      kAddress = 119, kUnit = 121, kLaser = 122, kBoot = 123, kVersionLength = 7;

struct BaudCode {
  int baud;
  std::uint16_t code;
};
constexpr std::array<BaudCode, 4> kBaudCodes{
    {{9600, 0x8067}, {19200, 0x8033}, {38400, 0x8019}, {500000, 0x8001}}};

std::string textAt(std::span<const Byte> data, std::size_t at, std::size_t length) {
  std::string text;
  for (const Byte byte : data.subspan(at, length))
    text += byte >= 0x20 && byte < 0x7F ? static_cast<char>(byte) : ' ';
  return std::string(trimmed(text));
}

void putWord(ByteVector& data, std::size_t at, unsigned value) {
  data[at] = static_cast<Byte>(value & 255U);
  data[at + 1] = static_cast<Byte>(value >> 8 & 255U);
}

void putText(ByteVector& data, std::size_t at, std::string_view text) {
  for (std::size_t i = 0; i < kVersionLength; ++i)
    data[at + i] = i < text.size() ? static_cast<Byte>(text[i]) : Byte{' '};
}

tl::unexpected<Error> tooShort(const Telegram& telegram, const char* what) {
  return fail(
      std::string("the scanner's answer is too short for ") + what,
      std::to_string(telegram.wireSize()) + " bytes: " +
          hexText(std::span(telegram.payload).first(std::min<std::size_t>(telegram.payload.size(), 12))),
      "ask again; if it comes again, record the session and look at it");
}

}  // namespace

std::vector<std::string> warningsOf(StatusByte status) {
  std::vector<std::string> warnings;
  if (status.polluted())
    warnings.emplace_back("the scanner's window is dirty: wipe it with a soft cloth, or ranges are lost");
  if (status.implausible()) warnings.emplace_back("the scanner reports implausible values");
  const Byte raw[] = {status.raw};
  if (status.severity() >= 2)
    warnings.push_back(std::string("the scanner reports ") +
                       (status.severity() == 2   ? "a warning"
                        : status.severity() == 3 ? "an error"
                                                 : "a fatal error") +
                       " (status " + hexText(raw) +
                       "): `tiltmap devices` with its URL tells what it has stored");
  return warnings;
}

UnitType parseType(std::span<const Byte> bytes) {
  UnitType type;
  type.text = textAt(bytes, 0, bytes.size());
  const auto parts = splitAt(type.text, ';');
  const auto part = [&](std::size_t i) {
    return i < parts.size() ? std::string(trimmed(parts[i])) : std::string();
  };
  type.model = part(0);
  type.variant = part(1);
  type.version = part(2);
  return type;
}

Result<UnitStatus> parseStatus(const Telegram& telegram) {
  const auto data = telegram.data();
  if (data.size() < kBoot + kVersionLength) return tooShort(telegram, "a status");
  UnitStatus status;
  status.version = textAt(data, kVersion, kVersionLength);
  status.mode = data[kMode];
  status.defective = data[kHealth] != 0;
  for (std::size_t i = 0; i < status.pollution.size(); ++i)
    status.pollution[i] = word(data, kPollution + 2 * i);
  for (std::size_t i = 0; i < status.reference_pollution.size(); ++i)
    status.reference_pollution[i] = word(data, kReference + 2 * i);
  status.motor_us = word(data, kMotor);
  status.measuring_mode = static_cast<MeasuringMode>(data[kMeasuring]);
  status.variant = {word(data, kAngle), word(data, kResolution)};
  for (const BaudCode& known : kBaudCodes)
    if (known.code == word(data, kBaud)) status.baud = known.baud;
  status.keeps_rate = data[kPermanent] != 0;
  status.address = data[kAddress];
  status.unit = data[kUnit] == 0 ? Unit::Centimetre : Unit::Millimetre;
  status.laser_on = data[kLaser] != 0;
  status.boot_version = textAt(data, kBoot, kVersionLength);
  status.raw.assign(data.begin(), data.end());
  return status;
}

ByteVector statusData(const UnitStatus& status) {
  ByteVector data = status.raw.size() == kStatusData ? status.raw : ByteVector(kStatusData, 0);
  putText(data, kVersion, status.version);
  data[kMode] = status.mode;
  data[kHealth] = status.defective ? 1 : 0;
  for (std::size_t i = 0; i < status.pollution.size(); ++i)
    putWord(data, kPollution + 2 * i, status.pollution[i]);
  for (std::size_t i = 0; i < status.reference_pollution.size(); ++i)
    putWord(data, kReference + 2 * i, status.reference_pollution[i]);
  putWord(data, kMotor, static_cast<unsigned>(status.motor_us));
  data[kMeasuring] = static_cast<Byte>(status.measuring_mode);
  putWord(data, kAngle, static_cast<unsigned>(status.variant.angle_deg));
  putWord(data, kResolution, static_cast<unsigned>(status.variant.resolution_cdeg));
  for (const BaudCode& known : kBaudCodes)
    if (known.baud == status.baud) putWord(data, kBaud, known.code);
  data[kPermanent] = status.keeps_rate ? 1 : 0;
  data[kAddress] = status.address;
  data[kUnit] = status.unit == Unit::Millimetre ? 1 : 0;
  data[kLaser] = status.laser_on ? 1 : 0;
  putText(data, kBoot, status.boot_version);
  return data;
}

Configuration Configuration::factory() {
  ByteVector block{0, 0, 0x46, 0, 0, 0, 0, 0, 0, 0x02, 0x02, 0x02, 0};
  for (int contour = 0; contour < 3; ++contour) block.insert(block.end(), {0x00, 0x0A, 0x0A, 0x50, 0x64});
  block.insert(block.end(), {0, 0, 0, 0, 0x02, 0});
  return Configuration(std::move(block));
}

Result<Configuration> parseConfiguration(const Telegram& telegram) {
  const auto data = telegram.data();
  Configuration configuration(ByteVector(data.begin(), data.end()));
  if (!configuration.plausible()) return tooShort(telegram, "a configuration");
  return configuration;
}

Result<WriteAnswer> parseWriteAnswer(const Telegram& telegram) {
  const auto data = telegram.data();
  if (data.empty()) return tooShort(telegram, "the answer to a written configuration");
  return WriteAnswer{data[0] == 1, Configuration(ByteVector(data.begin() + 1, data.end()))};
}

Result<VariantAnswer> parseVariantAnswer(const Telegram& telegram) {
  const auto data = telegram.data();
  if (data.size() < 5) return tooShort(telegram, "the answer to a variant");
  return VariantAnswer{data[0] == 1, {word(data, 1), word(data, 3)}};
}

std::vector<StoredError> parseErrors(const Telegram& telegram) {
  std::vector<StoredError> errors;
  const auto data = telegram.data();
  for (std::size_t i = 0; i + 1 < data.size(); i += 2) errors.push_back({data[i], data[i + 1]});
  return errors;
}

}  // namespace tiltmap::lms2xx
