#include "hardware/cola/cola_codec.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "core/base/text.h"

namespace tiltmap::cola {

namespace {

constexpr Byte kStart = 0x02, kEnd = 0x03;
constexpr int kMarksOfB = 4;

}  // namespace

ByteVector encode(const Telegram& telegram) {
  const std::string& text = telegram.text;
  ByteVector bytes;
  bytes.reserve(text.size() + 9);
  if (telegram.dialect == Dialect::A) {
    if (text.find_first_of("\x02\x03") != std::string::npos)
      throw std::invalid_argument("cola::encode: a mark within the text");
    bytes.push_back(kStart);
    for (const char c : text) bytes.push_back(static_cast<Byte>(c));
    bytes.push_back(kEnd);
    return bytes;
  }
  for (int i = 0; i < kMarksOfB; ++i) bytes.push_back(kStart);
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<Byte>(text.size() >> shift & 0xFF));
  Byte check = 0;
  for (const char c : text) {
    bytes.push_back(static_cast<Byte>(c));
    check ^= static_cast<Byte>(c);
  }
  bytes.push_back(check);
  return bytes;
}

void Reader::clear() {
  state_ = State::Searching;
  text_.clear();
}

std::string_view Reader::begun() const {
  return state_ == State::Text ? std::string_view(text_) : std::string_view();
}

void Reader::take(Byte byte, std::vector<Item>& items) {
  const auto begin = [this] {
    state_ = State::Marks;
    marks_ = 1;
    text_.clear();
  };
  switch (state_) {
    case State::Searching:
      if (byte == kStart) begin();
      return;
    case State::Marks:
      if (byte == kStart) {
        if (++marks_ == kMarksOfB) {
          state_ = State::Length;
          marks_ = 0;
          length_ = 0;
        }
        return;
      }
      // Two or three marks in a row are noise before the telegram.
      state_ = State::Text;
      [[fallthrough]];
    case State::Text:
      if (byte == kStart) {
        items.emplace_back(Damaged{});
        begin();
      } else if (byte == kEnd) {
        items.emplace_back(Telegram{Dialect::A, std::move(text_)});
        clear();
      } else if (text_.size() >= kLongest) {
        items.emplace_back(Damaged{});
        clear();
      } else {
        text_ += static_cast<char>(byte);
      }
      return;
    case State::Length:
      length_ = length_ << 8 | byte;
      if (++marks_ < 4) return;
      state_ = length_ == 0 ? State::Check : State::Contents;
      if (length_ > kLongest) {
        items.emplace_back(Damaged{});
        clear();
      }
      return;
    case State::Contents:
      text_ += static_cast<char>(byte);
      if (text_.size() == length_) state_ = State::Check;
      return;
    case State::Check: {
      Byte check = 0;
      for (const char c : text_) check ^= static_cast<Byte>(c);
      if (check == byte)
        items.emplace_back(Telegram{Dialect::B, std::move(text_)});
      else
        items.emplace_back(Damaged{});
      clear();
      return;
    }
  }
}

void Reader::push(std::span<const Byte> bytes, std::vector<Item>& items) {
  for (const Byte byte : bytes) take(byte, items);
}

std::optional<std::uint32_t> number(std::string_view word) {
  if (word.empty()) return std::nullopt;
  if (word.front() == '+' || word.front() == '-') {
    const auto value = parseInteger(word.front() == '+' ? word.substr(1) : word);
    if (!value || word.size() < 2 || word[1] == '+' || word[1] == '-' || *value < -2147483648LL ||
        *value > 4294967295LL)
      return std::nullopt;
    return static_cast<std::uint32_t>(*value);
  }
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, 16);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::int32_t> signedNumber(std::string_view word) {
  const auto value = number(word);
  if (!value) return std::nullopt;
  return static_cast<std::int32_t>(*value);
}

std::string hexNumber(std::uint32_t value) {
  char text[16];
  const auto end = std::to_chars(text, text + sizeof text, value, 16).ptr;
  std::string result(text, end);
  for (char& c : result)
    if (c >= 'a') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

std::string decimal(std::int32_t value) {
  return (value < 0 ? "" : "+") + std::to_string(value);
}

std::optional<float> realNumber(std::string_view word) {
  const auto bits = number(word);
  if (!bits || word.front() == '+' || word.front() == '-') return std::nullopt;
  const float value = std::bit_cast<float>(*bits);
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::string hexReal(float value) {
  std::string text = hexNumber(std::bit_cast<std::uint32_t>(value));
  return std::string(8 - text.size(), '0') + text;
}

Result<ScanSetting> parseSetting(const std::vector<std::string_view>& words) {
  const auto wrong = [] {
    return fail("the scanner's setting is not understood", "LMPscancfg",
                "record the session (?log=FILE) and report it");
  };
  // Frequency, number of sectors (one), resolution, start, end.
  if (words.size() < 5) return wrong();
  const auto frequency = number(words[0]), sectors = number(words[1]), step = number(words[2]);
  const auto start = signedNumber(words[3]), end = signedNumber(words[4]);
  if (!frequency || !sectors || !step || !start || !end) return wrong();
  return ScanSetting{*frequency, *step, *start, *end};
}

std::string settingWords(const ScanSetting& setting) {
  return hexNumber(setting.frequency_chz) + " 1 " + hexNumber(setting.step) + " " +
         hexNumber(static_cast<std::uint32_t>(setting.start)) + " " +
         hexNumber(static_cast<std::uint32_t>(setting.end));
}

std::string settingRequest(const ScanSetting& setting) {
  return "sMN mLMPsetscancfg " + decimal(static_cast<std::int32_t>(setting.frequency_chz)) + " +1 " +
         decimal(static_cast<std::int32_t>(setting.step)) + " " + decimal(setting.start) + " " +
         decimal(setting.end);
}

std::optional<ScanSetting> requestedSetting(std::string_view text) {
  auto words = splitAt(text, ' ');
  if (words.size() < 7 || words[0] != "sMN" || words[1] != "mLMPsetscancfg") return std::nullopt;
  words.erase(words.begin(), words.begin() + 2);
  const auto setting = parseSetting(words);
  return setting ? std::optional(*setting) : std::nullopt;
}

std::string errorText(std::uint32_t number) {
  const auto named = [&]() -> const char* {
    switch (number) {
      case 1:
        return "access denied: the level of access is too low";
      case 2:
        return "it knows no such method";
      case 3:
        return "it knows no such variable";
      case 5:
        return "a value is missing";
      case 6:
        return "a value is of a wrong kind";
      case 8:
        return "out of range";
      default:
        return nullptr;
    }
  }();
  return (named ? std::string(named) + " (" : "its error (") + std::to_string(number) + ")";
}

}  // namespace tiltmap::cola
