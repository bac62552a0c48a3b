// Stanford polygon files: the vertices, and where it is there the matrix of a range_grid element.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/base/text.h"
#include "core/io/cloud_stream.h"
#include "core/io/point_table.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

enum class Encoding { Ascii, LittleEndian, BigEndian };
enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

std::optional<Type> typeNamed(std::string_view name) {
  static const std::array<std::pair<const char*, Type>, 16> names{{{"char", Type::Int8},
                                                                   {"int8", Type::Int8},
                                                                   {"uchar", Type::Uint8},
                                                                   {"uint8", Type::Uint8},
                                                                   {"short", Type::Int16},
                                                                   {"int16", Type::Int16},
                                                                   {"ushort", Type::Uint16},
                                                                   {"uint16", Type::Uint16},
                                                                   {"int", Type::Int32},
                                                                   {"int32", Type::Int32},
                                                                   {"uint", Type::Uint32},
                                                                   {"uint32", Type::Uint32},
                                                                   {"float", Type::Float32},
                                                                   {"float32", Type::Float32},
                                                                   {"double", Type::Float64},
                                                                   {"float64", Type::Float64}}};
  for (const auto& [text, type] : names)
    if (name == text) return type;
  return std::nullopt;
}

std::size_t bytesOf(Type type) {
  static constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

bool isReal(Type type) {
  return type == Type::Float32 || type == Type::Float64;
}

struct Property {
  std::string name;
  Type type = Type::Float32;
  std::optional<Type> list_count;  // set: a list, with a count of this type before it
};

struct Element {
  std::string name;
  long long count = 0;
  std::vector<Property> properties;

  // The least number of bytes that one of these takes.
  std::size_t leastBytes(Encoding encoding) const {
    if (encoding == Encoding::Ascii) return 2 * properties.size() - 1;
    std::size_t sum = 0;
    for (const Property& p : properties) sum += bytesOf(p.list_count.value_or(p.type));
    return sum;
  }
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  long long grid_rows = 0, grid_columns = 0;
  std::optional<Pose> pose;  // the comment of a file of ours; its vertices lie in the world frame
  std::size_t body_at = 0, lines = 0;
};

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const ParseContext& context) : cursor_(bytes), context_(context) {}

  Result<Header> parse() {
    std::string_view line;
    if (!cursor_.nextLine(line) || trimmed(line) != "ply") return bad("the first line is not \"ply\"");
    while (cursor_.nextLine(line)) {
      const auto words = splitWords(line);
      if (words.empty()) continue;
      if (words[0] == "end_header") return finished();
      if (auto done = entry(words); !done) return fail(done.error());
    }
    return context_.refuse("the header has no end_header");
  }

 private:
  tl::unexpected<Error> bad(std::string what) const {
    return context_.refuseLine(std::move(what), cursor_.lineNumber());
  }

  Status entry(const std::vector<std::string_view>& words) {
    if (words[0] == "comment") return comment(words);
    if (words[0] == "obj_info") return objectInfo(words);
    if (words[0] == "format") return format(words);
    if (words[0] == "element") return element(words);
    if (words[0] == "property") return property(words);
    return bad("the header has an unknown line " + printable(words[0]));
  }
  Status comment(const std::vector<std::string_view>& words) {
    if (words.size() != 10 || std::string(words[1]) + " " + std::string(words[2]) != kPlyPoseComment)
      return {};
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto value = parseReal(words[i + 3]);
      if (!value || !std::isfinite(*value)) return bad(printable(words[i + 3]) + " is not a finite number");
      v[i] = *value;
    }
    const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    if (!(std::abs(rotation.norm() - 1.0) < 0.01))
      return bad("the quaternion of the pose is not of length 1");
    header_.pose = Pose(rotation, Eigen::Vector3d(v[0], v[1], v[2]));
    return {};
  }
  Status objectInfo(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || (words[1] != "num_cols" && words[1] != "num_rows")) return {};
    const auto value = parseInteger(words[2]);
    if (!value || *value < 1 || *value > kMostCells)
      return bad(printable(words[2]) + " is not a size of a matrix");
    (words[1] == "num_cols" ? header_.grid_columns : header_.grid_rows) = *value;
    return {};
  }
  Status format(const std::vector<std::string_view>& words) {
    if (has_format_ || words.size() != 3 || words[2] != "1.0")
      return bad("the format is not told once, as 1.0");
    has_format_ = true;
    if (words[1] == "ascii")
      header_.encoding = Encoding::Ascii;
    else if (words[1] == "binary_little_endian")
      header_.encoding = Encoding::LittleEndian;
    else if (words[1] == "binary_big_endian")
      header_.encoding = Encoding::BigEndian;
    else
      return bad("the format " + printable(words[1]) + " is unknown");
    return {};
  }
  Status element(const std::vector<std::string_view>& words) {
    const auto count = words.size() == 3 ? parseInteger(words[2]) : std::nullopt;
    if (!count || *count < 0) return bad("an element needs a name and how many there are");
    for (const Element& other : header_.elements)
      if (other.name == words[1]) return bad("the element " + printable(words[1]) + " is there twice");
    header_.elements.push_back({std::string(words[1]), *count, {}});
    return {};
  }
  Status property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) return bad("a property comes before the first element");
    Property p;
    if (words.size() == 5 && words[1] == "list") {
      const auto count = typeNamed(words[2]);
      const auto type = typeNamed(words[3]);
      if (!count || !type || isReal(*count)) return bad("the list has an unknown type");
      p = {std::string(words[4]), *type, count};
    } else {
      const auto type = words.size() == 3 ? typeNamed(words[1]) : std::nullopt;
      if (!type) return bad("a property needs a known type and a name");
      p = {std::string(words[2]), *type, {}};
    }
    auto& list = header_.elements.back().properties;
    for (const Property& other : list)
      if (other.name == p.name) return bad("the property " + printable(p.name) + " is there twice");
    list.push_back(std::move(p));
    return {};
  }
  Result<Header> finished() {
    if (!has_format_) return context_.refuse("the header has no format line");
    const Element* vertex = nullptr;
    for (const Element& e : header_.elements) {
      if (e.properties.empty() && e.count > 0)
        return context_.refuse("the element " + printable(e.name) + " has no properties");
      if (e.name == "vertex") vertex = &e;
    }
    if (!vertex || vertex->count == 0) return context_.refuse("the file holds no vertices");
    if (vertex->count > kMostCells) return context_.refuse("the file holds more than 100 million vertices");
    for (const char* axis : {"x", "y", "z"}) {
      bool found = false;
      for (const Property& p : vertex->properties) found |= p.name == axis && isReal(p.type) && !p.list_count;
      if (!found)
        return context_.refuse(
            std::string("the vertices have no property ") + axis + " of type float or double", {},
            "export it with x y z as floats, in metres");
    }
    header_.body_at = cursor_.position();
    header_.lines = cursor_.lineNumber();
    return header_;
  }

  TextCursor cursor_;
  const ParseContext& context_;
  Header header_;
  bool has_format_ = false;
};

