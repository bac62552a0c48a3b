#include "hardware/tilt/mip50_table.h"

#include <cstdio>
#include <fstream>
#include <sstream>
#include <variant>
#include <vector>

#include "core/base/text.h"

namespace tiltmap {

namespace {

using Member = std::variant<std::string Mip50Table::*, int Mip50Table::*, double Mip50Table::*>;

struct Line {
  const char* name;
  Member member;
  const char* needs;  // placeholders a command must have, by their first letters: a, v, p
  const char* remark;
};

const std::vector<Line>& lines() {
  using T = Mip50Table;
  static const std::vector<Line> all = {
      {"clear-error", &T::clear_error, "a", "clears an error; seen working"},
      {"ramp", &T::ramp, "av", "acceleration and deceleration, counts/ms2; seen working, arguments inferred"},
      {"speed", &T::speed, "av", "positioning speed, counts/ms; seen working"},
      {"regulation-on", &T::regulation_on, "a", "holds the position; seen working"},
      {"regulation-off", &T::regulation_off, "a", "lets go; seen working"},
      {"home", &T::home, "a", "searches home; seen working"},
      {"move-absolute", &T::move_absolute, "av", "counts; seen working"},
      {"move-relative", &T::move_relative, "av", "counts; not used by the driver"},
      {"read-position", &T::read_position, "a", "seen working"},
      {"read-parameter", &T::read_parameter, "ap", "seen working"},
      {"write-parameter", &T::write_parameter, "apv", "permanent; not used by the driver"},
      {"enter-ascii", &T::enter_ascii, "", "from the text menu into the ASCII mode"},
      {"leave-ascii", &T::leave_ascii, "", "back to the text menu"},
      {"interrupt", &T::interrupt, "",
       "stops a move: to the text menu, whose carriage return stops; not tried. Empty: no steady moves"},
      {"command-end", &T::command_end, "", "sent after each command"},
      {"done", &T::done, "", "a command is completed; after a move: the motion has ended"},
      {"value-prefix", &T::value_prefix, "", "begins an answer with a value"},
      {"refusal-prefix", &T::refusal_prefix, "", "begins a refusal"},
      {"banner", &T::banner, "", "at power-on and on entering the ASCII mode"},
      {"banner-end", &T::banner_end, "", "on leaving it"},
      {"position-number", &T::position_number, "", "number of the answer with a position"},
      {"error-number", &T::error_number, "", "number of the answer with an error's number"},
      {"parameter-number", &T::parameter_number, "", "number of the answer with a parameter"},
      {"answer", &T::answer_s, "", "seconds until a command that moves nothing is answered"},
      {"move-factor", &T::move_factor, "", "a move may take so many times its computed duration"},
      {"move-extra", &T::move_extra_s, "", "and so many seconds more"},
      {"home-limit", &T::home_limit_s, "", "seconds until homing has ended"},
      {"repeats", &T::repeats, "", "of a command that was not answered"},
  };
  return all;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\r') {
      result += "\\r";
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (c == '\\') {
      result += "\\\\";
    } else if (byte < 0x20 || byte >= 0x7F || c == '#') {
      char code[8];
      std::snprintf(code, sizeof code, "\\x%02X", static_cast<unsigned>(byte));
      result += code;
    } else {
      result += c;
    }
  }
  if (result.starts_with(' ')) result.replace(0, 1, "\\s");
  if (result.ends_with(' ')) result.replace(result.size() - 1, 1, "\\s");
  return result;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Nothing for a backslash that begins nothing known.
std::optional<std::string> unescaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      result += text[i];
      continue;
    }
    if (++i == text.size()) return std::nullopt;
    switch (text[i]) {
      case 'r':
        result += '\r';
        break;
      case 'n':
        result += '\n';
        break;
      case 't':
        result += '\t';
        break;
      case 's':
        result += ' ';
        break;
      case '\\':
        result += '\\';
        break;
      case 'x': {
        if (i + 2 >= text.size()) return std::nullopt;
        const int high = hexDigit(text[i + 1]), low = hexDigit(text[i + 2]);
        if (high < 0 || low < 0) return std::nullopt;
        result += static_cast<char>(16 * high + low);
        i += 2;
        break;
      }
      default:
        return std::nullopt;
    }
  }
  return result;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Line& line : lines()) all.emplace_back(line.name);
  return all;
}

std::string missingPart(const Line& line, const std::string& pattern) {
  if (pattern.empty()) return {};
  for (const char* need = line.needs; *need; ++need) {
    const std::string part = *need == 'a' ? "{axis}" : *need == 'v' ? "{value}" : "{parameter}";
    if (pattern.find(part) == std::string::npos) return part;
  }
  return {};
}

