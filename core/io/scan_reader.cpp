#include "core/io/scan_reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "core/base/text.h"
#include "core/io/file_bytes.h"
#include "core/io/point_table.h"
#include "core/io/pose_file.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

// By what only that format begins with; Auto where the bytes do not tell.
ScanFormat recognised(std::string_view bytes) {
  TextCursor cursor(bytes.substr(0, 4096));
  std::string_view line;
  for (int i = 0; i < 20 && cursor.nextLine(line); ++i) {
    const std::string_view text = trimmed(line);
    if (text.starts_with("# .PCD") || text.starts_with("FIELDS ") || text.starts_with("VERSION "))
      return ScanFormat::Pcd;
    if (i == 0 && text == "ply") return ScanFormat::Ply;
    if (i == 0 && text.starts_with("# vtk DataFile")) return ScanFormat::Vtk;
    if (!text.empty() && text.front() != '#') break;
  }
  // Columns, rows, then the scanner's position: three lines of 1, 1 and 3 numbers.
  TextCursor start(bytes.substr(0, 4096));
  const std::size_t expected[] = {1, 1, 3, 3, 3, 3};
  for (const std::size_t words : expected) {
    if (!start.nextLine(line) || splitWords(line).size() != words) return ScanFormat::Auto;
    for (const std::string_view word : splitWords(line))
      if (!parseReal(word)) return ScanFormat::Auto;
  }
  return ScanFormat::Ptx;
}

ScanFormat byExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".pcd") return ScanFormat::Pcd;
  if (extension == ".3d") return ScanFormat::Uos;
  if (extension == ".ply") return ScanFormat::Ply;
  if (extension == ".ptx") return ScanFormat::Ptx;
  if (extension == ".vtk") return ScanFormat::Vtk;
  for (const char* text : {".xyz", ".txt", ".csv", ".asc", ".pts"})
    if (extension == text) return ScanFormat::Xyz;
  return ScanFormat::Auto;
}

Result<ScanFormat> formatOf(const std::filesystem::path& path, std::string_view bytes,
                            const ReadOptions& options) {
  const ScanFormat seen = recognised(bytes);
  if (options.format == ScanFormat::Auto) {
    if (seen != ScanFormat::Auto) return seen;
    if (const ScanFormat named = byExtension(path); named != ScanFormat::Auto) return named;
    return fail(
        "the format is not recognised: the name has no extension known here, and the file begins with " +
            printable(bytes.substr(0, 24)),
        path.string(), "name the format: pcd, uos, ply, ptx, vtk or xyz");
  }
  if (seen != ScanFormat::Auto && seen != options.format)
    return fail("this is a " + scanFormatName(seen) + " file, not " + scanFormatName(options.format),
                path.string(), "leave the format to be recognised, or name " + scanFormatName(seen));
  return options.format;
}

Status checkOptions(const ReadOptions& options) {
  const double low = options.minimum_range_m, high = options.maximum_range_m;
  if (!std::isfinite(low) || !std::isfinite(high) || low < 0.0 || high < 0.0 || (high > 0.0 && high <= low))
    return fail("the bounds of the range leave nothing between them", "minimum and maximum range",
                "give a minimum of at least 0 m and a maximum above it, or 0 for no maximum");
  return {};
}

// The pose beside a .3d, where there is one.
Result<std::optional<Pose>> poseBeside(std::filesystem::path path) {
  path.replace_extension(".pose");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::optional<Pose>();
  auto pose = readPose3dtk(path);
  if (!pose) return fail(pose.error());
  return std::optional<Pose>(*pose);
}

}  // namespace

const std::vector<std::pair<std::string, ScanFormat>>& scanFormatNames() {
  static const std::vector<std::pair<std::string, ScanFormat>> names{
      {"auto", ScanFormat::Auto}, {"pcd", ScanFormat::Pcd}, {"uos", ScanFormat::Uos},
      {"ply", ScanFormat::Ply},   {"ptx", ScanFormat::Ptx}, {"vtk", ScanFormat::Vtk},
      {"xyz", ScanFormat::Xyz}};
  return names;
}

std::string scanFormatName(ScanFormat format) {
  for (const auto& [name, value] : scanFormatNames())
    if (value == format) return name;
  throw std::invalid_argument("no such scan format");
}

Result<Tables> parseAs(ScanFormat format, std::string_view bytes, const ParseContext& context) {
  switch (format) {
    case ScanFormat::Pcd:
      return parsePcd(bytes, context);
    case ScanFormat::Uos:
      return parseUos(bytes, context);
    case ScanFormat::Ply:
      return parsePly(bytes, context);
    case ScanFormat::Ptx:
      return parsePtx(bytes, context);
    case ScanFormat::Vtk:
      return parseVtk(bytes, context);
    case ScanFormat::Xyz:
      return parseXyz(bytes, context);
    case ScanFormat::Auto:
      break;
  }
  throw std::invalid_argument("the format must be known before a file is parsed");
}

Result<ReadResult> readScans(const std::filesystem::path& path, const ReadOptions& options,
                             const JobControl& control) {
  if (auto checked = checkOptions(options); !checked) return fail(checked.error());
  ReadResult result;
  const ParseContext context{path.string(), control, result.warnings};
  control.tell(0.0, "reading " + path.filename().string());
  const auto bytes = fileBytes(path, control);
  if (!bytes) return fail(bytes.error());
  const auto format = formatOf(path, *bytes, options);
  if (!format) return fail(format.error());
  auto tables = parseAs(*format, *bytes, context);
  if (!tables) return fail(tables.error());
  if (*format == ScanFormat::Uos) {
    auto pose = poseBeside(path);
    if (!pose) return fail(pose.error());
    tables->front().pose = *pose;
  }
  for (PointTable& table : *tables) {
    if (control.stopRequested()) return context.cancelled();
    auto scan = assembleScan(std::move(table), options, path, context);
    if (!scan) return fail(scan.error());
    result.scans.push_back(std::move(*scan));
  }
  control.tell(1.0, "read " + path.filename().string());
  return result;
}

}  // namespace tiltmap
