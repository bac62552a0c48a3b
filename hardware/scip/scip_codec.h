// SCIP 2.0, the lines that Hokuyo scanners speak, both ways. Pure text: no clocks, no ports.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace tiltmap::scip {

// Sum of the characters, its low 6 bits, plus 30 hex.
char checkCharacter(std::string_view text);

// A number in 6-bit digits, most significant first, each plus 30 hex; 2, 3 or 4 of them.
std::string encodeNumber(std::uint32_t value, int characters);
// Nothing where a character is none.
std::optional<std::uint32_t> decodeNumber(std::string_view text);

// What the scanner answers: the command, two characters of status, lines of data; ended by an empty line.
struct Reply {
  std::string echo;
  std::string status;
  std::vector<std::string> lines;  // as they came, check characters and all
  bool operator==(const Reply&) const = default;
};
std::string encodeReply(const Reply& reply);

// Cuts what a scanner sends into replies, however it comes. An empty line ends a reply, so that after noise
// or a lost byte the one after it is understood.
class ReplyReader {
 public:
  static constexpr std::size_t kLongest = 1 << 16;
  struct Damaged {
    bool operator==(const Damaged&) const = default;
  };
  using Item = std::variant<Reply, Damaged>;

  void push(std::string_view bytes, std::vector<Item>& items);
  void clear();
  // The whole lines of the reply under way, and the bytes of it that are here.
  const std::vector<std::string>& begun() const { return lines_; }
  std::size_t bytesHere() const { return size_; }

 private:
  void finish(std::vector<Item>& items);
  std::vector<std::string> lines_;
  std::string line_;
  std::size_t size_ = 0;
  bool too_long_ = false;
};

// A command that orders ranges: GD, GS once; MD, MS, ME as a stream. Two letters, first and last step, how
// many are put together; a stream has scans left out between two, and how many scans (00: without end).
struct ScanOrder {
  std::string letters = "MD";
  int first = 0, last = 0;
  int cluster = 1;
  int skip = 0;
  int count = 0;

  bool stream() const { return !letters.empty() && letters.front() == 'M'; }
  bool intensities() const { return letters == "ME" || letters == "GE"; }
  int characters() const { return letters == "MS" || letters == "GS" ? 2 : 3; }
  int values() const { return (last - first) / cluster + 1; }
  bool operator==(const ScanOrder&) const = default;
};
std::string encodeOrder(const ScanOrder& order);
std::optional<ScanOrder> parseOrder(std::string_view text);

// Lines "KEY:VALUE;c" of VV, PP and II.
using Properties = std::vector<std::pair<std::string, std::string>>;
std::vector<std::string> encodeProperties(const Properties& properties);
// Fails at a line whose check character is wrong; the one of firmware that counts the semicolon is taken too.
Result<Properties> parseProperties(const std::vector<std::string>& lines);
std::string property(const Properties& properties, std::string_view key);

// What PP tells: steps of a turn, and where they look.
struct Parameters {
  std::string model;
  int nearest_mm = 20, furthest_mm = 5600;  // DMIN, DMAX: less than DMIN is a code
  int steps_per_turn = 1024;                // ARES
  int first = 44, last = 725;               // AMIN, AMAX
  int front = 384;                          // AFRT
  int rpm = 600;                            // SCAN
  bool operator==(const Parameters&) const = default;

  int columns() const { return last - first + 1; }
  // In the scan frame: 0 right, pi/2 ahead, counter-clockwise from above as the steps.
  double azimuthStart() const;
  double azimuthStep() const;
};
Result<Parameters> parseParameters(const Properties& properties);
Properties parameterProperties(const Parameters& parameters);

struct ScanData {
  std::uint32_t time_ms = 0;               // 24 bits
  std::vector<std::uint32_t> values;       // ranges in mm, or codes
  std::vector<std::uint32_t> intensities;  // empty without
  bool operator==(const ScanData&) const = default;
};
// Time stamp and values as the lines of a reply: 64 characters and a check character each.
std::vector<std::string> encodeScan(const ScanData& data, int characters);
// Fails where a check character is wrong or the number of values is another one.
Result<ScanData> parseScan(const std::vector<std::string>& lines, const ScanOrder& order);

// What a status other than 00 and 99 means.
std::string statusText(std::string_view status);

}  // namespace tiltmap::scip