Status setMember(Mip50Table& table, const Line& line, std::string_view value, const std::string& where) {
  if (const auto* text = std::get_if<std::string Mip50Table::*>(&line.member)) {
    const auto plain = unescaped(value);
    if (!plain)
      return fail("a backslash in " + std::string(line.name) + " stands before nothing known", where,
                  "use \\r, \\n, \\t, \\s, \\\\ or \\xNN");
    if (const std::string part = missingPart(line, *plain); !part.empty())
      return fail(std::string(line.name) + " lacks " + part, where,
                  "say with " + part + " where the number goes; leave the whole command empty to do without");
    table.*(*text) = *plain;
    return {};
  }
  if (const auto* number = std::get_if<int Mip50Table::*>(&line.member)) {
    const auto parsed = parseInteger(value);
    if (!parsed || *parsed < 0 || *parsed > 1'000'000)
      return fail(std::string(line.name) + " wants a whole number, not \"" + printable(value) + "\"", where,
                  "write a number from 0 on");
    table.*(*number) = static_cast<int>(*parsed);
    return {};
  }
  const auto parsed = parseReal(value);
  if (!parsed || !(*parsed > 0.0 && *parsed <= 3600.0))
    return fail(std::string(line.name) + " wants a number, not \"" + printable(value) + "\"", where,
                "write a number above 0 and at most 3600");
  table.*std::get<double Mip50Table::*>(line.member) = *parsed;
  return {};
}

Status setLine(Mip50Table& table, std::string_view name, std::string_view value, const std::string& where) {
  for (const Line& line : lines())
    if (name == line.name) return setMember(table, line, value, where);
  for (const auto& [prefix, texts] :
       {std::pair{std::string_view("refusal."), &table.refusals}, {"error.", &table.errors}}) {
    if (!name.starts_with(prefix)) continue;
    const auto number = parseInteger(name.substr(prefix.size()));
    const auto text = unescaped(value);
    if (!number || *number < 0 || *number > 1'000'000 || !text)
      return fail(printable(name) + " does not name a number", where, "write for example refusal.180");
    (*texts)[static_cast<int>(*number)] = *text;
    return {};
  }
  const auto nearest = nearestName(name, names());
  return fail(
      "there is no entry \"" + printable(name) + "\"", where,
      nearest ? "did you mean " + *nearest + "?" : "the manual's page on capturing lists the entries");
}

}  // namespace

Result<Mip50Table> parseMip50Table(std::string_view text, const std::string& where) {
  Mip50Table table;
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    line = trimmed(line.substr(0, line.find('#')));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    const std::string here = where + ", line " + std::to_string(number);
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos)
      return fail(printable(line) + " is not of the form name = value", here,
                  "write name = value, or # before a remark");
    if (Status status =
            setLine(table, trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)), here);
        !status)
      return fail(status.error());
  }
  return table;
}

Result<Mip50Table> readMip50Table(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  if (!stream || !(text << stream.rdbuf()))
    return fail("the table of the tilt controller cannot be read", file.string(),
                "check the file's name; without one the built-in table is used");
  return parseMip50Table(text.str(), file.string());
}

std::string mip50TableText(const Mip50Table& table) {
  std::string text =
      "# What is sent to and expected from a maxon MIP 50 in its ASCII mode. {axis}, {value} and "
      "{parameter}\n"
      "# stand for numbers; \\r, \\n, \\t, \\s (blank) and \\xNN for characters. \"seen working\" is what "
      "public\n"
      "# software is known to do with real controllers; nothing here has been tried by us.\n";
  for (const Line& line : lines()) {
    std::string value;
    if (const auto* member = std::get_if<std::string Mip50Table::*>(&line.member)) {
      value = escaped(table.*(*member));
    } else if (const auto* number = std::get_if<int Mip50Table::*>(&line.member)) {
      value = std::to_string(table.*(*number));
    } else {
      value = shortestReal(table.*std::get<double Mip50Table::*>(line.member));
    }
    std::string entry = std::string(line.name) + " = " + value;
    entry.resize(std::max<std::size_t>(entry.size(), 46), ' ');
    text += entry + "  # " + line.remark + "\n";
  }
  text += "# 180 and 181 have been seen; the other numbers are inferred from the order of the texts.\n";
  for (const auto& [number, meaning] : table.refusals)
    text += "refusal." + std::to_string(number) + " = " + escaped(meaning) + "\n";
  for (const auto& [number, meaning] : table.errors)
    text += "error." + std::to_string(number) + " = " + escaped(meaning) + "\n";
  return text;
}

}  // namespace tiltmap
