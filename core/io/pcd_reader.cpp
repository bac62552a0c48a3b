// Point Cloud Library files. PCL decodes the body, but only after this file has checked header, counts and
// exact length: PCL 1.13 crashes on several malformed files and accepts others.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include "core/base/text.h"
#include "core/io/point_table.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

enum class Body { Ascii, Binary, Compressed };

struct Field {
  std::string name;
  int size = 0;
  char type = 'F';
  long long count = 1;
};

struct Header {
  std::vector<Field> fields;
  long long width = -1, height = -1, points = -1;
  std::optional<Pose> viewpoint;
  Body body = Body::Ascii;
  std::size_t body_at = 0;       // byte
  std::size_t header_lines = 0;  // lines up to and with DATA

  std::size_t pointBytes() const {
    std::size_t sum = 0;
    for (const Field& field : fields)
      sum += static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.count);
    return sum;
  }
  std::size_t pointWords() const {
    std::size_t sum = 0;
    for (const Field& field : fields) sum += static_cast<std::size_t>(field.count);
    return sum;
  }
};

// Bounds the arithmetic: no sum or product of sizes below can overflow.
constexpr long long kMostCount = 10000;
constexpr std::size_t kMostFields = 1000;

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const ParseContext& context) : cursor_(bytes), context_(context) {}

  Result<Header> parse() {
    std::string_view line;
    while (cursor_.nextLine(line)) {
      const std::string_view text = trimmed(line);
      if (text.empty() || text.front() == '#') continue;
      const std::vector<std::string_view> words = splitWords(text);
      if (auto done = entry(words); !done) return fail(done.error());
      if (words.front() == "DATA") return finished();
    }
    return context_.refuse("the header has no DATA line", {},
                           "this is not a complete PCD file; export it again");
  }

 private:
  tl::unexpected<Error> bad(std::string what) const {
    return context_.refuseLine(std::move(what), cursor_.lineNumber());
  }

  Status entry(const std::vector<std::string_view>& words) {
    std::string name(words.front());
    if (name == "COLUMNS") name = "FIELDS";
    if (std::ranges::find(seen_, name) != seen_.end()) return bad("the header has two lines " + name);
    seen_.push_back(name);
    const std::vector<std::string_view> values(words.begin() + 1, words.end());
    if (values.empty()) return bad("the header line " + printable(name) + " has no value");
    if (name == "VERSION") return {};
    if (name == "FIELDS") return fields(values);
    if (name == "SIZE")
      return perField(values, 1, 8, [](Field& field, long long v) { field.size = static_cast<int>(v); });
    if (name == "COUNT")
      return perField(values, 1, kMostCount, [](Field& field, long long v) { field.count = v; });
    if (name == "TYPE") return types(values);
    if (name == "VIEWPOINT") return viewpoint(values);
    if (name == "WIDTH") return number(values, header_.width);
    if (name == "HEIGHT") return number(values, header_.height);
    if (name == "POINTS") return number(values, header_.points);
    if (name == "DATA") return data(values);
    return bad("the header has an unknown line " + printable(name));
  }
  Status fields(const std::vector<std::string_view>& values) {
    if (values.size() > kMostFields) return bad("the header names too many fields");
    for (const std::string_view name : values) {
      for (const Field& field : header_.fields)
        if (name != "_" && field.name == name) return bad("the field " + printable(name) + " is there twice");
      header_.fields.push_back({std::string(name), 0, 'F', 1});
    }
    return {};
  }
  template <class Set>
  Status perField(const std::vector<std::string_view>& values, long long least, long long most, Set set) {
    if (values.size() != header_.fields.size())
      return bad("the header has " + std::to_string(header_.fields.size()) +
                 " fields, but this line tells of " + std::to_string(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value = parseInteger(values[i]);
      if (!value || *value < least || *value > most)
        return bad(printable(values[i]) + " is not a whole number from " + std::to_string(least) + " to " +
                   std::to_string(most));
      set(header_.fields[i], *value);
    }
    return {};
  }
  Status types(const std::vector<std::string_view>& values) {
    if (values.size() != header_.fields.size())
      return bad("the header has " + std::to_string(header_.fields.size()) +
                 " fields, but this line tells of " + std::to_string(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] != "F" && values[i] != "I" && values[i] != "U")
        return bad("the type " + printable(values[i]) + " is none of F, I, U");
      header_.fields[i].type = values[i].front();
    }
    return {};
  }
  Status number(const std::vector<std::string_view>& values, long long& to) {
    const auto value = values.size() == 1 ? parseInteger(values.front()) : std::nullopt;
    if (!value) return bad("one whole number is expected here");
    if (*value < 1) return bad("the count " + std::to_string(*value) + " leaves no points");
    if (*value > kMostCells) return bad("the count " + std::to_string(*value) + " is above 100 million");
    to = *value;
    return {};
  }
  Status viewpoint(const std::vector<std::string_view>& values) {
    std::array<double, 7> v{};
    if (values.size() != v.size()) return bad("VIEWPOINT needs seven numbers: x y z qw qx qy qz");
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto value = parseReal(values[i]);
      if (!value || !std::isfinite(*value)) return bad(printable(values[i]) + " is not a finite number");
      v[i] = *value;
    }
    const Eigen::Quaterniond rotation(v[3], v[4], v[5], v[6]);
    if (!(std::abs(rotation.norm() - 1.0) < 0.01))
      return bad("the quaternion of VIEWPOINT is not of length 1");
    const Pose pose(rotation, Eigen::Vector3d(v[0], v[1], v[2]));
    const PoseDifference away = difference(pose, Pose());
    if (away.translation_m > 0.0 || away.rotation_rad > 0.0) header_.viewpoint = pose;
    return {};
  }
  Status data(const std::vector<std::string_view>& values) {
    const std::string_view kind = values.size() == 1 ? values.front() : std::string_view();
    if (kind == "ascii")
      header_.body = Body::Ascii;
    else if (kind == "binary")
      header_.body = Body::Binary;
    else if (kind == "binary_compressed")
      header_.body = Body::Compressed;
    else
      return bad("DATA must be ascii, binary or binary_compressed");
    return {};
  }
  bool saw(const char* name) const { return std::ranges::find(seen_, name) != seen_.end(); }

  Result<Header> finished() {
    for (const char* name : {"FIELDS", "SIZE", "TYPE", "WIDTH", "POINTS"})
      if (!saw(name)) return context_.refuse(std::string("the header has no line ") + name);
    if (header_.height < 0) header_.height = 1;
    if (header_.width * header_.height != header_.points)
      return context_.refuse("WIDTH times HEIGHT is " + std::to_string(header_.width * header_.height) +
                             ", but POINTS is " + std::to_string(header_.points));
    for (const Field& field : header_.fields) {
      const bool fits = field.type == 'F'
                            ? field.size == 4 || field.size == 8
                            : field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
      if (!fits)
        return context_.refuse("the field " + printable(field.name) + " has the type " + field.type + " of " +
                               std::to_string(field.size) + " bytes, which does not exist");
    }
    for (const char* axis : {"x", "y", "z"}) {
      const auto field = std::ranges::find(header_.fields, axis, &Field::name);
      if (field == header_.fields.end())
        return context_.refuse(std::string("there is no field ") + axis, {},
                               "export it with the fields x y z");
      if (field->type != 'F' || field->count != 1)
        return context_.refuse(std::string("the field ") + axis + " is not one floating point number a point",
                               {}, "export it with x y z of type F, in metres");
    }
    header_.body_at = cursor_.position();
    header_.header_lines = cursor_.lineNumber();
    return header_;
  }

  TextCursor cursor_;
  const ParseContext& context_;
  Header header_;
  std::vector<std::string> seen_;
};

