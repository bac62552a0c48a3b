// Legacy VTK files: the points of a POLYDATA or UNSTRUCTURED_GRID. Everything after them is walked through to
// the last byte, since nothing else tells whether the file is whole.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>

#include "core/base/text.h"
#include "core/io/point_table.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

struct Type {
  const char* name;
  std::size_t bytes;
  char kind;  // f float, i signed, u unsigned
};

const Type* typeNamed(std::string_view name) {
  static constexpr std::array<Type, 14> types{{{"float", 4, 'f'},
                                               {"double", 8, 'f'},
                                               {"char", 1, 'i'},
                                               {"signed_char", 1, 'i'},
                                               {"unsigned_char", 1, 'u'},
                                               {"short", 2, 'i'},
                                               {"unsigned_short", 2, 'u'},
                                               {"int", 4, 'i'},
                                               {"unsigned_int", 4, 'u'},
                                               {"long", 8, 'i'},
                                               {"unsigned_long", 8, 'u'},
                                               {"vtkidtype", 4, 'i'},  // written as int
                                               {"vtktypeint64", 8, 'i'},
                                               {"vtktypeuint64", 8, 'u'}}};
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = std::ranges::find_if(types, [&](const Type& t) { return lower == t.name; });
  return found == types.end() ? nullptr : &*found;
}

class VtkParser {
 public:
  VtkParser(std::string_view bytes, const ParseContext& context)
      : bytes_(bytes), cursor_(bytes), context_(context) {}

  Result<Tables> parse() {
    if (auto begun = preamble(); !begun) return fail(begun.error());
    std::string_view line;
    while (nextEntry(line)) {
      const auto words = splitWords(line);
      if (auto done = section(words); !done) return fail(done.error());
    }
    if (points_.empty()) return context_.refuse("the file holds no points");
    if (!intensity_.empty() && intensity_.size() != points_.size())
      return context_.refuse("there are " + std::to_string(intensity_.size()) + " intensities for " +
                             std::to_string(points_.size()) + " points");
    warnIgnored(context_, ignored_);
    PointTable table;
    table.columns = static_cast<int>(points_.size());
    table.points = std::move(points_);
    table.intensity = std::move(intensity_);
    Tables tables;
    tables.push_back(std::move(table));
    return tables;
  }

 private:
  tl::unexpected<Error> bad(std::string what) const {
    return context_.refuseByte(std::move(what), cursor_.position());
  }

  Status preamble() {
    std::string_view line;
    if (!cursor_.nextLine(line) || !line.starts_with("# vtk DataFile Version"))
      return bad("the first line is not that of a legacy VTK file");
    if (!cursor_.nextLine(line)) return bad("the file ends before its title");
    if (!cursor_.nextLine(line)) return bad("the file ends before ASCII or BINARY");
    const std::string_view kind = trimmed(line);
    if (kind != "ASCII" && kind != "BINARY") return bad(printable(kind) + " is neither ASCII nor BINARY");
    binary_ = kind == "BINARY";
    if (!nextEntry(line)) return bad("the file ends before its DATASET");
    const auto words = splitWords(line);
    if (words.size() != 2 || words[0] != "DATASET" ||
        (words[1] != "POLYDATA" && words[1] != "UNSTRUCTURED_GRID"))
      return bad("the data set is none of POLYDATA and UNSTRUCTURED_GRID");
    return {};
  }
  // The next line that is not blank.
  bool nextEntry(std::string_view& line) {
    while (cursor_.nextLine(line))
      if (!trimmed(line).empty()) return true;
    return false;
  }
  static std::optional<long long> count(std::string_view word) {
    const auto value = parseInteger(word);
    return value && *value >= 0 && *value <= 1'000'000'000'000LL ? value : std::nullopt;
  }

