// Leica PTX: one or several scans a file, each a matrix with the pose of the scanner.
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/io/point_table.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

class PtxParser {
 public:
  PtxParser(std::string_view bytes, const ParseContext& context) : cursor_(bytes), context_(context) {}

  Result<Tables> parse() {
    Tables tables;
    while (!cursor_.onlyBlanksLeft()) {
      auto table = scan(tables.size() + 1);
      if (!table) return fail(table.error());
      tables.push_back(std::move(*table));
    }
    if (tables.empty()) return context_.refuse("the file holds no scans");
    if (tables.size() > 1)
      for (std::size_t i = 0; i < tables.size(); ++i) tables[i].suffix = "/" + std::to_string(i + 1);
    if (colours_) warnIgnored(context_, {"colour"});
    return tables;
  }

 private:
  tl::unexpected<Error> bad(std::string what) const {
    return context_.refuseLine(std::move(what), cursor_.lineNumber());
  }

  // The next line that is not blank, as exactly `count` numbers.
  Status numbers(std::size_t count, double* values, const char* what) {
    std::string_view line, word;
    do {
      if (!cursor_.nextLine(line)) return bad(std::string("the file ends before ") + what);
    } while (trimmed(line).empty());
    for (std::size_t i = 0; i < count; ++i) {
      if (!TextCursor::takeWord(line, word)) return bad(std::string(what) + " has too few numbers");
      const auto value = parseReal(word);
      if (!value || !std::isfinite(*value)) return bad(printable(word) + " is not a finite number");
      values[i] = *value;
    }
    if (TextCursor::takeWord(line, word)) return bad(std::string(what) + " has too many numbers");
    return {};
  }
  Result<long long> size(const char* what) {
    double value = 0.0;
    if (auto read = numbers(1, &value, what); !read) return fail(read.error());
    if (!(value >= 1.0 && value <= static_cast<double>(kMostCells)) || std::floor(value) != value)
      return bad(std::string(what) + " is not a whole number from 1 to 100 million");
    return static_cast<long long>(value);
  }
  // Position and axes of the scanner, then the matrix that acts on row vectors; the matrix counts.
  Result<Pose> pose() {
    std::array<double, 12> scanner{};
    for (std::size_t i = 0; i < 4; ++i)
      if (auto read = numbers(3, &scanner[3 * i], "the scanner's position"); !read) return fail(read.error());
    Eigen::Matrix4d matrix;
    for (Eigen::Index row = 0; row < 4; ++row) {
      std::array<double, 4> v{};
      if (auto read = numbers(4, v.data(), "the matrix"); !read) return fail(read.error());
      for (Eigen::Index k = 0; k < 4; ++k) matrix(k, row) = v[static_cast<std::size_t>(k)];
    }
    const Eigen::Matrix3d r = matrix.topLeftCorner<3, 3>();
    const bool rigid = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3 &&
                       r.determinant() > 0.0 &&
                       (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-6;
    if (!rigid) return bad("the matrix is not a rotation and a shift");
    const Eigen::Vector3d t = matrix.topRightCorner<3, 1>();
    if ((t - Eigen::Vector3d(scanner[0], scanner[1], scanner[2])).norm() > 0.01)
      context_.warn("the scanner's position is not that of its matrix, which was taken");
    return Pose(r, t);
  }
  Result<PointTable> scan(std::size_t number) {
    const auto columns = size("the number of columns");
    if (!columns) return fail(columns.error());
    const auto rows = size("the number of rows");
    if (!rows) return fail(rows.error());
    const auto world_from_scan = pose();
    if (!world_from_scan) return fail(world_from_scan.error());
    const long long cells = *columns * *rows;
    // A line takes at least the five characters of 0 0 0 and its end.
    if (cells > kMostCells || static_cast<unsigned long long>(cells) > (cursor_.remaining() + 1) / 6)
      return bad("scan " + std::to_string(number) + " should have " + std::to_string(cells) +
                 " points, more than the rest of the file can hold");
    PointTable table;
    table.rows = static_cast<int>(*rows);
    table.columns = static_cast<int>(*columns);
    table.points.assign(static_cast<std::size_t>(cells), Eigen::Vector3d::Zero());
    if (auto read = points(table); !read) return fail(read.error());
    if (*columns == 1) std::swap(table.rows, table.columns);  // a list, not a matrix
    const PoseDifference away = difference(*world_from_scan, Pose());
    if (away.translation_m > 0.0 || away.rotation_rad > 0.0) table.pose = *world_from_scan;
    return table;
  }
  // Column by column. x y z, or also the intensity, or also a colour.
  Status points(PointTable& table) {
    std::vector<float> intensity;
    std::size_t words_a_line = 0;
    const auto rows = static_cast<std::size_t>(table.rows), columns = static_cast<std::size_t>(table.columns);
    for (std::size_t i = 0; i < table.points.size(); ++i) {
      if (context_.stopAt(i)) return context_.cancelled();
      std::string_view line, word;
      if (!cursor_.nextLine(line))
        return bad("the file ends after " + std::to_string(i) + " of " + std::to_string(table.points.size()) +
                   " points");
      std::array<double, 7> v{};
      std::size_t words = 0;
      for (; TextCursor::takeWord(line, word); ++words) {
        const auto value = words < v.size() ? coordinate(word) : std::nullopt;
        if (words == v.size()) return bad("a point has more than 7 numbers");
        if (!value) return bad(printable(word) + " is not a number");
        v[words] = *value;
      }
      if (words_a_line == 0) words_a_line = words;
      if (words != words_a_line || (words != 3 && words != 4 && words != 7))
        return bad("a point has " + std::to_string(words) +
                   " numbers; 3, 4 or 7 are understood, and the same all through");
      const std::size_t cell = (i % rows) * columns + i / rows;
      table.points[cell] = {v[0], v[1], v[2]};
      if (words == 3) continue;
      if (intensity.empty()) intensity.assign(table.points.size(), 0.0F);
      intensity[cell] = static_cast<float>(v[3]);
    }
    colours_ |= words_a_line == 7;
    // 0.5 throughout is what programs write that have none.
    for (const float value : intensity)
      if (value != 0.5F) {
        table.intensity = std::move(intensity);
        break;
      }
    return {};
  }

  TextCursor cursor_;
  const ParseContext& context_;
  bool colours_ = false;
};

}  // namespace

Result<Tables> parsePtx(std::string_view bytes, const ParseContext& context) {
  return PtxParser(bytes, context).parse();
}

}  // namespace tiltmap
