#include "core/io/pcd_header.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/text.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

// Bounds the arithmetic: no sum or product of sizes below can overflow.
constexpr long long kMostCount = 10000;
constexpr std::size_t kMostFields = 1000;

class PcdHeaderParser {
 public:
  PcdHeaderParser(std::string_view bytes, const ParseContext& context) : cursor_(bytes), context_(context) {}

  Result<PcdHeader> parse() {
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
      return perField(values, 1, 8, [](PcdField& field, long long v) { field.size = static_cast<int>(v); });
    if (name == "COUNT")
      return perField(values, 1, kMostCount, [](PcdField& field, long long v) { field.count = v; });
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
      for (const PcdField& field : header_.fields)
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
      header_.body = PcdBody::Ascii;
    else if (kind == "binary")
      header_.body = PcdBody::Binary;
    else if (kind == "binary_compressed")
      header_.body = PcdBody::Compressed;
    else
      return bad("DATA must be ascii, binary or binary_compressed");
    return {};
  }
  bool saw(const char* name) const { return std::ranges::find(seen_, name) != seen_.end(); }

  Result<PcdHeader> finished() {
    for (const char* name : {"FIELDS", "SIZE", "TYPE", "WIDTH", "POINTS"})
      if (!saw(name)) return context_.refuse(std::string("the header has no line ") + name);
    if (header_.height < 0) header_.height = 1;
    if (header_.width * header_.height != header_.points)
      return context_.refuse("WIDTH times HEIGHT is " + std::to_string(header_.width * header_.height) +
                             ", but POINTS is " + std::to_string(header_.points));
    for (const PcdField& field : header_.fields) {
      const bool fits = field.type == 'F'
                            ? field.size == 4 || field.size == 8
                            : field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
      if (!fits)
        return context_.refuse("the field " + printable(field.name) + " has the type " + field.type + " of " +
                               std::to_string(field.size) + " bytes, which does not exist");
    }
    for (const char* axis : {"x", "y", "z"}) {
      const auto field = std::ranges::find(header_.fields, axis, &PcdField::name);
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
  PcdHeader header_;
  std::vector<std::string> seen_;
};

}  // namespace

Result<PcdHeader> parsePcdHeader(std::string_view bytes, const ParseContext& context) {
  return PcdHeaderParser(bytes, context).parse();
}

std::string plainPcdHeader(const PcdHeader& header) {
  std::string fields = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (const PcdField& field : header.fields) {
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

}  // namespace tiltmap
