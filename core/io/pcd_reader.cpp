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
#include "core/io/pcd_header.h"
#include "core/io/point_table.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

// Whole-numbered fields may be printed with a decimal point, but must lie in the range of their type.
bool fits(double value, const PcdField& field) {
  if (field.type == 'F') return field.size == 8 || !std::isfinite(value) || std::abs(value) <= 3.4e38;
  const double half = std::ldexp(1.0, 8 * field.size - 1);
  return field.type == 'I' ? value >= -half && value < half : value >= 0.0 && value < 2.0 * half;
}

// Exactly one line a point, exactly the fields a line, every word a number of its type; blank lines at the
// end only.
Status checkAscii(std::string_view bytes, const PcdHeader& header, const ParseContext& context) {
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
    for (const PcdField& field : header.fields) {
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

Status checkBinary(std::string_view bytes, const PcdHeader& header, const ParseContext& context) {
  const std::string_view body = bytes.substr(header.body_at);
  const std::size_t full = static_cast<std::size_t>(header.points) * header.pointBytes();
  const auto wrongLength = [&](std::size_t is, std::size_t should) {
    return context.refuseByte("the header asks for " + std::to_string(should) +
                                  " bytes of points, but there are " + std::to_string(is),
                              header.body_at);
  };
  if (header.body == PcdBody::Binary) {
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
  for (const PcdField& field : header.fields)
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

// The points, decoded by PCL from memory that has been checked: nothing can change between check and use.
Result<pcl::PCLPointCloud2> decoded(std::string_view bytes, const PcdHeader& header,
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
    std::istringstream header_stream(plainPcdHeader(header));
    if (reader.readHeader(header_stream, cloud, origin, orientation, version, data_type, body_at) != 0)
      return bad();
    if (cloud.data.size() != static_cast<std::size_t>(header.points) * header.pointBytes()) return bad();
    int outcome = 0;
    if (header.body == PcdBody::Ascii) {
      std::istringstream body(std::string(bytes.substr(header.body_at)));
      outcome = reader.readBodyASCII(body, cloud, version);
    } else {
      const auto* body = reinterpret_cast<const unsigned char*>(bytes.data());
      outcome = reader.readBodyBinary(body, cloud, version, header.body == PcdBody::Compressed,
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
  const auto header = parsePcdHeader(bytes, context);
  if (!header) return fail(header.error());
  const Status checked = header->body == PcdBody::Ascii ? checkAscii(bytes, *header, context)
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
  for (const PcdField& field : header->fields) {
    const bool used = field.name == "x" || field.name == "y" || field.name == "z" || field.name == "_" ||
                      (intensity && field.name == intensity->name);
    if (!used) ignored.push_back(field.name);
  }
  warnIgnored(context, ignored);
  return Tables{std::move(table)};
}

}  // namespace tiltmap