// Values one after the other, from words or from bytes; one line an element in text.
class Body {
 public:
  Body(std::string_view bytes, const Header& header, const ParseContext& context)
      : bytes_(bytes.substr(header.body_at)), header_(header), context_(context), cursor_(bytes_) {}

  std::size_t remaining() const {
    return header_.encoding == Encoding::Ascii ? line_.size() + cursor_.remaining() : bytes_.size() - at_;
  }
  Status begin() {
    if (header_.encoding == Encoding::Ascii && !cursor_.nextLine(line_))
      return bad("the file ends too early");
    return {};
  }
  Status take(Type type, double& value) {
    if (header_.encoding != Encoding::Ascii) return takeBinary(type, value);
    std::string_view word;
    if (!TextCursor::takeWord(line_, word)) return bad("the line has too few numbers");
    const auto number = coordinate(word);
    if (!number) return bad(printable(word) + " is not a number");
    value = *number;
    return {};
  }
  Status end() {
    std::string_view word;
    if (header_.encoding == Encoding::Ascii && TextCursor::takeWord(line_, word))
      return bad("the line has too many numbers");
    return {};
  }
  Status finish() const {
    const bool more = header_.encoding == Encoding::Ascii ? !cursor_.onlyBlanksLeft() : at_ < bytes_.size();
    if (more) return bad("the file goes on after its last element");
    return {};
  }
  tl::unexpected<Error> bad(std::string what) const {
    if (header_.encoding == Encoding::Ascii)
      return context_.refuseLine(std::move(what), header_.lines + cursor_.lineNumber());
    return context_.refuseByte(std::move(what), header_.body_at + at_);
  }

