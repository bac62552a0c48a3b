// What an LMS 2xx says about itself: type, status, configuration, errors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hardware/lms2xx/measurement.h"

namespace tiltmap::lms2xx {

// The last byte of every telegram from the scanner.
struct StatusByte {
  Byte raw = 0x10;
  int severity() const { return raw & 7; }  // 0 ok, 1 information, 2 warning, 3 error, 4 fatal
  bool restartInput() const { return (raw & 0x20) != 0; }
  bool implausible() const { return (raw & 0x40) != 0; }
  bool polluted() const { return (raw & 0x80) != 0; }
};
// What the operator should know; empty for a healthy unit.
std::vector<std::string> warningsOf(StatusByte status);

// "LMS291;S05;V02.10": parts between semicolons, as many as there are.
struct UnitType {
  std::string text;     // whole, without trailing blanks
  std::string model;    // "LMS291"
  std::string variant;  // "S05" or "301063"
  std::string version;  // "V02.10"
  // Types whose numbers begin with S14 send reflectivity, and know 90 degrees with 0.5 only.
  bool sendsReflectivity() const { return variant.starts_with("S14"); }
  bool operator==(const UnitType&) const = default;
};
UnitType parseType(std::span<const Byte> text);

// B1.
struct UnitStatus {
  std::string version;
  Byte mode = 0;  // as in mode::
  bool defective = false;
  std::array<std::uint16_t, 8> pollution{};
  std::array<std::uint16_t, 4> reference_pollution{};
  int motor_us = 0;  // per 1/90 turn; nominal 148
  MeasuringMode measuring_mode = MeasuringMode::FieldsAbDazzle;
  Variant variant;
  int baud = 0;             // 0: a code that is not known
  bool keeps_rate = false;  // 0 : 9600 at power-on
  Byte address = 0;
  Unit unit = Unit::Centimetre;
  bool laser_on = false;
  std::string boot_version;
  ByteVector raw;  // the data as sent, for what is not named here
};
inline constexpr std::size_t kStatusData = 152;
Result<UnitStatus> parseStatus(const Telegram& telegram);
// The data of a B1 telegram; `raw` is filled in where it has the right length.
ByteVector statusData(const UnitStatus& status);

// Block of 74 and 77: 34 bytes (32 on old firmware), kept whole.
class Configuration {
 public:
  Configuration() = default;
  explicit Configuration(ByteVector block) : block_(std::move(block)) {}
  // As delivered: an LMS 291, centimetres.
  static Configuration factory();

  const ByteVector& block() const { return block_; }
  bool plausible() const { return block_.size() >= 32 && block_.size() <= 64; }
  int blankingCm() const { return word(block_, 0); }
  int sensitivity() const { return block_[3]; }
  bool sendsIndices() const { return (block_[4] & 2) != 0; }
  MeasuringMode measuringMode() const { return static_cast<MeasuringMode>(block_[5]); }
  Unit unit() const { return block_[6] == 0 ? Unit::Centimetre : Unit::Millimetre; }

  void setSensitivity(int value) { block_[3] = static_cast<Byte>(value); }
  void setSendsIndices(bool on) { block_[4] = static_cast<Byte>(on ? block_[4] | 2 : block_[4] & ~2); }
  void setMeasuringMode(MeasuringMode mode) { block_[5] = static_cast<Byte>(mode); }
  void setUnit(Unit unit) { block_[6] = unit == Unit::Millimetre ? 1 : 0; }
  bool operator==(const Configuration&) const = default;

 private:
  ByteVector block_;
};
Result<Configuration> parseConfiguration(const Telegram& telegram);  // F4
struct WriteAnswer {                                                 // F7
  bool accepted = false;
  Configuration in_force;
};
Result<WriteAnswer> parseWriteAnswer(const Telegram& telegram);

struct VariantAnswer {  // BB
  bool accepted = false;
  Variant in_force;
};
Result<VariantAnswer> parseVariantAnswer(const Telegram& telegram);

// B2: pairs of type and number.
struct StoredError {
  Byte type = 0, number = 0;
};
std::vector<StoredError> parseErrors(const Telegram& telegram);

}  // namespace tiltmap::lms2xx
