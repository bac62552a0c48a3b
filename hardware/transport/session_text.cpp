// The text of a recorded session.
#include <optional>

#include "core/base/text.h"
#include "hardware/transport/session_log.h"

namespace tiltmap {

namespace {

constexpr std::string_view kFirstLine = "# tiltmap wire session 1";
constexpr std::string_view kBegun = "# begun ";

std::string lineText(const LineSettings& line) {
  const char* format = line.parity == Parity::Even ? "8E1" : line.parity == Parity::Odd ? "8O1" : "8N1";
  return std::to_string(line.baud) + " " + format;
}

std::optional<LineSettings> parseLine(std::string_view text) {
  const auto words = splitWords(text);
  if (words.size() != 2) return std::nullopt;
  const auto baud = parseInteger(words[0]);
  if (!baud || *baud <= 0 || *baud > 10'000'000) return std::nullopt;
  LineSettings line{static_cast<int>(*baud)};
  if (words[1] == "8E1")
    line.parity = Parity::Even;
  else if (words[1] == "8O1")
    line.parity = Parity::Odd;
  else if (words[1] != "8N1")
    return std::nullopt;
  return line;
}

std::optional<WireRecord> parseRecord(std::string_view text) {
  const auto blank = text.find(' ');
  if (blank == std::string_view::npos || blank + 1 >= text.size()) return std::nullopt;
  const auto seconds = parseReal(text.substr(0, blank));
  if (!seconds || !(*seconds >= 0.0) || !(*seconds < 1e9)) return std::nullopt;
  WireRecord record;
  record.at = durationOf(*seconds);
  const char kind = text[blank + 1];
  const std::string_view rest = trimmed(text.substr(blank + 2));
  if (kind == '!' || kind == '@') {
    record.kind = kind == '!' ? WireRecord::Kind::Lost : WireRecord::Kind::Opened;
    record.text = std::string(rest);
    return record;
  }
  if (kind == '=') {
    const auto line = parseLine(rest);
    if (!line) return std::nullopt;
    record.kind = WireRecord::Kind::Line;
    record.line = *line;
    return record;
  }
  if (kind != '>' && kind != '<') return std::nullopt;
  auto bytes = parseHex(rest);
  if (!bytes || bytes->empty()) return std::nullopt;
  record.kind = kind == '>' ? WireRecord::Kind::Sent : WireRecord::Kind::Received;
  record.bytes = std::move(*bytes);
  return record;
}

// Texts stay on their line.
std::string onOneLine(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

}  // namespace

std::string recordText(const WireRecord& record) {
  const std::string text = fixedReal(secondsOf(record.at), 9);
  switch (record.kind) {
    case WireRecord::Kind::Opened:
      return text + " @ " + onOneLine(record.text) + "\n";
    case WireRecord::Kind::Line:
      return text + " = " + lineText(record.line) + "\n";
    case WireRecord::Kind::Sent:
      return text + " > " + hexText(record.bytes) + "\n";
    case WireRecord::Kind::Received:
      return text + " < " + hexText(record.bytes) + "\n";
    case WireRecord::Kind::Lost:
      break;
  }
  return text + " ! " + onOneLine(record.text) + "\n";
}

Result<WireSession> parseSession(std::string_view text, const std::string& where) {
  WireSession session;
  Duration last{};
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) break;  // cut off when the program or the machine ended
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    const std::string place = where + ", line " + std::to_string(number);
    if (number == 1) {
      if (trimmed(line) != kFirstLine)
        return fail("this is no recorded session", place, "give a file that was made with ?log=");
    } else if (line.starts_with(kBegun)) {
      session.begun_unix_s = parseReal(trimmed(line.substr(kBegun.size()))).value_or(0.0);
    } else if (line.starts_with('#')) {
      if (number == 2) session.about = std::string(trimmed(line.substr(1)));
    } else {
      auto record = parseRecord(trimmed(line));
      if (!record || record->at < last)
        return fail("this is no record of a session: " + printable(line), place,
                    "a record is `SECONDS > BYTES`, with >, <, =, @ or !, in order of time");
      last = record->at;
      session.records.push_back(std::move(*record));
    }
  }
  return session;
}

std::string sessionHead(const std::string& about, double begun_unix_s) {
  return std::string(kFirstLine) + "\n# " + onOneLine(about) + "\n" + std::string(kBegun) +
         fixedReal(begun_unix_s, 6) + "\n";
}

}  // namespace tiltmap
