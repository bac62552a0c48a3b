#include "core/io/point_table.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "core/base/text.h"
#include "core/io/tilted_grid.h"

namespace tiltmap {

namespace {

const char* const kMalformedRemedy = "check that the file was copied in full, or export it again";

// Coordinates of a map rather than of a scanner would lose millimetres as float directions and ranges.
constexpr double kFarCentre = 500.0;

struct Cells {
  std::vector<bool> finite;  // there is a point at all
  std::vector<bool> valid;   // and it lies within the bounds
  std::vector<CellCode> code;
  std::size_t valid_count = 0;
};

Result<Cells> judged(const PointTable& table, const ReadOptions& options, const ParseContext& context) {
  Cells cells;
  const std::size_t count = table.points.size();
  cells.finite.assign(count, false);
  cells.valid.assign(count, false);
  cells.code.assign(count, cell_code::kMissing);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& p = table.points[i];
    if (!p.allFinite()) continue;
    const double range = p.norm();
    if (!(range <= kFurthestPoint))
      return context.refuse("point " + std::to_string(i) + " lies " + shortestReal(range) + " m away", {},
                            "the numbers are no coordinates in metres; check the format");
    if (range < 1e-6) continue;
    cells.finite[i] = true;
    const bool inside = range >= options.minimum_range_m &&
                        (options.maximum_range_m <= 0.0 || range <= options.maximum_range_m);
    cells.code[i] = inside ? cell_code::kMeasured : cell_code::kOutOfBounds;
    if (!inside) continue;
    cells.valid[i] = true;
    ++cells.valid_count;
  }
  if (cells.valid_count == 0)
    return context.refuse("none of its " + std::to_string(count) + " points is finite and within the bounds",
                          {}, "check the bounds of the range, or leave the file out");
  return cells;
}

// Moves points that are far from their origin to near it; the pose takes the way. True where it did.
bool centred(PointTable& table, const Cells& cells) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < table.points.size(); ++i)
    if (cells.valid[i]) sum += table.points[i];
  const Eigen::Vector3d mean = sum / static_cast<double>(cells.valid_count);
  if (mean.norm() <= kFarCentre) return false;
  // Whole metres, so that the difference is exact. A hundredth off, so that no point can lie at the new
  // origin's integer coordinates by accident and be taken for a cell without a point.
  const Eigen::Vector3d centre = mean.array().round() + 0.0078125;
  for (std::size_t i = 0; i < table.points.size(); ++i) table.points[i] -= centre;
  table.pose = table.pose.value_or(Pose()) * Pose(Eigen::Quaterniond::Identity(), centre);
  return true;
}

void fillRegular(RangeImageData& data, ScannerGeometry& geometry, TiltedGrid grid) {
  data.rows = grid.geometry.rows;
  data.columns = grid.geometry.columns;
  data.range_m = std::move(grid.range_m);
  data.line_tilt_rad = std::move(grid.line_tilt_rad);
  geometry = grid.geometry;
}

void fillDirections(RangeImageData& data, ScannerGeometry& geometry, const PointTable& table,
                    const Cells& cells) {
  data.rows = geometry.rows = table.rows;
  data.columns = geometry.columns = table.columns;
  data.range_m.assign(table.points.size(), 0.0F);
  data.direction.assign(table.points.size(), Eigen::Vector3f::Zero());
  data.line_tilt_rad.assign(static_cast<std::size_t>(table.rows), 0.0);
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    if (!cells.valid[i]) continue;
    const double range = table.points[i].norm();
    data.range_m[i] = static_cast<float>(range);
    data.direction[i] = (table.points[i] / range).cast<float>();
  }
}

}  // namespace

tl::unexpected<Error> ParseContext::refuse(std::string what, std::string where, std::string remedy) const {
  return fail(std::move(what), where.empty() ? file : file + where,
              remedy.empty() ? kMalformedRemedy : std::move(remedy));
}

tl::unexpected<Error> ParseContext::refuseLine(std::string what, std::size_t line, std::string remedy) const {
  return refuse(std::move(what), ":" + std::to_string(line), std::move(remedy));
}

tl::unexpected<Error> ParseContext::refuseByte(std::string what, std::size_t byte, std::string remedy) const {
  return refuse(std::move(what), ", byte " + std::to_string(byte), std::move(remedy));
}

std::optional<double> coordinate(std::string_view word) {
  return parseReal(word);
}

bool looksLikePrintedNumbers(std::string_view body) {
  constexpr std::string_view kCharacters = "0123456789+-.,eEnaNAifIF \t\r\n";
  return !body.empty() && body.find_first_not_of(kCharacters) == std::string_view::npos;
}

bool namesIntensity(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::vector<std::string> names{"intensity",        "intensities",  "i",
                                              "reflectance",      "reflectivity", "remission",
                                              "scalar_intensity", "amplitude"};
  return std::ranges::find(names, lower) != names.end();
}

void warnIgnored(const ParseContext& context, const std::vector<std::string>& fields) {
  if (!fields.empty()) context.warn("left out: " + joined(fields, ", "));
}

Result<ImportedScan> assembleScan(PointTable table, const ReadOptions& options,
                                  const std::filesystem::path& path, const ParseContext& context) {
  const auto cells = static_cast<std::size_t>(table.rows) * static_cast<std::size_t>(table.columns);
  if (table.points.size() != cells || (!table.intensity.empty() && table.intensity.size() != cells))
    throw std::logic_error("a parser handed over a table that does not fill its matrix");
  if (cells > static_cast<std::size_t>(kMostCells))
    return context.refuse("it holds " + std::to_string(cells) + " points, and 100 million are the most", {},
                          "split it into single scans");
  auto judgement = judged(table, options, context);
  if (!judgement) return fail(judgement.error());

  RangeImageData data;
  ScannerGeometry geometry;
  int rows = table.rows, columns = table.columns;
  if (rows == 1) {
    // A list may still run line by line through a scanner's grid.
    if (const auto length = lineLength(table.points, judgement->finite)) {
      columns = *length;
      rows = static_cast<int>(cells / static_cast<std::size_t>(columns));
    }
  }
  if (auto grid = fitTiltedGrid(rows, columns, table.points, judgement->valid, kGridTolerance)) {
    fillRegular(data, geometry, std::move(*grid));
  } else {
    if (centred(table, *judgement))
      context.warn(
          "its points lie far from its origin; they were moved there, and the pose keeps the offset");
    fillDirections(data, geometry, table, *judgement);
  }
  data.code = std::move(judgement->code);
  data.intensity = std::move(table.intensity);
  geometry.minimum_range_m = options.minimum_range_m;
  geometry.maximum_range_m = options.maximum_range_m;

  auto image = RangeImage::make(std::move(data));
  if (!image) return context.refuse(image.error().what);
  ImportedScan imported;
  imported.scan = {*image, geometry, table.pose.value_or(Pose()), path.stem().string() + table.suffix,
                   path.filename().string()};
  imported.pose = table.pose;
  return imported;
}

}  // namespace tiltmap
