// Walking through the bytes of a text file line by line, knowing where one is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tiltmap {

// Lines end with LF or CR LF, mixed as they like; the last one need not end. Header only: the loops over a
// million lines want it inlined.
class TextCursor {
 public:
  explicit TextCursor(std::string_view bytes) : bytes_(bytes) {}

  // False at the end. The line comes without its end.
  bool nextLine(std::string_view& line) {
    if (at_ >= bytes_.size()) return false;
    line_start_ = at_;
    std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) end = bytes_.size();
    line = bytes_.substr(at_, end - at_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at_ = end < bytes_.size() ? end + 1 : end;
    ++line_number_;
    return true;
  }
  // The next word, over line ends; false at the end.
  bool nextWord(std::string_view& word) {
    while (at_ < bytes_.size() && isBlank(bytes_[at_])) {
      if (bytes_[at_] == '\n') ++line_number_;
      ++at_;
    }
    const std::size_t start = at_;
    while (at_ < bytes_.size() && !isBlank(bytes_[at_])) ++at_;
    word = bytes_.substr(start, at_ - start);
    return !word.empty();
  }
  // Takes the next word out of a line; false where there is none.
  static bool takeWord(std::string_view& line, std::string_view& word) {
    std::size_t start = 0;
    while (start < line.size() && isBlank(line[start])) ++start;
    std::size_t end = start;
    while (end < line.size() && !isBlank(line[end])) ++end;
    word = line.substr(start, end - start);
    line.remove_prefix(end);
    return !word.empty();
  }
  // Not the vertical tab and form feed: other readers take them for parts of words.
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::size_t position() const { return at_; }  // byte after what was taken last
  void seek(std::size_t position) { at_ = position; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  std::string_view rest() const { return bytes_.substr(at_); }
  // Only blanks are left.
  bool onlyBlanksLeft() const {
    for (std::size_t i = at_; i < bytes_.size(); ++i)
      if (!isBlank(bytes_[i])) return false;
    return true;
  }
  // Of the line taken last (nextLine), or of the word taken last (nextWord, counted from 1 by passing ends).
  std::size_t lineNumber() const { return line_number_; }
  std::size_t lineStart() const { return line_start_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  std::size_t line_number_ = 0;
};

}  // namespace tiltmap
