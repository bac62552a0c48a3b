#include "core/registration/grid_moments.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/scan/beam_tilts.h"

namespace tiltmap {

namespace {

constexpr float kBend_m = 0.2F;

// Sums over some beams of one line, in the plane of the mirror: the tilt is the same for all, so the three
// dimensions come in once a tile instead of once a beam.
struct LineSums {
  double n = 0.0, c = 0.0, s = 0.0, cc = 0.0, cs = 0.0, ss = 0.0;
};

// What the beams of one line have in common: p = arm + c * across + s * ahead, where (c, s) is the range
// times the cosine and sine of the azimuth.
struct LinePlane {
  Eigen::Vector3d arm, across, ahead;

  LinePlane(const ScannerGeometry& geometry, double tilt_rad) {
    const double e = tilt_rad + geometry.tilt_zero_rad;
    const double c = std::cos(e), s = std::sin(e);
    const auto tilted = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z());
    };
    arm = tilted(geometry.lever_arm_m);
    across = tilted(geometry.mounting * Eigen::Vector3d::UnitX());
    ahead = tilted(geometry.mounting * Eigen::Vector3d::UnitY());
  }

  Eigen::Vector3d point(double c, double s) const { return arm + c * across + s * ahead; }

  void addTo(Moments& m, const LineSums& k) const {
    const Eigen::Vector3d first = k.c * across + k.s * ahead;
    const Eigen::Vector3d a = k.cc * across + k.cs * ahead;
    const Eigen::Vector3d b = k.cs * across + k.ss * ahead;
    // sum of (arm + v) (arm + v)^T, v = c across + s ahead
    const auto second = [&](int i, int j) {
      return a[i] * across[j] + b[i] * ahead[j] + arm[i] * first[j] + first[i] * arm[j] +
             k.n * arm[i] * arm[j];
    };
    m.n += k.n;
    m.x += first.x() + k.n * arm.x();
    m.y += first.y() + k.n * arm.y();
    m.z += first.z() + k.n * arm.z();
    m.xx += second(0, 0), m.xy += second(0, 1), m.xz += second(0, 2);
    m.yy += second(1, 1), m.yz += second(1, 2), m.zz += second(2, 2);
  }
};

// Rows of 1 / range with a border of zeros, so that neighbours need no special case: a missing neighbour
// bends 1/range by much more than the bound.
class InverseRanges {
 public:
  InverseRanges(const RangeImage& image, const ScannerGeometry& geometry)
      : stride_(static_cast<std::size_t>(image.columns()) + 2) {
    inverse_.assign(stride_ * (static_cast<std::size_t>(image.rows()) + 2), 0.0F);
    const auto columns = static_cast<std::size_t>(image.columns());
    const auto offset = static_cast<float>(geometry.range_offset_m);
    const float* range = image.data().range_m.data();
    const CellCode* code = image.data().code.data();
    for (int row = 0; row < image.rows(); ++row) {
      float* out = inverse_.data() + (static_cast<std::size_t>(row) + 1) * stride_ + 1;
      for (std::size_t k = 0; k < columns; ++k)
        out[k] = cell_code::hasPoint(code[k]) ? 1.0F / (range[k] + offset) : 0.0F;
      range += columns, code += columns;
    }
  }
  // Of the cells of one row; [-1] and [columns] are 0.
  const float* row(int row) const {
    return inverse_.data() + (static_cast<std::size_t>(row + 1)) * stride_ + 1;
  }

 private:
  std::size_t stride_;
  // Fresh memory costs more than what is written there.
  static thread_local std::vector<float> inverse_;
};
thread_local std::vector<float> InverseRanges::inverse_;

void clear(MomentGrid& grid, int rows, int columns) {
  grid.rows = rows;
  grid.columns = columns;
  grid.tile.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), Moments{});
}

// Whether the cells of a tile lie so near each other that their mean stands for them.
bool isOne(const Moments& m, double whole_below_m) {
  const double square = (m.x * m.x + m.y * m.y + m.z * m.z) / m.n;
  return m.xx + m.yy + m.zz - square < m.n * whole_below_m * whole_below_m;
}

