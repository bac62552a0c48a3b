// Filters on the range matrix, each telling which cells it changed and by how much (thesis 4.2.2.1).
#pragma once

#include <vector>

#include "core/scan/range_image.h"

namespace tiltmap {

enum class MedianWindow {
  None,
  Square,  // 3 x 3 over the matrix, the thesis' own filter
  Line,    // 7 neighbours in the same planar scan, its reference [3]; "planar median"
};

struct MedianFilterSettings {
  MedianWindow window = MedianWindow::Square;
  double threshold_m = 2.0;          // replaced when the centre differs from the median by more (thesis: 2 m)
  bool one_sided = false;            // only where the centre is further than the median ("larger than")
  bool include_centre = true;        // nine values (or eight of a line); false: the neighbours alone
  bool no_return_votes = false;      // cells without a return vote as no_return_range_m (the thesis)
  double no_return_range_m = 81.89;  // thesis 4.2.2: code 8189 read as a distance
};

struct CellChange {
  int row = 0;
  int column = 0;
  double before_m = 0.0;  // no_return_range_m where the cell held none
  double after_m = 0.0;   // no_return_range_m where it holds none now
};

struct FilteredImage {
  RangeImagePtr image;  // replaced cells carry cell_code::kReplaced, or kLmsOverflow where the median is no return
  std::vector<CellChange> changes;  // row-major order
  double meanChange() const;        // mean |after - before|, metres; 0 without changes
};

// At the border the window shrinks. A matrix of one row (unordered) comes back unchanged.
// Cells that were never scanned, masked, missing or out of bounds neither vote nor change.
FilteredImage medianFiltered(const RangeImagePtr& image, const MedianFilterSettings& settings);

}  // namespace tiltmap