// Whole-numbered fields may be printed with a decimal point, but must lie in the range of their type.
bool fits(double value, const Field& field) {
  if (field.type == 'F') return field.size == 8 || !std::isfinite(value) || std::abs(value) <= 3.4e38;
  const double half = std::ldexp(1.0, 8 * field.size - 1);
  return field.type == 'I' ? value >= -half && value < half : value >= 0.0 && value < 2.0 * half;
}

// Exactly one line a point, exactly the fields a line, every word a number of its type; blank lines at the
// end only.
Status checkAscii(std::string_view bytes, const Header& header, const ParseContext& context) {
  TextCursor cursor(bytes.substr(header.body_at));
  std::string_view line;
  for (long long point = 0; point < header.points; ++point) {
    if (context.stopAt(static_cast<std::size_t>(point))) return context.cancelled();
    const std::size_t number = header.header_lines + static_cast<std::size_t>(point) + 1;
    if (!cursor.nextLine(line))
      return context.refuseLine(
          "the file ends after " + std::to_string(point) + " of " + std::to_string(header.points) + " points",
          number);
    std::string_view word;
    for (const Field& field : header.fields) {
      for (long long k = 0; k < field.count; ++k) {
        if (!TextCursor::takeWord(line, word))
          return context.refuseLine(
              "the line has fewer than " + std::to_string(header.pointWords()) + " numbers", number);
        const auto value = coordinate(word);
        if (!value) return context.refuseLine(printable(word) + " is not a number", number);
        if (!fits(*value, field))
          return context.refuseLine(printable(word) + " does not fit the type of " + printable(field.name),
                                    number);
      }
    }
    if (TextCursor::takeWord(line, word))
      return context.refuseLine("the line has more than " + std::to_string(header.pointWords()) + " numbers",
                                number);
  }
  if (!cursor.onlyBlanksLeft())
    return context.refuseLine("the file goes on after its " + std::to_string(header.points) + " points",
                              header.header_lines + static_cast<std::size_t>(header.points) + 1);
  return {};
}

