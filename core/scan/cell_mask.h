// Cells of a range matrix that are left out of everything, as runs along its rows.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/scan/range_image.h"

namespace tiltmap {

struct CellRun {
  int row = 0;
  int first = 0, last = 0;  // columns, both included

  bool operator==(const CellRun&) const = default;
};

// Of one scanner with one sweep: the same cells look at the machine's own body at every stop.
struct CellMask {
  int rows = 0;
  int columns = 0;
  std::vector<CellRun> runs;  // by row and column, apart from each other

  bool empty() const { return runs.empty(); }
  std::size_t cells() const;
  bool operator==(const CellMask&) const = default;
};

// From one flag a cell, row-major. Throws std::invalid_argument where their number is not rows x columns.
CellMask cellMask(int rows, int columns, const std::vector<char>& masked);
// One flag a cell.
std::vector<char> maskedCells(const CellMask& mask);
// Runs inside of the matrix, in order and apart.
Status checkCellMask(const CellMask& mask);

// "20x30 0:10-19 1:10-19": rows, columns, then row:first-last of each run. Error: another text, or runs that
// checkCellMask() refuses.
std::string cellMaskText(const CellMask& mask);
Result<CellMask> parseCellMask(const std::string& text, const std::string& where);

// Cells under the mask become cell_code::kMasked; those that were never scanned stay so. A mask of another
// size changes nothing and gives false.
bool maskCells(const CellMask& mask, RangeImageData& data);

}  // namespace tiltmap
