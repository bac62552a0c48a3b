// What the parsers of the formats hand over: points as the file has them, before they become a scan.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/io/scan_reader.h"

namespace tiltmap {

// Metres, scan frame. A point that is not finite or at the origin stands for a cell without one.
struct PointTable {
  int rows = 1;  // above 1: the file keeps a matrix, row-major
  int columns = 0;
  std::vector<Eigen::Vector3d> points;
  std::vector<float> intensity;  // empty, or one a point
  std::optional<Pose> pose;      // world_from_scan, where the file tells one that is not the identity
  std::string suffix;            // of the scan's name, where a file holds several: "/2"
};

// Where a parser is, and where its remarks go.
struct ParseContext {
  std::string file;  // as errors and warnings name it
  const JobControl& control;
  std::vector<std::string>& warnings;

  void warn(const std::string& text) const { warnings.push_back(file + ": " + text); }
  tl::unexpected<Error> refuse(std::string what, std::string where = {}, std::string remedy = {}) const;
  tl::unexpected<Error> refuseLine(std::string what, std::size_t line, std::string remedy = {}) const;
  tl::unexpected<Error> refuseByte(std::string what, std::size_t byte, std::string remedy = {}) const;
  tl::unexpected<Error> cancelled() const { return fail(kCancelled, file, "start again when you like"); }
  // Cheap enough for every point: looks at the stop token each 8192.
  bool stopAt(std::size_t i) const { return (i & 8191U) == 0 && control.stopRequested(); }
};

// The parsers: pure functions of the bytes, each checking everything before it allocates by it.
using Tables = std::vector<PointTable>;
Result<Tables> parsePcd(std::string_view bytes, const ParseContext& context);
Result<Tables> parseUos(std::string_view bytes, const ParseContext& context);
Result<Tables> parsePly(std::string_view bytes, const ParseContext& context);
Result<Tables> parsePtx(std::string_view bytes, const ParseContext& context);
Result<Tables> parseVtk(std::string_view bytes, const ParseContext& context);
Result<Tables> parseXyz(std::string_view bytes, const ParseContext& context);
Result<Tables> parseAs(ScanFormat format, std::string_view bytes, const ParseContext& context);

// More cells than this are refused; RangeImage and ScannerGeometry take no more.
inline constexpr long long kMostCells = 100'000'000;
// Further points (metres) are taken for bytes that are no coordinates.
inline constexpr double kFurthestPoint = 1e9;

// A word that must be a number; nan and inf are numbers, what overflows a double is not.
std::optional<double> coordinate(std::string_view word);
// True where a body that should be binary consists of the characters of printed numbers alone.
bool looksLikePrintedNumbers(std::string_view body);
// Names that stand for the intensity, in any case: intensity, intensities, i, reflectance, reflectivity,
// remission, scalar_intensity, amplitude.
bool namesIntensity(std::string_view name);
// "fields that were left out: r, g, b", or nothing where the list is empty.
void warnIgnored(const ParseContext& context, const std::vector<std::string>& fields);

// The table as a scan: bounds, codes, the regular grid where there is one (see readScans).
Result<ImportedScan> assembleScan(PointTable table, const ReadOptions& options,
                                  const std::filesystem::path& path, const ParseContext& context);

}  // namespace tiltmap