 private:
  Status takeBinary(Type type, double& value) {
    const std::size_t size = bytesOf(type);
    if (bytes_.size() - at_ < size) return bad("the file ends too early");
    std::array<char, 8> raw{};
    const bool turn =
        (header_.encoding == Encoding::BigEndian) == (std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < size; ++i) raw[turn ? size - 1 - i : i] = bytes_[at_ + i];
    at_ += size;
    const auto as = [&raw](auto number) {
      std::memcpy(&number, raw.data(), sizeof(number));
      return static_cast<double>(number);
    };
    switch (type) {
      case Type::Int8:
        value = as(std::int8_t{});
        break;
      case Type::Uint8:
        value = as(std::uint8_t{});
        break;
      case Type::Int16:
        value = as(std::int16_t{});
        break;
      case Type::Uint16:
        value = as(std::uint16_t{});
        break;
      case Type::Int32:
        value = as(std::int32_t{});
        break;
      case Type::Uint32:
        value = as(std::uint32_t{});
        break;
      case Type::Float32:
        value = as(float{});
        break;
      case Type::Float64:
        value = as(double{});
        break;
    }
    return {};
  }

  std::string_view bytes_;
  const Header& header_;
  const ParseContext& context_;
  TextCursor cursor_;
  std::string_view line_;
  std::size_t at_ = 0;
};

class BodyParser {
 public:
  BodyParser(std::string_view bytes, const Header& header, const ParseContext& context)
      : header_(header), context_(context), body_(bytes, header, context) {}

  Status parse() {
    for (const Element& element : header_.elements) {
      if (element.count == 0) continue;
      if (static_cast<unsigned long long>(element.count) >
          (body_.remaining() + 1) / element.leastBytes(header_.encoding))
        return body_.bad("the header tells of " + std::to_string(element.count) + " of " +
                         printable(element.name) + ", more than the rest of the file can hold");
      for (long long i = 0; i < element.count; ++i) {
        if (context_.stopAt(static_cast<std::size_t>(i))) return context_.cancelled();
        if (auto done = one(element); !done) return done;
      }
    }
    return body_.finish();
  }

  std::vector<Eigen::Vector3d> points;
  std::vector<float> intensity;
  std::vector<long long> grid;  // vertex of each cell, -1 where there is none

