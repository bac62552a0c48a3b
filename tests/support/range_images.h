// Range images made by hand, for tests.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/scan/range_image.h"

namespace tiltmap::testing_support {

// Data of the geometry's matrix at nominal tilts, every cell measured at `range_m`.
inline RangeImageData evenData(const ScannerGeometry& geometry, float range_m = 5.0F) {
  RangeImageData data;
  data.rows = geometry.rows;
  data.columns = geometry.columns;
  data.range_m.assign(data.cells(), range_m);
  data.code.assign(data.cells(), cell_code::kMeasured);
  for (int row = 0; row < data.rows; ++row) data.line_tilt_rad.push_back(geometry.tiltOfRow(row));
  return data;
}

inline RangeImagePtr imageOf(RangeImageData data) {
  auto made = RangeImage::make(std::move(data));
  if (!made) throw std::runtime_error(made.error().what);
  return *made;
}

// A small matrix of the thesis' steps.
inline ScannerGeometry smallGeometry(int rows, int columns) {
  ScannerGeometry geometry;
  geometry.rows = rows;
  geometry.columns = columns;
  return geometry;
}

// One cell of data.
inline void setCell(RangeImageData& data, int row, int column, float range_m,
                    CellCode code = cell_code::kMeasured) {
  const std::size_t cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(data.columns) +
                           static_cast<std::size_t>(column);
  data.range_m[cell] = range_m;
  data.code[cell] = code;
}

// What an ideal scanner measures of a scene: `distance` takes a unit direction from the origin (which stands
// in for the mirror) and gives metres, infinity where nothing is hit.
inline RangeImagePtr imageOfScene(const ScannerGeometry& geometry,
                                  const std::function<double(const Eigen::Vector3d&)>& distance) {
  RangeImageData data = evenData(geometry);
  for (int row = 0; row < data.rows; ++row) {
    for (int column = 0; column < data.columns; ++column) {
      const double range =
          distance(geometry.direction(geometry.tiltOfRow(row), geometry.azimuthOfColumn(column)));
      if (range > 80.0) {
        setCell(data, row, column, 0.0F, cell_code::kLmsOverflow);
      } else {
        setCell(data, row, column, static_cast<float>(range));
      }
    }
  }
  return imageOf(std::move(data));
}

// Distance along a direction to the plane normal . p = offset, infinity where it is behind.
inline double distanceToPlane(const Eigen::Vector3d& direction, const Eigen::Vector3d& normal,
                              double offset) {
  const double along = normal.dot(direction);
  const double distance = offset / along;
  return along != 0.0 && distance > 0.0 ? distance : std::numeric_limits<double>::infinity();
}

}  // namespace tiltmap::testing_support
