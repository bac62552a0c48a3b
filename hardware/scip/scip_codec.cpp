#include "hardware/scip/scip_codec.h"

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "core/base/text.h"

namespace tiltmap::scip {

namespace {

constexpr std::size_t kLine = 64;
constexpr int kTimeCharacters = 4;
constexpr std::size_t kMostLines = 4096;

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

// "0044": exactly so many digits.
std::optional<int> digits(std::string_view text) {
  if (!std::ranges::all_of(text, isDigit) || text.empty()) return std::nullopt;
  int value = 0;
  for (const char c : text) value = 10 * value + (c - '0');
  return value;
}

std::string withCheck(std::string text) {
  text += checkCharacter(text);
  return text;
}

// What stands before a check character; nothing where that is wrong.
std::optional<std::string_view> checked(std::string_view line) {
  if (line.size() < 2 || checkCharacter(line.substr(0, line.size() - 1)) != line.back()) return std::nullopt;
  return line.substr(0, line.size() - 1);
}

}  // namespace

char checkCharacter(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3F) + 0x30);
}

std::string encodeNumber(std::uint32_t value, int characters) {
  std::string text;
  for (int i = characters - 1; i >= 0; --i) text += static_cast<char>((value >> (6 * i) & 0x3F) + 0x30);
  return text;
}

std::optional<std::uint32_t> decodeNumber(std::string_view text) {
  std::uint32_t value = 0;
  if (text.empty() || text.size() > 4) return std::nullopt;
  for (const char c : text) {
    if (c < 0x30 || c > 0x6F) return std::nullopt;
    value = value << 6 | static_cast<std::uint32_t>(c - 0x30);
  }
  return value;
}

std::string encodeReply(const Reply& reply) {
  std::string text = reply.echo + "\n" + withCheck(reply.status) + "\n";
  for (const std::string& line : reply.lines) text += line + "\n";
  return text + "\n";
}

void ReplyReader::clear() {
  lines_.clear();
  line_.clear();
  size_ = 0;
  too_long_ = false;
}

void ReplyReader::finish(std::vector<Item>& items) {
  const bool damaged =
      too_long_ || lines_.size() < 2 || lines_[0].empty() || lines_[1].size() != 3 || !checked(lines_[1]);
  if (damaged) {
    items.emplace_back(Damaged{});
  } else {
    Reply reply{std::move(lines_[0]), lines_[1].substr(0, 2), {}};
    reply.lines.assign(std::make_move_iterator(lines_.begin() + 2), std::make_move_iterator(lines_.end()));
    items.emplace_back(std::move(reply));
  }
  clear();
}

void ReplyReader::push(std::string_view bytes, std::vector<Item>& items) {
  for (const char c : bytes) {
    ++size_;
    if (c != '\n') {
      if (size_ >= kLongest) {
        // What stands in the line does not matter any more, only that it is not empty.
        too_long_ = true;
        line_.clear();
      }
      line_ += c;
      continue;
    }
    if (line_.empty()) {
      // An empty line where nothing has begun is nothing.
      if (lines_.empty() && !too_long_)
        clear();
      else
        finish(items);
      continue;
    }
    if (lines_.size() < kMostLines && !too_long_)
      lines_.push_back(std::move(line_));
    else
      too_long_ = true;
    line_.clear();
  }
}

std::string encodeOrder(const ScanOrder& order) {
  char text[48];
  const int length = order.stream()
                         ? std::snprintf(text, sizeof text, "%s%04d%04d%02d%1d%02d", order.letters.c_str(),
                                         order.first, order.last, order.cluster, order.skip, order.count)
                         : std::snprintf(text, sizeof text, "%s%04d%04d%02d", order.letters.c_str(),
                                         order.first, order.last, order.cluster);
  return {text, static_cast<std::size_t>(length)};
}

std::optional<ScanOrder> parseOrder(std::string_view text) {
  static const std::vector<std::string_view> kLetters{"GD", "GS", "GE", "MD", "MS", "ME"};
  if (std::ranges::find(kLetters, text.substr(0, 2)) == kLetters.end()) return std::nullopt;
  ScanOrder order;
  order.letters = std::string(text.substr(0, 2));
  if (text.size() != (order.stream() ? 15U : 12U)) return std::nullopt;
  const auto first = digits(text.substr(2, 4)), last = digits(text.substr(6, 4)),
             cluster = digits(text.substr(10, 2));
  if (!first || !last || !cluster || *last < *first) return std::nullopt;
  order.first = *first;
  order.last = *last;
  // 00 means each step, as 01 does.
  order.cluster = std::max(1, *cluster);
  if (order.stream()) {
    const auto skip = digits(text.substr(12, 1)), count = digits(text.substr(13, 2));
    if (!skip || !count) return std::nullopt;
    order.skip = *skip;
    order.count = *count;
  }
  return order;
}

std::vector<std::string> encodeProperties(const Properties& properties) {
  std::vector<std::string> lines;
  for (const auto& [key, value] : properties) {
    const std::string text = key + ":" + value;
    lines.push_back(text + ";" + checkCharacter(text));
  }
  return lines;
}

