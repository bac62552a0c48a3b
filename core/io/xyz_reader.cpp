// Columns of numbers: .xyz, .txt, .csv, .asc, .pts. What a column means is read from a header line, else
// guessed.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "core/base/text.h"
#include "core/io/point_table.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

constexpr std::size_t kMostColumns = 64;
constexpr std::size_t kNone = kMostColumns;

struct Layout {
  char separator = ' ';        // ' ' stands for any run of blanks
  bool decimal_comma = false;  // 1,5;2,5;0,3
  std::size_t columns = 0;
  std::array<std::size_t, 3> axes{0, 1, 2};
  std::size_t intensity = kNone;
  std::vector<std::string> ignored;
  std::string guess;  // in words; empty where a header line told
};

bool isComment(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#' || text.starts_with("//");
}

std::string lowered(std::string_view text) {
  std::string lower(trimmed(text));
  if (lower.size() > 1 && lower.front() == '"' && lower.back() == '"')
    lower = lower.substr(1, lower.size() - 2);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// The words of a line; a separator at its end is no empty word.
void split(std::string_view line, const Layout& layout, std::vector<std::string_view>& words) {
  words.clear();
  if (layout.separator == ' ') {
    std::string_view word;
    while (words.size() <= kMostColumns && TextCursor::takeWord(line, word)) words.push_back(word);
    return;
  }
  line = trimmed(line);
  if (!line.empty() && line.back() == layout.separator) line.remove_suffix(1);
  for (;;) {
    const std::size_t end = std::min(line.find(layout.separator), line.size());
    words.push_back(trimmed(line.substr(0, end)));
    if (end == line.size() || words.size() > kMostColumns) return;
    line.remove_prefix(end + 1);
  }
}

std::optional<double> number(std::string_view word, const Layout& layout) {
  if (!layout.decimal_comma) return coordinate(word);
  std::string text(word);
  std::ranges::replace(text, ',', '.');
  return coordinate(text);
}

char separatorOf(std::string_view line) {
  for (const char c : {';', ','})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

bool isColour(double v) {
  return v >= 0.0 && v <= 255.0 && std::floor(v) == v;
}

// By the header's names; false where x, y and z are not among them.
bool named(const std::vector<std::string_view>& names, Layout& layout) {
  layout.axes = {kNone, kNone, kNone};
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = lowered(names[i]);
    for (const char* unit : {" (m)", " [m]", "_m", "(m)", "[m]"})
      if (name.size() > 1 && name.ends_with(unit))
        name = name.substr(0, name.size() - std::string_view(unit).size());
    const auto axis = std::string_view("xyz").find(name);
    if (name.size() == 1 && axis != std::string_view::npos && layout.axes[axis] == kNone)
      layout.axes[axis] = i;
    else if (namesIntensity(name) && layout.intensity == kNone)
      layout.intensity = i;
    else
      layout.ignored.push_back(name.empty() ? "column " + std::to_string(i + 1) : name);
  }
  return std::ranges::find(layout.axes, kNone) == layout.axes.end();
}

// By the values of the first line: x y z [intensity] [r g b], x y z [r g b] or x y z [normal].
void guessed(const std::vector<double>& first, Layout& layout) {
  const std::size_t n = first.size();
  const auto colours = [&](std::size_t at) {
    return at + 3 <= n && isColour(first[at]) && isColour(first[at + 1]) && isColour(first[at + 2]);
  };
  layout.guess = "columns taken as x y z";
  std::size_t next = 3;
  if (n == 6 && colours(3)) {
    layout.guess += " red green blue";
    next = 6;
  } else if (n == 6) {
    layout.guess += " and a normal";
    next = 6;
  } else if (n > 3) {
    layout.intensity = 3;
    layout.guess += " intensity";
    next = 4;
    if (n >= 7 && colours(4)) {
      layout.guess += " red green blue";
      next = 7;
    }
  }
  if (next < n) layout.guess += ", and " + std::to_string(n - next) + " more left out";
}

class XyzParser {
 public:
  XyzParser(std::string_view bytes, const ParseContext& context) : cursor_(bytes), context_(context) {}

  Result<Tables> parse() {
    std::string_view line;
    bool first = true;
    for (std::size_t i = 0; cursor_.nextLine(line); ++i) {
      if (context_.stopAt(i)) return context_.cancelled();
      if (isComment(line)) continue;
      if (auto done = first ? start(line) : point(line); !done) return fail(done.error());
      first = false;
    }
    if (table_.points.empty()) return context_.refuse("the file holds no points");
    if (told_ && *told_ != static_cast<long long>(table_.points.size()))
      return context_.refuse("its first line tells of " + std::to_string(*told_) + " points, but there are " +
                             std::to_string(table_.points.size()));
    if (!layout_.guess.empty()) context_.warn(layout_.guess);
    warnIgnored(context_, layout_.ignored);
    table_.columns = static_cast<int>(table_.points.size());
    Tables tables;
    tables.push_back(std::move(table_));
    return tables;
  }

 private:
  tl::unexpected<Error> bad(std::string what, std::string remedy = {}) const {
    return context_.refuseLine(std::move(what), cursor_.lineNumber(), std::move(remedy));
  }

  // The first line that is no comment: names of the columns, a count, or already a point.
  Status start(std::string_view line) {
    layout_.separator = separatorOf(line);
    split(line, layout_, words_);
    if (words_.size() > kMostColumns) return bad("the line has more than 64 columns");
    if (words_.size() == 1 && parseInteger(words_[0])) {
      told_ = parseInteger(words_[0]);
      if (*told_ < 1 || *told_ > kMostCells) return bad("the count is not between 1 and 100 million");
      return {};
    }
    bool words = false;
    for (const std::string_view word : words_)
      words |= !std::ranges::any_of(word, [](char c) { return c >= '0' && c <= '9'; }) && !coordinate(word);
    if (!words) return point(line);
    if (!named(words_, layout_))
      return bad("the first line names no columns x, y and z, and is no point either: " + printable(line),
                 "give the columns names, among them x, y, z, or none at all");
    layout_.columns = words_.size();
    has_names_ = true;
    return {};
  }
  // The first line of numbers settles what the header line has not.
  Status settle(std::string_view line) {
    layout_.separator = separatorOf(line);
    layout_.decimal_comma = layout_.separator == ';' && line.find(',') != std::string_view::npos;
    split(line, layout_, words_);
    if (has_names_) return {};
    if (words_.size() < 3 || words_.size() > kMostColumns)
      return bad("the line has not 3 to 64 columns: " + printable(line));
    layout_.columns = words_.size();
    std::vector<double> values;
    for (const std::string_view word : words_) {
      const auto value = number(word, layout_);
      if (!value) return bad(printable(word) + " is not a number");
      values.push_back(*value);
    }
    guessed(values, layout_);
    return {};
  }
  Status point(std::string_view line) {
    if (table_.points.empty())
      if (auto settled = settle(line); !settled) return settled;
    split(line, layout_, words_);
    if (words_.size() != layout_.columns)
      return bad("the line has " + std::to_string(words_.size()) + " columns, and not " +
                 std::to_string(layout_.columns));
    values_.clear();
    for (const std::string_view word : words_) {
      const auto value = number(word, layout_);
      if (!value) return bad(printable(word) + " is not a number");
      values_.push_back(*value);
    }
    table_.points.emplace_back(values_[layout_.axes[0]], values_[layout_.axes[1]], values_[layout_.axes[2]]);
    if (layout_.intensity != kNone)
      table_.intensity.push_back(static_cast<float>(values_[layout_.intensity]));
    return {};
  }

  TextCursor cursor_;
  const ParseContext& context_;
  Layout layout_;
  bool has_names_ = false;
  std::optional<long long> told_;
  PointTable table_;
  std::vector<std::string_view> words_;
  std::vector<double> values_;
};

}  // namespace

Result<Tables> parseXyz(std::string_view bytes, const ParseContext& context) {
  return XyzParser(bytes, context).parse();
}

}  // namespace tiltmap
