#include "hardware/tilt/mip50_codec.h"

#include <array>
#include <cmath>
#include <utility>

#include "core/base/text.h"

namespace tiltmap {

namespace {

struct VerbPattern {
  Mip50Verb verb;
  std::string Mip50Table::*pattern;
};
constexpr std::array<VerbPattern, 11> kPatterns{{
    {Mip50Verb::ClearError, &Mip50Table::clear_error},
    {Mip50Verb::Ramp, &Mip50Table::ramp},
    {Mip50Verb::Speed, &Mip50Table::speed},
    {Mip50Verb::RegulationOn, &Mip50Table::regulation_on},
    {Mip50Verb::RegulationOff, &Mip50Table::regulation_off},
    {Mip50Verb::Home, &Mip50Table::home},
    {Mip50Verb::MoveAbsolute, &Mip50Table::move_absolute},
    {Mip50Verb::MoveRelative, &Mip50Table::move_relative},
    {Mip50Verb::ReadPosition, &Mip50Table::read_position},
    {Mip50Verb::ReadParameter, &Mip50Table::read_parameter},
    {Mip50Verb::WriteParameter, &Mip50Table::write_parameter},
}};

// What the controller can hold; also keeps digits within what its lines can take.
constexpr double kLargestValue = 2147483647.0;

std::string numberText(double value) {
  if (value == std::floor(value)) return std::to_string(static_cast<long long>(value));
  return shortestReal(value);
}

std::string filled(std::string text, std::string_view part, const std::string& number) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + number.size()))
    text.replace(at, part.size(), number);
  return text;
}

// The digits (and sign, point) at the start of the text, taken from it.
std::string_view takeNumber(std::string_view& text) {
  std::size_t size = 0;
  while (size < text.size() && (std::string_view("0123456789.").find(text[size]) != std::string_view::npos ||
                                (size == 0 && (text[size] == '-' || text[size] == '+'))))
    ++size;
  const std::string_view number = text.substr(0, size);
  text.remove_prefix(size);
  return number;
}

std::optional<double> smallNumber(std::string_view digits) {
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const auto value = parseReal(digits);
  if (!value || !(std::abs(*value) <= kLargestValue)) return std::nullopt;
  return value;
}

bool takeInto(std::string_view& text, std::string_view part, Mip50Command& command) {
  const auto number = smallNumber(takeNumber(text));
  if (!number) return false;
  if (part == "{value}") {
    command.value = *number;
    return true;
  }
  if (*number < 0.0 || *number > 65535.0 || *number != std::floor(*number)) return false;
  (part == "{axis}" ? command.axis : command.parameter) = static_cast<int>(*number);
  return true;
}

std::optional<Mip50Command> matched(const std::string& pattern, Mip50Verb verb, std::string_view text) {
  if (pattern.empty()) return std::nullopt;
  Mip50Command command;
  command.verb = verb;
  for (std::size_t i = 0; i < pattern.size();) {
    const std::string_view rest = std::string_view(pattern).substr(i);
    std::string_view part;
    for (const std::string_view name : {"{axis}", "{value}", "{parameter}"})
      if (rest.starts_with(name)) part = name;
    if (part.empty()) {
      if (text.empty() || text.front() != pattern[i]) return std::nullopt;
      text.remove_prefix(1);
      ++i;
      continue;
    }
    if (!takeInto(text, part, command)) return std::nullopt;
    i += part.size();
  }
  if (!text.empty()) return std::nullopt;
  return command;
}

std::string rightAligned(std::int64_t value, std::size_t width) {
  const std::string digits = std::to_string(value);
  return std::string(width > digits.size() ? width - digits.size() : 0, ' ') + digits;
}

std::optional<int> wholeNumber(std::string_view word) {
  const auto value = parseInteger(word);
  if (!value || *value < 0 || *value > 1'000'000) return std::nullopt;
  return static_cast<int>(*value);
}

std::optional<Mip50Answer> decodeValue(std::string_view text) {
  const std::vector<std::string_view> words = splitWords(text);
  if (words.size() < 2 || words.size() > 8) return std::nullopt;
  const auto number = wholeNumber(words[0]);
  if (!number) return std::nullopt;
  Mip50Value value{*number, {}};
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto parsed = parseInteger(words[i]);
    if (!parsed || std::abs(static_cast<double>(*parsed)) > kLargestValue) return std::nullopt;
    value.values.push_back(*parsed);
  }
  return value;
}

