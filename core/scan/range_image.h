// The range matrix: what one tilted sweep measured. The truth that everything else is derived from.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/scan/scanner_geometry.h"

namespace tiltmap {

// Why a cell holds a point, or none. LMS overflow codes (8183 to 8191) are kept as the scanner sent them, so
// that "far" and "no information" stay apart.
using CellCode = std::uint16_t;
namespace cell_code {
inline constexpr CellCode kMeasured = 0;
inline constexpr CellCode kReplaced = 1;  // a filter put another range here; still a point
inline constexpr CellCode kFirstWithoutPoint = 16;
inline constexpr CellCode kMissing = 16;  // the file had nothing here (NaN, origin)
inline constexpr CellCode kOutOfBounds =
    17;                                  // nearer or further than the bounds set for the scanner or import
inline constexpr CellCode kMasked = 18;  // the machine's own body
inline constexpr CellCode kNotScanned = 19;     // the line was never taken
inline constexpr CellCode kNoReturn = 20;       // nothing came back, from a scanner without codes
inline constexpr CellCode kLmsFirst = 8183;     // 1FF7: above the maximum range
inline constexpr CellCode kLmsOverflow = 8189;  // 1FFD, the thesis' "81.89 m"
inline constexpr CellCode kLmsDazzled = 8190;   // 1FFE
inline constexpr CellCode kLmsNoSignal = 8191;  // 1FFF: no stop signal
inline constexpr CellCode kLmsLast = 8191;

constexpr bool hasPoint(CellCode code) {
  return code < kFirstWithoutPoint;
}
// Nothing there to be hit, as far as the scanner can see (not: dazzled, missing, masked).
constexpr bool isFar(CellCode code) {
  return code == kNoReturn || code == kLmsFirst || code == kLmsOverflow || code == kLmsNoSignal;
}
}  // namespace cell_code

// The parts of a range image, to be filled and handed to RangeImage::make. Matrices are row-major, rows x
// columns.
struct RangeImageData {
  int rows = 0;
  int columns = 0;
  std::vector<float> range_m;  // printed range; 0 where the cell holds no point
  std::vector<CellCode> code;
  std::vector<float> intensity;       // empty, or one a cell; unit of the device
  std::vector<double> line_tilt_rad;  // one a row: the tilt read back (before tilt_zero)
  std::vector<double> line_time_s;    // empty, or one a row: since the Unix epoch, at the end of the line
  // Empty for a scanner's regular grid. Else one unit direction a cell (scan frame, from the origin), for
  // matrices whose grid no geometry describes and for unordered clouds (1 x N); zero where the cell holds no
  // point.
  std::vector<Eigen::Vector3f> direction;

  std::size_t cells() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
};

// Immutable and shared. Every cell with a point has a finite, positive range.
class RangeImage {
 public:
  // Refuses sizes that do not fit, ranges that are not finite and positive where the code says there is a
  // point.
  static Result<std::shared_ptr<const RangeImage>> make(RangeImageData data);

  int rows() const { return data_.rows; }
  int columns() const { return data_.columns; }
  std::size_t cells() const { return data_.cells(); }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(data_.columns) +
           static_cast<std::size_t>(column);
  }
  bool hasPoint(std::size_t cell) const { return cell_code::hasPoint(data_.code[cell]); }
  bool hasPoint(int row, int column) const { return hasPoint(index(row, column)); }
  float range(std::size_t cell) const { return data_.range_m[cell]; }
  float range(int row, int column) const { return data_.range_m[index(row, column)]; }
  CellCode code(std::size_t cell) const { return data_.code[cell]; }
  CellCode code(int row, int column) const { return data_.code[index(row, column)]; }
  bool hasIntensity() const { return !data_.intensity.empty(); }
  float intensity(std::size_t cell) const { return data_.intensity[cell]; }
  double lineTilt(int row) const { return data_.line_tilt_rad[static_cast<std::size_t>(row)]; }
  bool hasTimes() const { return !data_.line_time_s.empty(); }
  double lineTime(int row) const { return data_.line_time_s[static_cast<std::size_t>(row)]; }
  // False where directions are kept per cell.
  bool isRegular() const { return data_.direction.empty(); }
  // False for an unordered cloud (1 x N with directions): neighbouring cells are then not neighbours in
  // space. A single line of a regular scanner is a matrix of one row.
  bool isMatrix() const { return data_.rows > 1 || isRegular(); }
  const std::vector<Eigen::Vector3f>& directions() const { return data_.direction; }

  std::size_t validCells() const { return valid_cells_; }
  // Lines with at least one cell that was scanned.
  int scannedLines() const;
  const RangeImageData& data() const { return data_; }

 private:
  explicit RangeImage(RangeImageData data);
  RangeImageData data_;
  std::size_t valid_cells_ = 0;
};

using RangeImagePtr = std::shared_ptr<const RangeImage>;

// One stop: what was measured there and where the odometry puts it. Poses found by registration belong to the
// project.
struct Scan {
  RangeImagePtr image;
  ScannerGeometry geometry;
  Pose odometry;       // world_from_scan
  std::string name;    // shown to people; need not be unique
  std::string source;  // "simulated exp2 seed 1", a file's name, a device
};

// The point of one cell in the scan frame, metres. The cell must hold a point.
Eigen::Vector3d cellPoint(const RangeImage& image, const ScannerGeometry& geometry, int row, int column);
// All of them, row-major, one slot a cell; slots of cells without a point are zero and must not be read.
std::vector<Eigen::Vector3d> cellPoints(const RangeImage& image, const ScannerGeometry& geometry);

}  // namespace tiltmap