std::uint32_t littleEndian32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = (value << 8) | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// What LZF-compressed bytes unpack to; nothing where they refer to before the start or end within a run.
// Format (Lehmann's liblzf): a byte below 32 begins that many + 1 literal bytes, others a copy of already
// unpacked ones.
std::optional<std::size_t> lzfLength(std::string_view packed) {
  std::size_t at = 0, length = 0;
  while (at < packed.size()) {
    const std::size_t control = static_cast<unsigned char>(packed[at++]);
    if (control < 32) {
      at += control + 1;
      length += control + 1;
      if (at > packed.size()) return std::nullopt;
      continue;
    }
    std::size_t run = control >> 5;
    if (run == 7) {
      if (at >= packed.size()) return std::nullopt;
      run += static_cast<unsigned char>(packed[at++]);
    }
    if (at >= packed.size()) return std::nullopt;
    const std::size_t back = ((control & 31U) << 8) + static_cast<unsigned char>(packed[at++]) + 1;
    if (back > length) return std::nullopt;
    length += run + 2;
  }
  return length;
}

Status checkBinary(std::string_view bytes, const Header& header, const ParseContext& context) {
  const std::string_view body = bytes.substr(header.body_at);
  const std::size_t full = static_cast<std::size_t>(header.points) * header.pointBytes();
  const auto wrongLength = [&](std::size_t is, std::size_t should) {
    return context.refuseByte("the header asks for " + std::to_string(should) +
                                  " bytes of points, but there are " + std::to_string(is),
                              header.body_at);
  };
  if (header.body == Body::Binary) {
    if (looksLikePrintedNumbers(body))
      return context.refuseByte("the header says binary, but the points are printed text", header.body_at,
                                "correct the DATA line to ascii, or export it again");
    if (body.size() != full) return wrongLength(body.size(), full);
    return {};
  }
  if (body.size() < 8)
    return context.refuseByte("the file ends before its compressed points", header.body_at);
  const std::size_t packed = littleEndian32(body, 0), unpacked = littleEndian32(body, 4);
  if (body.size() - 8 != packed)
    return context.refuseByte("it should hold " + std::to_string(packed) +
                                  " compressed bytes, but there are " + std::to_string(body.size() - 8),
                              header.body_at);
  for (const Field& field : header.fields)
    if (field.name == "_")
      return context.refuse("compressed points have unnamed fields", {},
                            "export it again without compression");
  if (unpacked != full) return wrongLength(unpacked, full);
  if (lzfLength(body.substr(8)) != full)
    return context.refuseByte("the compressed points are damaged", header.body_at + 8);
  return {};
}

double scalarAt(const std::uint8_t* at, const pcl::PCLPointField& field) {
  const auto as = [at](auto value) {
    std::memcpy(&value, at, sizeof(value));
    return static_cast<double>(value);
  };
  switch (field.datatype) {
    case pcl::PCLPointField::INT8:
      return as(std::int8_t{});
    case pcl::PCLPointField::UINT8:
      return as(std::uint8_t{});
    case pcl::PCLPointField::INT16:
      return as(std::int16_t{});
    case pcl::PCLPointField::UINT16:
      return as(std::uint16_t{});
    case pcl::PCLPointField::INT32:
      return as(std::int32_t{});
    case pcl::PCLPointField::UINT32:
      return as(std::uint32_t{});
    case pcl::PCLPointField::INT64:
      return as(std::int64_t{});
    case pcl::PCLPointField::UINT64:
      return as(std::uint64_t{});
    case pcl::PCLPointField::FLOAT32:
      return as(float{});
    default:
      return as(double{});
  }
}

