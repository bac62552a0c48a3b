// Sums over tiles of a range matrix, from which the plane of any union of tiles follows without its points.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/registration/cell_samples.h"
#include "core/scan/range_image.h"
#include "core/scan/scanner_geometry.h"

namespace tiltmap {

// Count, first and second moments of points in the scan frame (m, m^2). Doubles: at 80 m the square loses
// 1e-12 m^2, far below any surface's noise.
struct Moments {
  double n = 0.0;
  double x = 0.0, y = 0.0, z = 0.0;
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  Moments& operator+=(const Moments& other) {
    n += other.n;
    x += other.x, y += other.y, z += other.z;
    xx += other.xx, xy += other.xy, xz += other.xz;
    yy += other.yy, yz += other.yz, zz += other.zz;
    return *this;
  }
  Eigen::Vector3d mean() const { return {x / n, y / n, z / n}; }
  Eigen::Matrix3d covariance() const;  // about the mean, divided by n
};

// Tiles side by side, row-major; those at the far edges may be smaller.
struct MomentGrid {
  int rows = 0;
  int columns = 0;
  std::vector<Moments> tile;
  // Where each tile's middle lies in a PatchRaster, or empty where nobody has looked; of a tile without cells
  // any place.
  std::vector<std::int32_t> place;

  const Moments& at(int row, int column) const {
    return tile[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                static_cast<std::size_t>(column)];
  }
};

// Moments of the cells of each tile that hold a point. With `drop_edges`, cells of a regular matrix take part
// only where 1/range is linear along the line and across the lines, as it is on any plane at any incidence
// (up to the step's cosine); at edges, mixed pixels and leaves it bends. The bound is 0.2 m of depth.
//
// With `samples`, the same cells are also appended there: those of a tile that is smaller than
// `whole_below_m` (the root of its covariance's trace) as one, others one by one.
MomentGrid tileMoments(const RangeImage& image, const ScannerGeometry& geometry, int tile_rows,
                       int tile_columns, bool drop_edges, CellSamples* samples = nullptr,
                       double whole_below_m = 0.0);
// The same into a grid whose memory is used again.
void tileMoments(const RangeImage& image, const ScannerGeometry& geometry, int tile_rows, int tile_columns,
                 bool drop_edges, CellSamples* samples, double whole_below_m, MomentGrid& grid);

// 2 x 2 tiles added up.
void halve(const MomentGrid& fine, MomentGrid& coarse);

}  // namespace tiltmap