// A scanner's regular matrix: a line at a time, without making points.
class RegularTiles {
 public:
  RegularTiles(const RangeImage& image, const ScannerGeometry& geometry, int tile_rows, int tile_columns,
               bool drop_edges)
      : image_(image),
        geometry_(geometry),
        tile_rows_(tile_rows),
        tile_columns_(static_cast<std::size_t>(tile_columns)),
        drop_edges_(drop_edges),
        inverse_(image, geometry),
        columns_(static_cast<std::size_t>(image.columns())),
        cosine_(columns_),
        sine_(columns_),
        across_(columns_ * static_cast<std::size_t>(tile_rows)),
        ahead_(across_.size()),
        used_(across_.size()),
        // Of a moving line the neighbours are those of the same turn: beams of another one look elsewhere.
        apart_(tiltMoved(image) ? mirrorTurns(geometry) : 1),
        two_cos_azimuth_(static_cast<float>(2.0 * std::cos(apart_ * geometry.azimuth_step_rad))) {
    for (std::size_t k = 0; k < columns_; ++k) {
      const double a = geometry.azimuthOfColumn(static_cast<int>(k));
      cosine_[k] = std::cos(a), sine_[k] = std::sin(a);
    }
    const int rows = image.rows();
    const double step = rows > 1 ? (image.lineTilt(rows - 1) - image.lineTilt(0)) / (rows - 1) : 0.0;
    two_cos_tilt_ = static_cast<float>(2.0 * std::cos(step));
    if (tiltMoved(image)) tilts_.emplace(image, geometry);
  }

  // Row after row, from the first.
  void addLine(int row, Moments* tiles) {
    if (row % tile_rows_ == 0) planes_.clear();
    const std::size_t begin = planes_.size() * columns_;
    float* used = used_.data() + begin;
    double *across = across_.data() + begin, *ahead = ahead_.data() + begin;
    chooseCells(row, used);
    const float* ranges = image_.data().range_m.data() + image_.index(row, 0);
    for (std::size_t k = 0; k < columns_; ++k) {
      const double range =
          static_cast<double>(used[k]) * (static_cast<double>(ranges[k]) + geometry_.range_offset_m);
      across[k] = range * cosine_[k];
      ahead[k] = range * sine_[k];
    }
    const LinePlane& plane = planes_.emplace_back(geometry_, image_.lineTilt(row));
    if (tilts_) {
      addMovingLine(row, begin, tiles);
      return;
    }
    for (std::size_t first = 0; first < columns_; first += tile_columns_, ++tiles) {
      const std::size_t last = std::min(columns_, first + tile_columns_);
      LineSums sums;
      for (std::size_t k = first; k < last; ++k) {
        const double c = across[k], s = ahead[k];
        sums.n += static_cast<double>(used[k]);
        sums.c += c, sums.s += s;
        sums.cc += c * c, sums.cs += c * s, sums.ss += s * s;
      }
      if (sums.n > 0.0) plane.addTo(*tiles, sums);
    }
  }

  // Of the tiles whose lines came last.
  void sample(const Moments* tiles, double whole_below_m, CellSamples& samples) const {
    for (std::size_t first = 0; first < columns_; first += tile_columns_, ++tiles) {
      if (!(tiles->n > 0.0)) continue;
      if (isOne(*tiles, whole_below_m)) {
        samples.add(tiles->mean(), tiles->n);
        continue;
      }
      const std::size_t last = std::min(columns_, first + tile_columns_);
      for (std::size_t line = 0; line < planes_.size(); ++line)
        for (std::size_t k = line * columns_ + first; k < line * columns_ + last; ++k)
          if (used_[k] > 0.0F) samples.add(pointOf(line, k), 1.0);
    }
  }

 private:
  // Of the cell at `k` of the lines of these tiles.
  Eigen::Vector3d pointOf(std::size_t line, std::size_t k) const {
    return tilts_ ? points_[k] : planes_[line].point(across_[k], ahead_[k]);
  }

  void addMovingLine(int row, std::size_t begin, Moments* tiles) {
    tilts_->setRow(row);
    points_.resize(across_.size());
    const Eigen::Vector3d across = geometry_.mounting * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d ahead = geometry_.mounting * Eigen::Vector3d::UnitY();
    for (std::size_t k = 0; k < columns_; ++k) {
      const std::size_t cell = begin + k;
      if (!(used_[cell] > 0.0F)) continue;
      const Eigen::Vector3d v = geometry_.lever_arm_m + across_[cell] * across + ahead_[cell] * ahead;
      const double c = tilts_->cosine(k), s = tilts_->sine(k);
      const Eigen::Vector3d p(v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z());
      points_[cell] = p;
      tiles[k / tile_columns_] += {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
                                   p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
    }
  }

  // 1 where a cell takes part, 0 where not.
  void chooseCells(int row, float* used) {
    const float* here = inverse_.row(row);
    const float* before = inverse_.row(row - 1);
    const float* after = inverse_.row(row + 1);
    const std::ptrdiff_t apart = apart_;
    const float scale = 1.0F / static_cast<float>(apart_ * apart_);
    for (std::size_t k = 0; k < columns_; ++k) {
      const float q = here[k];
      if (!drop_edges_) {
        used[k] = q > 0.0F ? 1.0F : 0.0F;
        continue;
      }
      const float* at = here + k;
      const float bend_along = scale * std::abs(at[-apart] + at[apart] - two_cos_azimuth_ * q);
      const float bend_across = std::abs(before[k] + after[k] - two_cos_tilt_ * q);
      // |bend| r^2 below the bound; a cell without a point fails on 0 < 0.
      used[k] = std::max(bend_along, bend_across) < kBend_m * q * q ? 1.0F : 0.0F;
    }
    // Further out than one, the border's neighbours are cells of another row.
    if (!drop_edges_ || apart_ == 1) return;
    for (std::size_t k = 0; k < columns_; ++k)
      if (k < static_cast<std::size_t>(apart_) || k + static_cast<std::size_t>(apart_) >= columns_)
        used[k] = 0.0F;
  }

  const RangeImage& image_;
  const ScannerGeometry& geometry_;
  int tile_rows_;
  std::size_t tile_columns_;
  bool drop_edges_;
  InverseRanges inverse_;
  std::size_t columns_;
  std::vector<double> cosine_, sine_, across_, ahead_;
  std::vector<float> used_;
  std::vector<LinePlane> planes_;        // of the lines since the tiles began
  int apart_;                            // columns between beams of one turn of the mirror
  std::optional<BeamTilts> tilts_;       // where the tilt moved on
  std::vector<Eigen::Vector3d> points_;  // then: of the lines since the tiles began
  float two_cos_azimuth_, two_cos_tilt_ = 2.0F;
};

}  // namespace

