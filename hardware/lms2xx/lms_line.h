// A scan of an LMS 2xx as a line of the range matrix.
#pragma once

#include <span>
#include <vector>

#include "core/scan/scanner_geometry.h"
#include "hardware/lms2xx/unit_state.h"
#include "hardware/transport/clock.h"

namespace tiltmap {

// Everything of one telegram with values: as it was sent, as a row of a matrix, and when.
struct LmsLine {
  lms2xx::Measurement raw;
  lms2xx::Variant variant;
  lms2xx::MeasuringMode measuring_mode = lms2xx::MeasuringMode::FieldsAbDazzle;
  lms2xx::StatusByte status;

  // A cell per beam, rightmost first, as RangeImageData wants them.
  std::vector<float> range_m;
  std::vector<CellCode> code;
  std::vector<float> intensity;  // of types that send reflectivity; else empty

  Instant earliest_start{};  // the first beam was not measured before
  Instant first_byte{};      // the last beam was measured by then
  Instant last_byte{};
  double unix_time_s = 0.0;  // of last_byte
  int lost_before = 0;       // lines of a stream that were sent and did not arrive since the one before
};

// Fills in range, code and intensity from `raw`. Fails for energies and reserved units, which are no
// distances.
Status fillCells(LmsLine& line);

// The geometry of such lines; rows, tilt and calibration are left as they are.
ScannerGeometry geometryOf(const lms2xx::Variant& variant, ScannerGeometry rest = {});

// One line of half or quarter degrees from partial scans, in any order, one of each shift: x.00 and x.50, or
// all four. It begins with the earliest and ends with the latest. Fails where one is missing or twice.
Result<LmsLine> interleaved(std::span<const LmsLine> partials);

}  // namespace tiltmap
