// Filters on the range matrix, each telling which cells it changed and by how much (thesis 4.2.2.1).
#pragma once

#include <vector>

#include "core/scan/range_image.h"

namespace tiltmap {

enum class MedianWindow {
  None,
  Square,  // 3 x 3 over the matrix, the thesis' own filter
  Line,    // seven beams in a row of one planar scan, the point in their middle (its reference [3])
};

struct MedianFilterSettings {
  MedianWindow window = MedianWindow::Square;
  double threshold_m = 2.0;      // replaced when the centre differs from the median by more (thesis: 2 m)
  bool one_sided = false;        // only where the centre is further than the median ("larger than")
  bool include_centre = true;    // all nine (or seven) values; false: the neighbours alone, eight (or six)
  bool no_return_votes = false;  // cells without a return vote as no_return_range_m (the thesis)
  double no_return_range_m = 81.89;  // thesis 4.2.2: code 8189 read as a distance
};

struct CellChange {
  int row = 0;
  int column = 0;
  double before_m = 0.0;  // no_return_range_m where the cell held none
  double after_m = 0.0;   // no_return_range_m where it holds none now
};

struct FilteredImage {
  RangeImagePtr image;              // the one given where nothing changed
  std::vector<CellChange> changes;  // row-major order
  // Mean |after - before|, metres; 0 without changes.
  double meanChange() const;
};

// A replaced cell holds the median as its range and carries cell_code::kReplaced.
//
// At the border the window shrinks. Of an even number of values the lower of the two middle ones is the
// median: a range that was measured, on the nearer surface, where their mean would lie in the air between two
// surfaces. Cells that were never scanned, dazzled, masked, missing or out of bounds neither vote nor change.
// With no_return_votes a cell without a return may become a point, and a point whose median is "no return"
// takes the code of the first such cell of its window (kLmsOverflow in the thesis' data). Without, cells that
// hold no point stay as they are. In a matrix with directions kept per cell a cell without a point has no
// direction, so there it stays in either case. An unordered image comes back unchanged. Throws
// std::invalid_argument for a null image, a threshold that is negative or not finite, and a no-return range
// that is not positive.
FilteredImage medianFiltered(const RangeImagePtr& image, const MedianFilterSettings& settings);

}  // namespace tiltmap
