// The range matrix as a picture: one cell, one pixel, seen from the scanner (thesis figures 4.6 and 4.7).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/products/rgb_image.h"
#include "core/scan/range_image.h"

namespace tiltmap {

enum class DepthQuantity {
  Range,         // as measured
  Median,        // after the 3 x 3 median
  PlanarMedian,  // after the median along the line
  Changed,       // the cells that the 3 x 3 median replaced
  Normal,        // the surface's normal, scan frame
  Incidence,     // between beam and normal
  Intensity,
  Code,      // why a cell holds a point, or none
  Residual,  // after registration: the signed distance from other scans' surfaces
};
inline constexpr DepthQuantity kDepthQuantities[] = {
    DepthQuantity::Range,     DepthQuantity::Median, DepthQuantity::PlanarMedian,
    DepthQuantity::Changed,   DepthQuantity::Normal, DepthQuantity::Incidence,
    DepthQuantity::Intensity, DepthQuantity::Code,   DepthQuantity::Residual};

// "range", "median", "planar-median", "changed", "normal", "incidence", "intensity", "code", "residual":
// for flags.
const std::string& depthQuantityName(DepthQuantity quantity);
Result<DepthQuantity> parseDepthQuantity(const std::string& name);

// One side of the matrix: what stands at cell k is start + k * step.
struct DepthAxis {
  std::string title;  // "Azimuth (°)", or "Column" where the matrix has no regular grid
  double start = 0.0;
  double step = 1.0;
  double at(double cell) const { return start + cell * step; }
  double cellOf(double value) const { return (value - start) / step; }
};

struct DepthImage {
  DepthQuantity quantity = DepthQuantity::Range;
  int rows = 0;
  int columns = 0;
  // One a cell, row-major; NaN where there is nothing to show. Metres (range, medians, size of a change),
  // degrees (incidence), the device's unit, the code; for normals the z component.
  std::vector<float> value;
  std::vector<Rgb> colour;         // normals and codes: one a cell; else empty
  std::vector<std::uint8_t> mark;  // changed cells: 1; else empty
  std::vector<float> backdrop;     // changed cells: the range, drawn in grey below; else empty
  std::size_t changed = 0;
  double mean_change_m = 0.0;
  std::size_t overlapping = 0;  // residuals: cells that have one, and the median of their sizes
  double median_residual_m = 0.0;
  // Most values lie between these: the colour bar's ends unless it is locked.
  double low = 0.0;
  double high = 1.0;
  std::string title;    // "Range"
  std::string unit;     // "m", "°" or empty
  bool regular = true;  // axes are angles; else they are numbers of columns and rows
  DepthAxis azimuth;    // of the columns
  DepthAxis tilt;       // of the rows
  std::vector<std::pair<std::string, Rgb>> legend;  // normals and codes

  bool hasColourBar() const { return colour.empty() && quantity != DepthQuantity::Changed; }
  // Zero is the middle of the colours.
  bool isSigned() const { return quantity == DepthQuantity::Residual; }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  // Azimuth grows to the left and tilt upwards, as the scanner looks at the world; a matrix without a regular
  // grid starts at the top left.
  bool columnsTurned() const { return regular && azimuth.step > 0.0; }
  bool rowsTurned() const { return regular && tilt.step > 0.0; }
  int pixelOfColumn(int column) const { return columnsTurned() ? columns - 1 - column : column; }
  int pixelOfRow(int row) const { return rowsTurned() ? rows - 1 - row : row; }
  int columnAtPixel(int x) const { return pixelOfColumn(x); }
  int rowAtPixel(int y) const { return pixelOfRow(y); }
};

// `residuals`: one a cell, as ProjectResiduals gives them; for that quantity only. Error: an unordered cloud,
// which has no matrix; intensity of a scan that has none; residuals that are not there.
Result<DepthImage> depthImageOf(const RangeImagePtr& image, const ScannerGeometry& geometry,
                                DepthQuantity quantity, const std::vector<float>& residuals = {});

// Sets low and high so that most values lie between them: what depthImageOf() does, for an image whose values
// come one after the other. Left alone where there are none.
void chooseDepthEnds(DepthImage& image);

// columns x rows pixels. Values outside low..high get the colour of the nearer end; `no_data` fills cells
// without a value.
RgbImage depthPicture(const DepthImage& image, double low, double high, Rgb no_data);
// The colour of one value between low and high.
Rgb depthColour(double value, double low, double high);
// The same as this image shows it: of signed values zero is the middle, whatever the ends.
Rgb depthColour(const DepthImage& image, double value, double low, double high);

// "measured", "no return", "dazzled (LMS 8190)": what a code means.
std::string cellCodeText(CellCode code);

}  // namespace tiltmap
