// Loops over the cells of one line of a scanner's regular matrix, and over its tiles: many side by side, the
// same bits from every instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/scan/range_image.h"

namespace tiltmap {

// 1 / (range + offset) of each cell with a point, else 0.
void invertRanges(const float* range_m, const CellCode* code, std::size_t count, float offset_m,
                  float* inverse);

// What a plane's inverse ranges are held against; see tileMoments.
struct BendRule {
  std::ptrdiff_t apart = 1;      // columns to the neighbours along the line
  float two_cos_azimuth = 2.0F;  // of the step to them
  float two_cos_tilt = 2.0F;     // of the step to the neighbouring lines
};

// 1 where 1 / range is linear along the line and across the lines, else 0. Rows of inverse ranges, of which
// `apart` entries on either side are read.
void chooseCells(const float* before, const float* here, const float* after, std::size_t count,
                 const BendRule& rule, float* used);

// The cells in the plane of the mirror: (range + offset) times the cosine and the sine of the azimuth, zero
// where a cell is not used.
void placeInLine(const float* used, const float* range_m, std::size_t count, double offset_m,
                 const double* cosine, const double* sine, double* across, double* ahead);

// Points of the cells of one line: start + across a + ahead b for each, where (a, b) is a cell in the
// mirror's plane.
struct LineFrame {
  std::array<double, 3> start, across, ahead;
};
void placeInSpace(const double* across, const double* ahead, std::size_t count, const LineFrame& frame,
                  float* x, float* y, float* z);

// Sums over a tile's cells of one line: of 1, c, s, cc, cs, ss, where (c, s) is a cell in the mirror's plane.
inline constexpr std::size_t kLineSums = 6;
// Into `sums`, kLineSums rows of `tiles` numbers. The rows of cells end with zeros up to a whole tile.
void sumTiles(const float* used, const double* across, const double* ahead, std::size_t tiles,
              std::size_t tile_columns, double* sums);

// How many, and the first and second moments (x, y, z, xx, xy, xz, yy, yz, zz): each is a sum of kLineSums
// products.
inline constexpr std::size_t kTileMoments = 10;
using LineToMoments = std::array<std::array<double, kLineSums>, kTileMoments>;
// Adds the line to `moments`, kTileMoments rows of `tiles` numbers. Without `has_arm` only c and s count for
// first moments, and cc, cs and ss for the second ones.
void addLineSums(const double* sums, std::size_t tiles, const LineToMoments& by, bool has_arm,
                 double* moments);

// Where the middles of tiles lie in a PatchRaster; of one without cells any place.
void placeTiles(const double* moments, std::size_t tiles, std::int32_t* place);

}  // namespace tiltmap