Result<Properties> parseProperties(const std::vector<std::string>& lines) {
  Properties properties;
  for (const std::string& line : lines) {
    const auto end = line.size() >= 3 ? line.rfind(';', line.size() - 2) : std::string::npos;
    const auto colon = line.find(':');
    const std::string_view text = std::string_view(line).substr(0, end == std::string::npos ? 0 : end);
    if (end == std::string::npos || end + 2 != line.size() || colon == std::string::npos || colon > end ||
        (checkCharacter(text) != line.back() &&
         checkCharacter(std::string_view(line).substr(0, end + 1)) != line.back()))
      return fail("a line of the scanner's description arrived damaged", printable(line), "try again");
    properties.emplace_back(line.substr(0, colon), line.substr(colon + 1, end - colon - 1));
  }
  return properties;
}

std::string property(const Properties& properties, std::string_view key) {
  for (const auto& [name, value] : properties)
    if (name == key) return value;
  return {};
}

double Parameters::azimuthStep() const {
  return 2.0 * std::numbers::pi / steps_per_turn;
}
double Parameters::azimuthStart() const {
  return 0.5 * std::numbers::pi + (first - front) * azimuthStep();
}

Result<Parameters> parseParameters(const Properties& properties) {
  Parameters p;
  p.model = property(properties, "MODL");
  for (const auto& [key, field] : {std::pair{"DMIN", &p.nearest_mm},
                                   {"DMAX", &p.furthest_mm},
                                   {"ARES", &p.steps_per_turn},
                                   {"AMIN", &p.first},
                                   {"AMAX", &p.last},
                                   {"AFRT", &p.front},
                                   {"SCAN", &p.rpm}}) {
    const auto value = parseInteger(property(properties, key));
    if (!value || *value < 0 || *value > 1'000'000)
      return fail(std::string("the scanner does not tell its ") + key, p.model,
                  "record the session (?log=FILE) and report it");
    *field = static_cast<int>(*value);
  }
  if (p.steps_per_turn < 1 || p.rpm < 1 || p.last <= p.first || p.columns() > p.steps_per_turn ||
      p.last > 9999)
    return fail("what the scanner tells of its steps does not fit together", p.model,
                "record the session (?log=FILE) and report it");
  return p;
}

Properties parameterProperties(const Parameters& p) {
  return {{"MODL", p.model},
          {"DMIN", std::to_string(p.nearest_mm)},
          {"DMAX", std::to_string(p.furthest_mm)},
          {"ARES", std::to_string(p.steps_per_turn)},
          {"AMIN", std::to_string(p.first)},
          {"AMAX", std::to_string(p.last)},
          {"AFRT", std::to_string(p.front)},
          {"SCAN", std::to_string(p.rpm)}};
}

std::vector<std::string> encodeScan(const ScanData& data, int characters) {
  if (!data.intensities.empty() && data.intensities.size() != data.values.size())
    throw std::invalid_argument("scip::encodeScan: one intensity a value");
  std::vector<std::string> lines{withCheck(encodeNumber(data.time_ms, kTimeCharacters))};
  std::string all;
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    all += encodeNumber(data.values[i], characters);
    if (!data.intensities.empty()) all += encodeNumber(data.intensities[i], characters);
  }
  for (std::size_t i = 0; i < all.size(); i += kLine) lines.push_back(withCheck(all.substr(i, kLine)));
  return lines;
}

Result<ScanData> parseScan(const std::vector<std::string>& lines, const ScanOrder& order) {
  const auto damaged = [] { return fail("the scan arrived damaged", "", "it is measured again"); };
  if (lines.empty()) return damaged();
  const auto time = checked(lines.front());
  const auto stamp = time && time->size() == kTimeCharacters ? decodeNumber(*time) : std::nullopt;
  if (!stamp) return damaged();
  ScanData data;
  data.time_ms = *stamp;
  std::string all;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto text = checked(lines[i]);
    // Only the last line may be shorter.
    if (!text || text->size() > kLine || (i + 1 < lines.size() && text->size() != kLine)) return damaged();
    all += *text;
  }
  const auto width = static_cast<std::size_t>(order.characters());
  const auto count = static_cast<std::size_t>(order.values());
  if (all.size() != count * width * (order.intensities() ? 2 : 1)) return damaged();
  for (std::size_t at = 0; at < all.size();) {
    for (auto* list : {&data.values, &data.intensities}) {
      if (list == &data.intensities && !order.intensities()) continue;
      const auto value = decodeNumber(std::string_view(all).substr(at, width));
      if (!value) return damaged();
      list->push_back(*value);
      at += width;
    }
  }
  return data;
}

std::string statusText(std::string_view status) {
  const auto named = [&]() -> const char* {
    if (status == "0E") return "it does not know the command, or adjusts its clock";
    if (status == "0L" || status == "0M") return "its laser or its motor has trouble";
    if (status == "10") return "its laser is off";
    if (status == "01" || status == "02" || status == "03" || status == "04" || status == "05" ||
        status == "06")
      return "it does not take the steps it was asked for";
    return nullptr;
  }();
  return (named ? std::string(named) + " (status " : "status (") + printable(status) + ")";
}

}  // namespace tiltmap::scip
