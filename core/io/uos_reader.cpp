// 3DTK's .3d files: a line a point, x y z in centimetres, left-handed (x right, y up, z forward), then
// perhaps a reflectance and a colour; no header as a rule, but some begin with a line of counts.
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/io/point_table.h"
#include "core/io/pose_file.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

// Rows x columns, or a number of points as 1 x N, as the first line tells it.
struct Counts {
  long long rows = 1;
  long long columns = 0;
};

bool skipped(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#';
}

// One or two whole numbers and nothing else: counts, since a point has three numbers at least.
Result<std::optional<Counts>> countsOf(std::string_view line, std::size_t number,
                                       const ParseContext& context) {
  const auto words = splitWords(line);
  if (words.size() > 2) return std::optional<Counts>();
  std::array<long long, 2> value{1, 1};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto integer = parseInteger(words[i]);
    if (!integer) return context.refuseLine(printable(words[i]) + " is neither a point nor a count", number);
    if (*integer < 1 || *integer > kMostCells)
      return context.refuseLine("the count " + std::to_string(*integer) + " is not between 1 and 100 million",
                                number);
    value[i] = *integer;
  }
  if (words.size() == 1) return std::optional<Counts>(Counts{1, value[0]});
  return std::optional<Counts>(Counts{value[0], value[1]});
}

}  // namespace

Result<Tables> parseUos(std::string_view bytes, const ParseContext& context) {
  TextCursor cursor(bytes);
  PointTable table;
  std::optional<Counts> counts;
  std::size_t words_a_line = 0;
  std::string_view line, word;
  for (std::size_t i = 0; cursor.nextLine(line); ++i) {
    if (context.stopAt(i)) return context.cancelled();
    if (skipped(line)) continue;
    if (words_a_line == 0 && !counts) {
      auto first = countsOf(line, cursor.lineNumber(), context);
      if (!first) return fail(first.error());
      counts = *first;
      if (counts) continue;
    }
    std::array<double, 7> value{};
    std::size_t words = 0;
    for (; TextCursor::takeWord(line, word); ++words) {
      if (words == value.size())
        return context.refuseLine("a point has more than 7 numbers", cursor.lineNumber());
      const auto number = coordinate(word);
      if (!number) return context.refuseLine(printable(word) + " is not a number", cursor.lineNumber());
      value[words] = *number;
    }
    if (words_a_line == 0) words_a_line = words;
    if (words != words_a_line)
      return context.refuseLine("the line has " + std::to_string(words) + " numbers, those before it have " +
                                    std::to_string(words_a_line),
                                cursor.lineNumber());
    if (words != 3 && words != 4 && words != 6 && words != 7)
      return context.refuseLine("a point has " + std::to_string(words) + " numbers", cursor.lineNumber(),
                                "3 (x y z), 4 (and reflectance), 6 (and colour) or 7 (both) are understood");
    table.points.push_back(pointFrom3dtk({value[0], value[1], value[2]}));
    if (words == 4 || words == 7) table.intensity.push_back(static_cast<float>(value[3]));
  }
  if (table.points.empty()) return context.refuse("the file holds no points");
  if (counts) {
    // Not the product, which could overflow.
    const auto points = static_cast<long long>(table.points.size());
    if (points % counts->columns != 0 || points / counts->columns != counts->rows)
      return context.refuse("its first line tells of " + std::to_string(counts->rows) + " x " +
                            std::to_string(counts->columns) + " points, but there are " +
                            std::to_string(points));
    table.rows = static_cast<int>(counts->rows);
    table.columns = static_cast<int>(counts->columns);
  } else {
    table.columns = static_cast<int>(table.points.size());
  }
  if (words_a_line >= 6) warnIgnored(context, {"colour"});
  return Tables{std::move(table)};
}

}  // namespace tiltmap