// The header again, in the one spelling that PCL and we cannot read in two ways.
std::string plainHeader(const Header& header) {
  std::string fields = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (const Field& field : header.fields) {
    fields += " " + field.name;
    sizes += " " + std::to_string(field.size);
    types += std::string(" ") + field.type;
    counts += " " + std::to_string(field.count);
  }
  const char* const kinds[] = {"ascii", "binary", "binary_compressed"};
  return "VERSION 0.7\n" + fields + "\n" + sizes + "\n" + types + "\n" + counts + "\nWIDTH " +
         std::to_string(header.width) + "\nHEIGHT " + std::to_string(header.height) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(header.points) + "\nDATA " +
         kinds[static_cast<int>(header.body)] + "\n";
}

// The points, decoded by PCL from memory that has been checked: nothing can change between check and use.
Result<pcl::PCLPointCloud2> decoded(std::string_view bytes, const Header& header,
                                    const ParseContext& context) {
  pcl::PCLPointCloud2 cloud;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, data_type = 0;
  unsigned int body_at = 0;
  pcl::PCDReader reader;
  const auto bad = [&] {
    return context.refuse("the Point Cloud Library cannot read it", {},
                          "export it again, as ascii if need be");
  };
  try {
    std::istringstream header_stream(plainHeader(header));
    if (reader.readHeader(header_stream, cloud, origin, orientation, version, data_type, body_at) != 0)
      return bad();
    if (cloud.data.size() != static_cast<std::size_t>(header.points) * header.pointBytes()) return bad();
    int outcome = 0;
    if (header.body == Body::Ascii) {
      std::istringstream body(std::string(bytes.substr(header.body_at)));
      outcome = reader.readBodyASCII(body, cloud, version);
    } else {
      const auto* body = reinterpret_cast<const unsigned char*>(bytes.data());
      outcome = reader.readBodyBinary(body, cloud, version, header.body == Body::Compressed,
                                      static_cast<unsigned int>(header.body_at));
    }
    if (outcome != 0) return bad();
  } catch (const std::exception&) {
    return bad();
  }
  return cloud;
}

}  // namespace

Result<Tables> parsePcd(std::string_view bytes, const ParseContext& context) {
  const auto header = HeaderParser(bytes, context).parse();
  if (!header) return fail(header.error());
  const Status checked = header->body == Body::Ascii ? checkAscii(bytes, *header, context)
                                                     : checkBinary(bytes, *header, context);
  if (!checked) return fail(checked.error());
  const auto cloud = decoded(bytes, *header, context);
  if (!cloud) return fail(cloud.error());

  const auto find = [&](auto matches) -> const pcl::PCLPointField* {
    const auto found = std::ranges::find_if(cloud->fields, matches);
    return found == cloud->fields.end() ? nullptr : &*found;
  };
  std::array<const pcl::PCLPointField*, 3> axes{};
  for (std::size_t k = 0; k < 3; ++k)
    axes[k] = find([&](const pcl::PCLPointField& f) { return f.name == std::string(1, "xyz"[k]); });
  const auto* intensity =
      find([](const pcl::PCLPointField& f) { return f.count == 1 && namesIntensity(f.name); });
  if (!axes[0] || !axes[1] || !axes[2])
    return context.refuse("the Point Cloud Library cannot find x, y and z");

  PointTable table;
  table.rows = static_cast<int>(header->height);
  table.columns = static_cast<int>(header->width);
  table.pose = header->viewpoint;
  const auto count = static_cast<std::size_t>(header->points);
  table.points.resize(count);
  if (intensity) table.intensity.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (context.stopAt(i)) return context.cancelled();
    const std::uint8_t* point = cloud->data.data() + i * cloud->point_step;
    for (std::size_t k = 0; k < 3; ++k)
      table.points[i][static_cast<Eigen::Index>(k)] = scalarAt(point + axes[k]->offset, *axes[k]);
    if (intensity) table.intensity[i] = static_cast<float>(scalarAt(point + intensity->offset, *intensity));
  }
  std::vector<std::string> ignored;
  for (const Field& field : header->fields) {
    const bool used = field.name == "x" || field.name == "y" || field.name == "z" || field.name == "_" ||
                      (intensity && field.name == intensity->name);
    if (!used) ignored.push_back(field.name);
  }
  warnIgnored(context, ignored);
  return Tables{std::move(table)};
}

}  // namespace tiltmap