std::optional<Mip50Answer> decodeRefusal(std::string_view text) {
  const std::vector<std::string_view> words = splitWords(text);
  if (words.empty() || words.size() > 4) return std::nullopt;
  const auto number = wholeNumber(words[0]);
  const auto axis = words.size() > 1 ? wholeNumber(words[1]) : std::optional(0);
  if (!number || !axis) return std::nullopt;
  Mip50Refusal refusal{*number, *axis, 0};
  if (words.size() > 2) {
    const std::string_view letter = words[2];
    if (letter.size() != 3 || letter.front() != '\'' || letter.back() != '\'') return std::nullopt;
    refusal.letter = letter[1];
  }
  return refusal;
}

Mip50Answer decodeLine(const Mip50Table& table, std::string_view line) {
  if (line == table.banner) return Mip50Banner{true};
  if (line == table.banner_end) return Mip50Banner{false};
  std::optional<Mip50Answer> answer;
  if (!table.value_prefix.empty() && line.starts_with(table.value_prefix))
    answer = decodeValue(line.substr(table.value_prefix.size()));
  else if (!table.refusal_prefix.empty() && line.starts_with(table.refusal_prefix))
    answer = decodeRefusal(line.substr(table.refusal_prefix.size()));
  return answer ? *answer : Mip50Answer(Mip50Noise{std::string(line)});
}

constexpr const char* kLineEnd = "\r\n";

}  // namespace

std::string encodeCommand(const Mip50Table& table, const Mip50Command& command) {
  for (const VerbPattern& entry : kPatterns) {
    if (entry.verb != command.verb) continue;
    std::string text = filled(table.*entry.pattern, "{axis}", std::to_string(command.axis));
    text = filled(std::move(text), "{parameter}", std::to_string(command.parameter));
    return filled(std::move(text), "{value}", numberText(command.value));
  }
  return {};
}

std::optional<Mip50Command> decodeCommand(const Mip50Table& table, std::string_view text) {
  for (const VerbPattern& entry : kPatterns)
    if (auto command = matched(table.*entry.pattern, entry.verb, text)) return command;
  return std::nullopt;
}

std::string encodeAnswer(const Mip50Table& table, const Mip50Answer& answer) {
  if (std::holds_alternative<Mip50Done>(answer)) return kLineEnd + table.done;
  if (const auto* value = std::get_if<Mip50Value>(&answer)) {
    std::string text = kLineEnd + table.value_prefix + std::to_string(value->number);
    for (std::size_t i = 0; i < value->values.size(); ++i)
      text += rightAligned(value->values[i], i == 0 || i + 1 < value->values.size() ? 5 : 11);
    return text + kLineEnd;
  }
  if (const auto* refusal = std::get_if<Mip50Refusal>(&answer)) {
    std::string text = kLineEnd + table.refusal_prefix + std::to_string(refusal->number) + " " +
                       std::to_string(refusal->axis);
    if (refusal->letter) text += std::string(" '") + refusal->letter + "'";
    return text + kLineEnd;
  }
  if (const auto* banner = std::get_if<Mip50Banner>(&answer))
    return kLineEnd + (banner->entered ? table.banner : table.banner_end) + kLineEnd;
  return kLineEnd + std::get<Mip50Noise>(answer).text + kLineEnd;
}

void Mip50AnswerReader::finishLine(std::vector<Mip50Answer>& answers) {
  if (!line_.empty() && !skipping_) answers.push_back(decodeLine(*table_, line_));
  line_.clear();
  skipping_ = false;
}

void Mip50AnswerReader::take(std::string_view bytes, std::vector<Mip50Answer>& answers) {
  for (const char c : bytes) {
    if (c == '\r' || c == '\n') {
      finishLine(answers);
      continue;
    }
    if (skipping_) continue;
    line_ += c;
    if (!table_->done.empty() && line_ == table_->done) {
      answers.push_back(Mip50Done{});
      line_.clear();
    } else if (line_.size() > kLongestLine) {
      answers.push_back(Mip50Noise{line_});
      line_.clear();
      skipping_ = true;
    }
  }
}

void Mip50AnswerReader::clear() {
  line_.clear();
  skipping_ = false;
}

void Mip50CommandReader::take(std::string_view bytes, std::vector<Item>& items) {
  for (const char c : bytes) {
    if (c == '\r' || c == '\n' || c == ' ') continue;
    text_ += c;
    if (text_.size() > kLongestCommand) {
      text_.clear();
      too_long_ = true;
    }
    if (c != 'G') continue;
    if (too_long_) {
      items.emplace_back(Trouble::TooLong);
    } else if (const auto command = decodeCommand(*table_, text_)) {
      items.emplace_back(*command);
    } else {
      items.emplace_back(Trouble::Unknown);
    }
    text_.clear();
    too_long_ = false;
  }
}

void Mip50CommandReader::clear() {
  text_.clear();
  too_long_ = false;
}

}  // namespace tiltmap