  Status section(const std::vector<std::string_view>& words) {
    const std::string_view name = words[0];
    if (name == "POINTS") return points(words);
    for (const char* cells : {"VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"})
      if (name == cells) return connections(words);
    if (name == "METADATA") return metadata();
    if (points_.empty()) return bad("the points do not come first");
    if (name == "CELL_TYPES")
      return words.size() == 2 ? skip(words[1], 1, "int") : bad("CELL_TYPES needs a count");
    if (name == "POINT_DATA" || name == "CELL_DATA") return attributes(words);
    if (name == "FIELD") return field(words);
    if (attribute_count_ < 0) return bad("the section " + printable(name) + " is unknown here");
    return attribute(words);
  }
  Status points(const std::vector<std::string_view>& words) {
    const auto number = words.size() == 3 ? count(words[1]) : std::nullopt;
    const Type* type = number ? typeNamed(words[2]) : nullptr;
    if (!type || !points_.empty()) return bad("POINTS needs a count and a type, once");
    if (type->kind != 'f') return bad("the points are not floats: export them as floats in metres");
    if (*number < 1 || *number > kMostCells) return bad("there are no points, or more than 100 million");
    if (auto fits = room(*number * 3, type); !fits) return fits;
    points_.resize(static_cast<std::size_t>(*number));
    return values(*number * 3, type,
                  [this](std::size_t i, double v) { points_[i / 3][static_cast<Eigen::Index>(i % 3)] = v; });
  }
  // The classic form, or that of version 5: two arrays.
  Status connections(const std::vector<std::string_view>& words) {
    const auto cells = words.size() == 3 ? count(words[1]) : std::nullopt;
    const auto size = words.size() == 3 ? count(words[2]) : std::nullopt;
    if (!cells || !size) return bad("the section of cells needs two counts");
    const std::size_t before = cursor_.position();
    std::string_view line;
    if (!nextEntry(line) || !line.starts_with("OFFSETS")) {
      cursor_.seek(before);
      return skip(words[2], 1, "int");
    }
    const auto offsets = splitWords(line);
    if (offsets.size() != 2) return bad("OFFSETS needs a type");
    if (auto done = skip(words[1], 1, offsets[1]); !done) return done;
    if (!nextEntry(line)) return bad("the file ends before CONNECTIVITY");
    const auto connectivity = splitWords(line);
    if (connectivity.size() != 2 || connectivity[0] != "CONNECTIVITY") return bad("CONNECTIVITY is missing");
    return skip(words[2], 1, connectivity[1]);
  }
  // Lines up to a blank one.
  Status metadata() {
    std::string_view line;
    while (cursor_.nextLine(line))
      if (trimmed(line).empty()) break;
    return {};
  }
  Status attributes(const std::vector<std::string_view>& words) {
    const auto number = words.size() == 2 ? count(words[1]) : std::nullopt;
    if (!number) return bad("the section of attributes needs a count");
    attribute_count_ = *number;
    of_points_ = words[0] == "POINT_DATA";
    if (of_points_ && *number != static_cast<long long>(points_.size()))
      return bad("there are attributes for " + std::to_string(*number) + " points, but " +
                 std::to_string(points_.size()) + " points");
    return {};
  }
  Status attribute(const std::vector<std::string_view>& words) {
    const std::string_view kind = words[0];
    if (kind == "SCALARS" && (words.size() == 3 || words.size() == 4)) {
      const auto components = words.size() == 4 ? count(words[3]) : 1;
      if (!components || *components < 1 || *components > 4) return bad("SCALARS have 1 to 4 components");
      // The line with the name of a colour table may be left out.
      const std::size_t before = cursor_.position();
      std::string_view line;
      if (!nextEntry(line) || !line.starts_with("LOOKUP_TABLE")) cursor_.seek(before);
      return array(words[1], words[2], *components, attribute_count_);
    }
    if (kind == "LOOKUP_TABLE" && words.size() == 3)
      return skip(words[2], 4, binary_ ? "unsigned_char" : "float");
    if (kind == "COLOR_SCALARS" && words.size() == 3) {
      const auto components = count(words[2]);
      if (!components || *components < 1 || *components > 4)
        return bad("COLOR_SCALARS have 1 to 4 components");
      ignore(words[1]);
      return skipNumber(attribute_count_, *components, binary_ ? "unsigned_char" : "float");
    }
    if ((kind == "NORMALS" || kind == "VECTORS") && words.size() == 3)
      return array(words[1], words[2], 3, attribute_count_);
    if (kind == "TENSORS" && words.size() == 3) return array(words[1], words[2], 9, attribute_count_);
    if (kind == "TEXTURE_COORDINATES" && words.size() == 4) {
      const auto components = count(words[2]);
      if (!components || *components < 1 || *components > 3)
        return bad("texture coordinates have 1 to 3 components");
      return array(words[1], words[3], *components, attribute_count_);
    }
    return bad("the section " + printable(kind) + " is unknown or incomplete");
  }
  Status field(const std::vector<std::string_view>& words) {
    const auto arrays = words.size() == 3 ? count(words[2]) : std::nullopt;
    if (!arrays || static_cast<unsigned long long>(*arrays) > cursor_.remaining())
      return bad("FIELD needs a name and a count");
    for (long long i = 0; i < *arrays; ++i) {
      std::string_view line;
      if (!nextEntry(line)) return bad("the file ends within a field");
      auto array_words = splitWords(line);
      if (array_words[0] == "METADATA") {
        if (auto done = metadata(); !done) return done;
        --i;
        continue;
      }
      const auto components = array_words.size() == 4 ? count(array_words[1]) : std::nullopt;
      const auto tuples = array_words.size() == 4 ? count(array_words[2]) : std::nullopt;
      if (!components || !tuples) return bad("an array of a field needs a name, two counts and a type");
      if (auto done = array(array_words[0], array_words[3], *components, *tuples); !done) return done;
    }
    return {};
  }
  // One attribute array: the intensity of the points, or left out.
  Status array(std::string_view name, std::string_view type_name, long long components, long long tuples) {
    const bool wanted = of_points_ && attribute_count_ == tuples && components == 1 && namesIntensity(name) &&
                        intensity_.empty();
    if (!wanted) {
      ignore(name);
      return skipNumber(tuples, components, type_name);
    }
    const Type* type = typeNamed(type_name);
    if (!type) return bad("the type " + printable(type_name) + " is unknown");
    if (auto fits = room(tuples, type); !fits) return fits;
    intensity_.resize(static_cast<std::size_t>(tuples));
    return values(tuples, type, [this](std::size_t i, double v) { intensity_[i] = static_cast<float>(v); });
  }
  void ignore(std::string_view name) { ignored_.push_back(std::string(name.substr(0, 40))); }

