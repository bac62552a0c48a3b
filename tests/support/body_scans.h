// Small scans in which the machine that carries the scanner is always seen.
#pragma once

#include <vector>

#include "core/scan/range_image.h"
#include "tests/support/range_images.h"

namespace tiltmap::testing_support {

inline constexpr int kBodyCells = 4;          // of the first row, from column 4 on
inline constexpr int kBodyAndMargin = 2 * 6;  // with one cell around them

// Of 10 x 12 cells, its surroundings 6 m away and further in each next one.
inline std::vector<Scan> scansWithBody(int count) {
  const ScannerGeometry geometry = smallGeometry(10, 12);
  std::vector<Scan> scans;
  for (int i = 0; i < count; ++i) {
    RangeImageData data = evenData(geometry, 6.0F + static_cast<float>(i));
    for (int column = 4; column < 4 + kBodyCells; ++column) setCell(data, 0, column, 0.4F);
    scans.push_back(
        {imageOf(std::move(data)), geometry, Pose::planar(0.0, i, 0.0), "stop " + std::to_string(i), "test"});
  }
  return scans;
}

}  // namespace tiltmap::testing_support