Moments& Moments::operator+=(const Moments& other) {
  n += other.n;
  x += other.x, y += other.y, z += other.z;
  xx += other.xx, xy += other.xy, xz += other.xz;
  yy += other.yy, yz += other.yz, zz += other.zz;
  return *this;
}

Eigen::Matrix3d Moments::covariance() const {
  const Eigen::Vector3d m = mean();
  Eigen::Matrix3d c;
  c(0, 0) = xx / n - m.x() * m.x();
  c(1, 0) = c(0, 1) = xy / n - m.x() * m.y();
  c(2, 0) = c(0, 2) = xz / n - m.x() * m.z();
  c(1, 1) = yy / n - m.y() * m.y();
  c(2, 1) = c(1, 2) = yz / n - m.y() * m.z();
  c(2, 2) = zz / n - m.z() * m.z();
  return c;
}

MomentGrid tileMoments(const RangeImage& image, const ScannerGeometry& geometry, int tile_rows,
                       int tile_columns, bool drop_edges, CellSamples* samples, double whole_below_m) {
  MomentGrid grid;
  tileMoments(image, geometry, tile_rows, tile_columns, drop_edges, samples, whole_below_m, grid);
  return grid;
}

void tileMoments(const RangeImage& image, const ScannerGeometry& geometry, int tile_rows, int tile_columns,
                 bool drop_edges, CellSamples* samples, double whole_below_m, MomentGrid& grid) {
  if (tile_rows < 1 || tile_columns < 1) throw std::invalid_argument("tileMoments: a tile has no cells");
  clear(grid, (image.rows() + tile_rows - 1) / tile_rows,
        (image.columns() + tile_columns - 1) / tile_columns);
  if (image.isRegular()) {
    RegularTiles lines(image, geometry, tile_rows, tile_columns, drop_edges);
    for (int row = 0; row < image.rows(); ++row) {
      Moments* tiles = grid.tile.data() + static_cast<std::ptrdiff_t>(row / tile_rows) * grid.columns;
      lines.addLine(row, tiles);
      if (samples && ((row + 1) % tile_rows == 0 || row + 1 == image.rows()))
        lines.sample(tiles, whole_below_m, *samples);
    }
    return;
  }
  const auto tileOf = [&](int row, int column) -> Moments& {
    return grid.tile[static_cast<std::size_t>(row / tile_rows * grid.columns + column / tile_columns)];
  };
  for (int row = 0; row < image.rows(); ++row)
    for (int column = 0; column < image.columns(); ++column) {
      if (!image.hasPoint(row, column)) continue;
      const Eigen::Vector3d p = cellPoint(image, geometry, row, column);
      tileOf(row, column) += {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
                              p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
    }
  if (!samples) return;
  for (const Moments& tile : grid.tile)
    if (tile.n > 0.0 && isOne(tile, whole_below_m)) samples->add(tile.mean(), tile.n);
  for (int row = 0; row < image.rows(); ++row)
    for (int column = 0; column < image.columns(); ++column)
      if (image.hasPoint(row, column) && !isOne(tileOf(row, column), whole_below_m))
        samples->add(cellPoint(image, geometry, row, column), 1.0);
}

void halve(const MomentGrid& fine, MomentGrid& coarse) {
  clear(coarse, (fine.rows + 1) / 2, (fine.columns + 1) / 2);
  for (int row = 0; row < fine.rows; ++row)
    for (int column = 0; column < fine.columns; ++column)
      coarse.tile[static_cast<std::size_t>(row / 2 * coarse.columns + column / 2)] += fine.at(row, column);
}

}  // namespace tiltmap
