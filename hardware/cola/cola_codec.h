// SICK's CoLa telegrams: frames of both dialects, words of the A dialect, and the scans of LMS1xx, LMS5xx and
// TiM in it. Pure bytes: no clocks, no ports.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap::cola {

enum class Dialect {
  A,  // 02, text, 03
  B,  // 02 02 02 02, length (big-endian), contents, XOR of the contents
};

struct Telegram {
  Dialect dialect = Dialect::A;
  std::string text;  // what stands between the frame's marks; in dialect B not all of it is text
  bool operator==(const Telegram&) const = default;
};

// Throws std::invalid_argument for a text of dialect A that holds 02 or 03.
ByteVector encode(const Telegram& telegram);

// Finds telegrams in a stream however it is cut into portions, and goes on after noise and cut telegrams.
class Reader {
 public:
  static constexpr std::size_t kLongest = 1 << 16;
  struct Damaged {
    bool operator==(const Damaged&) const = default;
  };
  using Item = std::variant<Telegram, Damaged>;

  void push(std::span<const Byte> bytes, std::vector<Item>& items);
  void clear();
  // The beginning of the telegram of dialect A that is under way; empty where there is none.
  std::string_view begun() const;

 private:
  enum class State { Searching, Marks, Text, Length, Contents, Check };
  void take(Byte byte, std::vector<Item>& items);
  State state_ = State::Searching;
  int marks_ = 0;
  std::size_t length_ = 0;
  std::string text_;
};

// A number as telegrams of dialect A hold it: hexadecimal digits, or decimal ones behind a sign; at most 32
// bits, nothing for what is none. `signedNumber` reads FFF92230 as what it means in 32 bits.
std::optional<std::uint32_t> number(std::string_view word);
std::optional<std::int32_t> signedNumber(std::string_view word);
std::string hexNumber(std::uint32_t value);
// "+450000", "-50000".
std::string decimal(std::int32_t value);
// IEEE-754 single in hexadecimal digits, and back; nothing for what is not finite.
std::optional<float> realNumber(std::string_view word);
std::string hexReal(float value);

// One row of numbers of a scan: distances (DIST1), intensities (RSSI1), ...
struct Channel {
  std::string name;
  float scale = 1.0F;  // value * scale + offset; millimetres for distances
  float offset = 0.0F;
  std::int32_t start = 0;  // 1/10000 deg; 90 deg is straight ahead, positive counter-clockwise
  std::uint32_t step = 0;  // 1/10000 deg
  std::vector<std::uint16_t> values;
  bool operator==(const Channel&) const = default;
};

struct Encoder {
  std::uint32_t position = 0;
  std::int32_t speed = 0;
  bool operator==(const Encoder&) const = default;
};

// The telegram LMDscandata. What stands behind the channels (position, name, comment, time, event) is kept as
// it is.
struct Scan {
  bool asked = false;  // sRA instead of sSN
  std::uint32_t version = 1, device = 1, serial = 0;
  std::uint32_t status_high = 0, status_low = 0;
  std::uint32_t telegrams = 0, scans = 0;  // counters
  std::uint32_t measured_us = 0;           // since power-on, modulo 2^32
  std::uint32_t sent_us = 0;
  std::uint32_t inputs_high = 0, inputs_low = 0, outputs_high = 0, outputs_low = 0, reserved = 0;
  std::uint32_t frequency_chz = 0;  // 1/100 Hz
  std::uint32_t measuring_frequency = 0;
  std::vector<Encoder> encoders;
  std::vector<Channel> channels16, channels8;
  std::vector<std::string> rest;

  // Nothing where there is none of that name.
  const Channel* channel(std::string_view name) const;
  bool operator==(const Scan&) const = default;
};

bool isScan(std::string_view text);
// Fails with what is wrong at which word.
Result<Scan> parseScan(std::string_view text);
std::string scanText(const Scan& scan);

// Bits of the device status.
inline constexpr std::uint32_t kDeviceError = 1, kDirty = 2, kVeryDirty = 4;

// LMPscancfg: what is measured.
struct ScanSetting {
  std::uint32_t frequency_chz = 5000;
  std::uint32_t step = 5000;     // 1/10000 deg
  std::int32_t start = -450000;  // 1/10000 deg
  std::int32_t end = 2250000;
  bool operator==(const ScanSetting&) const = default;
};
// The words behind "sRA LMPscancfg" and those behind "sMN mLMPsetscancfg".
Result<ScanSetting> parseSetting(const std::vector<std::string_view>& words);
std::string settingWords(const ScanSetting& setting);
std::string settingRequest(const ScanSetting& setting);
// The other way, from the whole text of a request.
std::optional<ScanSetting> requestedSetting(std::string_view text);

// What the number of an sFA telegram means.
std::string errorText(std::uint32_t number);

}  // namespace tiltmap::cola
