// The machine's own body in its scans: where it is, and how near it stays.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/parameter.h"
#include "core/base/result.h"
#include "core/scan/cell_mask.h"

namespace tiltmap {

// Plain data, SI units. Describe and set it through bodyMaskParameters().
struct BodyMaskSettings {
  double within_m = 0.8;   // the body ends nearer than this; the ground must begin further away
  double spread_m = 0.05;  // over several scans: how far a cell's range may vary
  double share = 0.8;      // and in how many of them it must show the body
  int margin_cells = 1;    // masked around it: beams that half hit it
};
const ParameterTable<BodyMaskSettings>& bodyMaskParameters();

struct BodyMask {
  int rows = 0;
  int columns = 0;
  std::vector<char> masked;  // row-major; 1: the machine's own, what the images had masked before included
  std::size_t cells = 0;     // found now, the margin not counted
  double furthest_m = 0.0;   // printed range of the body; 0 without one
  // With it as ScannerGeometry::minimum_range_m the body is out of every scan without a mask; 0 where
  // surroundings come as near as the body, or there is none.
  double minimum_range_m = 0.0;
};

// From one scan: every cell nearer than within_m. From several, taken at different places: cells that are
// near in nearly all of them and at the same range. Error: no image, sizes that differ, no regular matrix.
Result<BodyMask> learnBodyMask(const std::vector<RangeImagePtr>& images, const BodyMaskSettings& settings);

// What is masked, for a project's scans.
CellMask cellsOf(const BodyMask& mask);

// Rows and first to last column of each masked run, as JSON.
std::string bodyMaskText(const BodyMask& mask);
struct StoredBodyMask {
  CellMask cells;
  double minimum_range_m = 0.0;  // 0: none keeps the body out
};
// From a file that bodyMaskText() was written to. Error: not readable, of another kind, or cells outside of
// the matrix.
Result<StoredBodyMask> readBodyMask(const std::filesystem::path& path);

}  // namespace tiltmap