  Status skip(std::string_view number, long long components, std::string_view type_name) {
    const auto value = count(number);
    if (!value) return bad(printable(number) + " is not a count");
    return skipNumber(*value, components, type_name);
  }
  Status skipNumber(long long tuples, long long components, std::string_view type_name) {
    const Type* type = typeNamed(type_name);
    if (!type) return bad("the type " + printable(type_name) + " is unknown");
    if (components > 1'000'000) return bad("an array has an impossible number of components");
    if (tuples * components == 0) return {};
    if (auto fits = room(tuples * components, type); !fits) return fits;
    return values(tuples * components, type, [](std::size_t, double) {});
  }
  // Whether that many values can be there at all, before anything is allocated for them.
  Status room(long long number, const Type* type) const {
    // A printed number takes a digit and a blank, but for the last one.
    const std::size_t least = binary_ ? type->bytes : 2;
    const std::size_t left = cursor_.remaining() + (binary_ ? 0 : 1);
    if (static_cast<unsigned long long>(number) > left / least)
      return bad("the header tells of " + std::to_string(number) +
                 " numbers, more than the rest of the file can hold");
    return {};
  }
  template <class Use>
  Status values(long long number, const Type* type, Use use) {
    const auto total = static_cast<std::size_t>(number);
    if (binary_) {
      const std::size_t length = total * type->bytes;
      if (looksLikePrintedNumbers(bytes_.substr(cursor_.position(), length)) && length > 32)
        return bad("the header says BINARY, but the numbers are printed text");
      for (std::size_t i = 0; i < total; ++i) {
        if (context_.stopAt(i)) return context_.cancelled();
        use(i, bigEndian(cursor_.position() + i * type->bytes, *type));
      }
      cursor_.seek(cursor_.position() + length);
      return {};
    }
    std::string_view word;
    for (std::size_t i = 0; i < total; ++i) {
      if (context_.stopAt(i)) return context_.cancelled();
      if (!cursor_.nextWord(word))
        return bad("the file ends after " + std::to_string(i) + " of " + std::to_string(total) + " numbers");
      const auto value = coordinate(word);
      if (!value) return bad(printable(word) + " is not a number");
      use(i, *value);
    }
    return {};
  }
  double bigEndian(std::size_t at, const Type& type) const {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < type.bytes; ++i)
      word = (word << 8) | static_cast<unsigned char>(bytes_[at + i]);
    if (type.kind == 'f' && type.bytes == 4)
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(word)));
    if (type.kind == 'f') return std::bit_cast<double>(word);
    if (type.kind == 'u') return static_cast<double>(word);
    const int unused = static_cast<int>(64 - 8 * type.bytes);
    return static_cast<double>(static_cast<std::int64_t>(word << unused) >> unused);
  }

  std::string_view bytes_;
  TextCursor cursor_;
  const ParseContext& context_;
  bool binary_ = false, of_points_ = false;
  long long attribute_count_ = -1;
  std::vector<Eigen::Vector3d> points_;
  std::vector<float> intensity_;
  std::vector<std::string> ignored_;
};

}  // namespace

Result<Tables> parseVtk(std::string_view bytes, const ParseContext& context) {
  return VtkParser(bytes, context).parse();
}

}  // namespace tiltmap