 private:
  Status one(const Element& element) {
    if (auto begun = body_.begin(); !begun) return begun;
    const bool vertex = element.name == "vertex", range_grid = element.name == "range_grid";
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double value = 0.0;
    for (const Property& p : element.properties) {
      if (p.list_count) {
        if (auto done = list(p, range_grid); !done) return done;
        continue;
      }
      if (auto taken = body_.take(p.type, value); !taken) return taken;
      if (!vertex) continue;
      if (p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
        point[p.name[0] - 'x'] = value;
      else if (namesIntensity(p.name) && &p == intensityOf(element))
        intensity.push_back(static_cast<float>(value));
    }
    if (vertex) points.push_back(point);
    return body_.end();
  }
  Status list(const Property& p, bool range_grid) {
    double count = 0.0, value = 0.0;
    if (auto taken = body_.take(*p.list_count, count); !taken) return taken;
    if (!(count >= 0.0) || std::floor(count) != count || count > static_cast<double>(body_.remaining()) + 1.0)
      return body_.bad("a list has an impossible length");
    if (range_grid && count > 1.0) return body_.bad("a cell of the range_grid has more than one vertex");
    if (range_grid && count == 0.0) grid.push_back(-1);
    for (double k = 0.0; k < count; k += 1.0) {
      if (auto taken = body_.take(p.type, value); !taken) return taken;
      if (!range_grid) continue;
      if (!(value >= 0.0) || std::floor(value) != value || value > static_cast<double>(kMostCells))
        return body_.bad("a cell of the range_grid names an impossible vertex");
      grid.push_back(static_cast<long long>(value));
    }
    return {};
  }
  static const Property* intensityOf(const Element& element) {
    for (const Property& p : element.properties)
      if (!p.list_count && namesIntensity(p.name)) return &p;
    return nullptr;
  }

  const Header& header_;
  const ParseContext& context_;
  Body body_;
};

Result<PointTable> tableOf(const Header& header, BodyParser& body, const ParseContext& context) {
  PointTable table;
  if (header.pose) {
    const Pose scan_from_world = header.pose->inverse();
    for (Eigen::Vector3d& p : body.points) p = scan_from_world * p;
    const PoseDifference away = difference(*header.pose, Pose());
    if (away.translation_m > 0.0 || away.rotation_rad > 0.0) table.pose = header.pose;
  }
  if (body.grid.empty() || header.grid_rows == 0 || header.grid_columns == 0) {
    table.columns = static_cast<int>(body.points.size());
    table.points = std::move(body.points);
    table.intensity = std::move(body.intensity);
    return table;
  }
  const auto cells = static_cast<long long>(body.grid.size());
  if (header.grid_rows * header.grid_columns != cells)
    return context.refuse("the range_grid has " + std::to_string(cells) + " cells, and its matrix " +
                          std::to_string(header.grid_rows) + " x " + std::to_string(header.grid_columns));
  table.rows = static_cast<int>(header.grid_rows);
  table.columns = static_cast<int>(header.grid_columns);
  table.points.assign(body.grid.size(), Eigen::Vector3d::Zero());
  if (!body.intensity.empty()) table.intensity.assign(body.grid.size(), 0.0F);
  for (std::size_t cell = 0; cell < body.grid.size(); ++cell) {
    if (body.grid[cell] < 0) continue;
    const auto vertex = static_cast<std::size_t>(body.grid[cell]);
    if (vertex >= body.points.size())
      return context.refuse("cell " + std::to_string(cell) +
                            " of the range_grid names a vertex that is not there");
    table.points[cell] = body.points[vertex];
    if (!body.intensity.empty()) table.intensity[cell] = body.intensity[vertex];
  }
  return table;
}

}  // namespace

Result<Tables> parsePly(std::string_view bytes, const ParseContext& context) {
  const auto header = HeaderParser(bytes, context).parse();
  if (!header) return fail(header.error());
  if (header->encoding != Encoding::Ascii && looksLikePrintedNumbers(bytes.substr(header->body_at)))
    return context.refuseByte("the header says binary, but the points are printed text", header->body_at,
                              "correct the format line to ascii, or export it again");
  BodyParser body(bytes, *header, context);
  if (auto parsed = body.parse(); !parsed) return fail(parsed.error());
  auto table = tableOf(*header, body, context);
  if (!table) return fail(table.error());

  std::vector<std::string> ignored;
  bool has_intensity = false;
  for (const Element& element : header->elements) {
    if (element.name == "range_grid" || element.count == 0) continue;
    if (element.name != "vertex")
      ignored.push_back(element.name);
    else
      for (const Property& p : element.properties) {
        const bool axis = p.name == "x" || p.name == "y" || p.name == "z";
        const bool intensity = !has_intensity && !p.list_count && namesIntensity(p.name);
        has_intensity |= intensity;
        if (!axis && !intensity) ignored.push_back(p.name);
      }
  }
  warnIgnored(context, ignored);
  Tables tables;
  tables.push_back(std::move(*table));
  return tables;
}

}  // namespace tiltmap
