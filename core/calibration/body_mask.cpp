#include "core/calibration/body_mask.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/ranks.h"
#include "core/io/file_bytes.h"

namespace tiltmap {

namespace {

constexpr const char* kFormat = "tiltmap body mask 1";
constexpr double kClear_m = 0.05;    // of the body, in the minimum range
constexpr double kFewNearer = 1e-3;  // of all cells with a point may be lost to it

// The body's range in one cell, or 0.
double bodyRange(const std::vector<RangeImagePtr>& images, std::size_t cell, const BodyMaskSettings& settings,
                 std::vector<double>& near) {
  near.clear();
  std::size_t taken = 0;
  for (const RangeImagePtr& image : images) {
    if (image->code(cell) == cell_code::kNotScanned || image->code(cell) == cell_code::kMasked) continue;
    ++taken;
    const double range = static_cast<double>(image->range(cell));
    if (image->hasPoint(cell) && range < settings.within_m) near.push_back(range);
  }
  if (near.empty() || static_cast<double>(near.size()) < settings.share * static_cast<double>(taken))
    return 0.0;
  const double median = medianOf(near);
  const auto alike = std::ranges::count_if(
      near, [&](double range) { return std::abs(range - median) <= settings.spread_m; });
  return static_cast<double>(alike) < settings.share * static_cast<double>(taken) ? 0.0 : median;
}

std::vector<char> widened(const std::vector<char>& core, int rows, int columns, int margin) {
  std::vector<char> wide = core;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if (!core[static_cast<std::size_t>(row * columns + column)]) continue;
      for (int r = std::max(0, row - margin); r <= std::min(rows - 1, row + margin); ++r)
        for (int c = std::max(0, column - margin); c <= std::min(columns - 1, column + margin); ++c)
          wide[static_cast<std::size_t>(r * columns + c)] = 1;
    }
  return wide;
}

// Cells beside the mask that the range would cut away.
std::size_t lostTo(const std::vector<RangeImagePtr>& images, const std::vector<char>& masked, double range_m,
                   std::size_t& points) {
  std::size_t lost = 0;
  for (const RangeImagePtr& image : images)
    for (std::size_t cell = 0; cell < image->cells(); ++cell) {
      if (!image->hasPoint(cell)) continue;
      ++points;
      if (!masked[cell] && static_cast<double>(image->range(cell)) < range_m) ++lost;
    }
  return lost;
}

}  // namespace

const ParameterTable<BodyMaskSettings>& bodyMaskParameters() {
  using S = BodyMaskSettings;
  static const ParameterTable<S> table = [] {
    ParameterTable<S> t("body-mask");
    t.real("within", &S::within_m, "m", 0.05, 20.0,
           "Only what is nearer can be the machine's body. Choose it below the range of the nearest ground, "
           "which "
           "looks the same from everywhere too.",
           "ours");
    t.real("spread", &S::spread_m, "m", 0.001, 1.0, "How far a body cell's range may vary between scans.",
           "ours");
    t.real("share", &S::share, "", 0.5, 1.0, "In how many of the scans a body cell must be near.", "ours");
    t.integer("margin", &S::margin_cells, "cells", 0, 20,
              "Masked around the body, for beams that half hit it.", "ours");
    return t;
  }();
  return table;
}

Result<BodyMask> learnBodyMask(const std::vector<RangeImagePtr>& images, const BodyMaskSettings& settings) {
  if (images.empty())
    return fail("there is no scan to learn the body from", "body mask", "name at least one");
  for (const RangeImagePtr& image : images) {
    if (!image) throw std::invalid_argument("learnBodyMask: an image is missing");
    if (!image->isRegular() || image->rows() != images.front()->rows() ||
        image->columns() != images.front()->columns())
      return fail("the scans are not all regular matrices of one size", "body mask",
                  "name scans of one scanner with the same sweep");
  }
  BodyMask mask;
  mask.rows = images.front()->rows();
  mask.columns = images.front()->columns();
  mask.masked.assign(images.front()->cells(), 0);
  std::vector<double> near;
  for (std::size_t cell = 0; cell < mask.masked.size(); ++cell) {
    const double range = bodyRange(images, cell, settings, near);
    if (range <= 0.0) continue;
    mask.masked[cell] = 1;
    ++mask.cells;
    mask.furthest_m = std::max(mask.furthest_m, range);
  }
  mask.masked = widened(mask.masked, mask.rows, mask.columns, settings.margin_cells);
  for (const RangeImagePtr& image : images)
    for (std::size_t cell = 0; cell < image->cells(); ++cell)
      if (image->code(cell) == cell_code::kMasked) mask.masked[cell] = 1;
  if (mask.cells == 0) return mask;
  std::size_t points = 0;
  const double minimum = mask.furthest_m + kClear_m;
  const std::size_t lost = lostTo(images, mask.masked, minimum, points);
  if (static_cast<double>(lost) <= kFewNearer * static_cast<double>(points)) mask.minimum_range_m = minimum;
  return mask;
}

CellMask cellsOf(const BodyMask& mask) {
  return cellMask(mask.rows, mask.columns, mask.masked);
}

std::string bodyMaskText(const BodyMask& mask) {
  nlohmann::json runs = nlohmann::json::array();
  for (const CellRun& run : cellsOf(mask).runs) runs.push_back({run.row, run.first, run.last});
  return nlohmann::json{{"format", kFormat},
                        {"rows", mask.rows},
                        {"columns", mask.columns},
                        {"cells", mask.cells},
                        {"furthest_m", mask.furthest_m},
                        {"minimum_range_m", mask.minimum_range_m},
                        {"runs_row_first_last", runs}}
             .dump() +
         "\n";
}

Result<StoredBodyMask> readBodyMask(const std::filesystem::path& path) {
  const auto bytes = fileBytes(path);
  if (!bytes) return fail(bytes.error());
  const auto refuse = [&](const std::string& what) {
    return fail(what, path.string(), "name a file that `tiltmap body-mask --out` has written");
  };
  const auto json = nlohmann::json::parse(*bytes, nullptr, false);
  if (!json.is_object() || json.value("format", nlohmann::json()) != kFormat)
    return refuse("the file holds no body mask");
  StoredBodyMask stored;
  try {
    stored.cells.rows = json.at("rows").get<int>();
    stored.cells.columns = json.at("columns").get<int>();
    stored.minimum_range_m = json.at("minimum_range_m").get<double>();
    for (const auto& run : json.at("runs_row_first_last"))
      stored.cells.runs.push_back({run.at(0).get<int>(), run.at(1).get<int>(), run.at(2).get<int>()});
  } catch (const nlohmann::json::exception&) {
    return refuse("the body mask in the file is not complete");
  }
  if (const Status status = checkCellMask(stored.cells); !status) return refuse(status.error().what);
  if (!(stored.minimum_range_m >= 0.0) || stored.minimum_range_m > 100.0)
    return refuse("the minimum range in the file is impossible");
  return stored;
}

}  // namespace tiltmap
