#include "core/registration/grid_moments.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/registration/line_sums.h"
#include "core/scan/beam_tilts.h"

namespace tiltmap {

namespace {

// Fresh memory costs more than what is written there, so each thread keeps its own.
struct Scratch {
  std::vector<float> inverse, used;
  std::vector<double> across, ahead, sums, moments;
  std::vector<float> x, y, z;  // of the cells of a row of tiles
  CellSamples samples;
};
thread_local Scratch scratch;

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

  LineFrame frame() const {
    return {
        {arm.x(), arm.y(), arm.z()}, {across.x(), across.y(), across.z()}, {ahead.x(), ahead.y(), ahead.z()}};
  }

  // The tilt is the same for a whole line, so the three dimensions come in once a tile, not once a beam.
  LineToMoments moments() const {
    LineToMoments by{};
    std::size_t m = 0;
    by[m++][0] = 1.0;
    for (int i = 0; i < 3; ++i) by[m++] = {arm[i], across[i], ahead[i], 0.0, 0.0, 0.0};
    // (arm + c across + s ahead)_i (...)_j
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        by[m++] = {arm[i] * arm[j],
                   arm[i] * across[j] + across[i] * arm[j],
                   arm[i] * ahead[j] + ahead[i] * arm[j],
                   across[i] * across[j],
                   across[i] * ahead[j] + ahead[i] * across[j],
                   ahead[i] * ahead[j]};
    return by;
  }
};

// Rows of 1 / range with a border of zeros, so that neighbours need no special case: a missing neighbour
// bends 1/range by much more than the bound.
class InverseRanges {
 public:
  InverseRanges(const RangeImage& image, const ScannerGeometry& geometry)
      : stride_(static_cast<std::size_t>(image.columns()) + 2) {
    const auto columns = static_cast<std::size_t>(image.columns());
    std::vector<float>& inverse = scratch.inverse;
    inverse.resize(stride_ * (static_cast<std::size_t>(image.rows()) + 2));
    std::fill_n(inverse.begin(), stride_, 0.0F);
    std::fill_n(inverse.end() - static_cast<std::ptrdiff_t>(stride_), stride_, 0.0F);
    for (int row = 0; row < image.rows(); ++row) {
      float* out = inverse.data() + (static_cast<std::size_t>(row) + 1) * stride_ + 1;
      const std::size_t first = image.index(row, 0);
      invertRanges(image.data().range_m.data() + first, image.data().code.data() + first, columns,
                   static_cast<float>(geometry.range_offset_m), out);
      out[-1] = out[columns] = 0.0F;
    }
  }
  // Of the cells of one row; [-1] and [columns] are 0.
  const float* row(int row) const {
    return scratch.inverse.data() + (static_cast<std::size_t>(row + 1)) * stride_ + 1;
  }

 private:
  std::size_t stride_;
};

Moments momentsOf(const Eigen::Vector3d& p) {
  return {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
          p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
}

void setSize(MomentGrid& grid, int rows, int columns) {
  grid.rows = rows;
  grid.columns = columns;
  grid.tile.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  grid.place.clear();
}

void clear(MomentGrid& grid, int rows, int columns) {
  grid.tile.clear();
  setSize(grid, rows, columns);
}

// Whether the cells of a tile lie so near each other that their mean stands for them.
bool isOne(const Moments& m, double whole_below_m) {
  const double square = m.x * m.x + m.y * m.y + m.z * m.z;
  return (m.xx + m.yy + m.zz) * m.n - square < m.n * m.n * whole_below_m * whole_below_m;
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
        tiles_((columns_ + tile_columns_ - 1) / tile_columns_),
        stride_(tiles_ * tile_columns_),
        has_arm_(!geometry.lever_arm_m.isZero(0.0)),
        cosine_(columns_),
        sine_(columns_) {
    for (std::size_t k = 0; k < columns_; ++k) {
      const double a = geometry.azimuthOfColumn(static_cast<int>(k));
      cosine_[k] = std::cos(a), sine_[k] = std::sin(a);
    }
    // Of a moving line the neighbours are those of the same turn: beams of another one look elsewhere.
    rule_.apart = tiltMoved(image) ? mirrorTurns(geometry) : 1;
    const auto apart = static_cast<double>(rule_.apart);
    rule_.two_cos_azimuth = static_cast<float>(2.0 * std::cos(apart * geometry.azimuth_step_rad));
    const int rows = image.rows();
    const double step = rows > 1 ? (image.lineTilt(rows - 1) - image.lineTilt(0)) / (rows - 1) : 0.0;
    rule_.two_cos_tilt = static_cast<float>(2.0 * std::cos(step));
    if (tiltMoved(image)) tilts_.emplace(image, geometry);
    const std::size_t cells = stride_ * static_cast<std::size_t>(tile_rows);
    scratch_.used.assign(cells, 0.0F);
    scratch_.across.assign(cells, 0.0);
    scratch_.ahead.assign(cells, 0.0);
    scratch_.sums.resize(kLineSums * tiles_);
    scratch_.moments.resize(kTileMoments * tiles_);
    planes_.reserve(static_cast<std::size_t>(tile_rows));
  }

  // Whether tiles get their places.
  bool placesTiles() const { return !tilts_; }

  // Row after row, from the first; `tiles` and `place` are those of the row's tiles, complete once their last
  // line is in.
  void addLine(int row, Moments* tiles, std::int32_t* place) {
    if (row % tile_rows_ == 0) {
      planes_.clear();
      std::ranges::fill(scratch_.moments, 0.0);
    }
    const std::size_t begin = planes_.size() * stride_;
    float* used = scratch_.used.data() + begin;
    double *across = scratch_.across.data() + begin, *ahead = scratch_.ahead.data() + begin;
    choose(row, used);
    placeInLine(used, image_.data().range_m.data() + image_.index(row, 0), columns_, geometry_.range_offset_m,
                cosine_.data(), sine_.data(), across, ahead);
    const LinePlane& plane = planes_.emplace_back(geometry_, image_.lineTilt(row));
    if (tilts_) {
      addMovingLine(row, begin, tiles);
      return;
    }
    sumTiles(used, across, ahead, tiles_, tile_columns_, scratch_.sums.data());
    addLineSums(scratch_.sums.data(), tiles_, plane.moments(), has_arm_, scratch_.moments.data());
    if ((row + 1) % tile_rows_ == 0 || row + 1 == image_.rows()) {
      placeTiles(scratch_.moments.data(), tiles_, place);
      handOver(tiles);
    }
  }

  // Of the tiles whose lines came last. Into `samples` from `count` on, where there is room for all cells;
  // returns how many there are then.
  std::size_t sample(const Moments* tiles, double whole_below_m, CellSamples& samples, std::size_t count) {
    placeLines();
    const float *used = scratch_.used.data(), *x = scratch_.x.data(), *y = scratch_.y.data();
    const float* z = scratch_.z.data();
    float *to_x = samples.x.data(), *to_y = samples.y.data(), *to_z = samples.z.data();
    float* to_count = samples.count.data();
    for (std::size_t first = 0; first < stride_; first += tile_columns_, ++tiles) {
      if (!(tiles->n > 0.0)) continue;
      if (isOne(*tiles, whole_below_m)) {
        const Eigen::Vector3f mean = tiles->mean().cast<float>();
        to_x[count] = mean.x(), to_y[count] = mean.y(), to_z[count] = mean.z();
        to_count[count++] = static_cast<float>(tiles->n);
        continue;
      }
      for (std::size_t line = 0; line < planes_.size(); ++line)
        for (std::size_t k = line * stride_ + first; k < line * stride_ + first + tile_columns_; ++k) {
          to_x[count] = x[k], to_y[count] = y[k], to_z[count] = z[k], to_count[count] = 1.0F;
          count += used[k] > 0.0F ? 1 : 0;
        }
    }
    return count;
  }

 private:
  // The points of the lines of these tiles.
  void placeLines() {
    const std::size_t cells = planes_.size() * stride_;
    for (std::vector<float>* axis : {&scratch_.x, &scratch_.y, &scratch_.z}) axis->resize(cells);
    for (std::size_t line = 0; line < planes_.size(); ++line) {
      const std::size_t begin = line * stride_;
      if (!tilts_) {
        placeInSpace(scratch_.across.data() + begin, scratch_.ahead.data() + begin, stride_,
                     planes_[line].frame(), scratch_.x.data() + begin, scratch_.y.data() + begin,
                     scratch_.z.data() + begin);
        continue;
      }
      for (std::size_t k = begin; k < begin + columns_; ++k) {
        if (!(scratch_.used[k] > 0.0F)) continue;
        const Eigen::Vector3f p = points_[k].cast<float>();
        scratch_.x[k] = p.x(), scratch_.y[k] = p.y(), scratch_.z[k] = p.z();
      }
    }
  }

  void handOver(Moments* tiles) const {
    const double* m = scratch_.moments.data();
    const std::size_t n = tiles_;
    for (std::size_t t = 0; t < n; ++t, ++m)
      tiles[t] = {m[0], m[n], m[2 * n], m[3 * n], m[4 * n], m[5 * n], m[6 * n], m[7 * n], m[8 * n], m[9 * n]};
  }

  void addMovingLine(int row, std::size_t begin, Moments* tiles) {
    tilts_->setRow(row);
    points_.resize(scratch_.across.size());
    const Eigen::Vector3d across = geometry_.mounting * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d ahead = geometry_.mounting * Eigen::Vector3d::UnitY();
    for (std::size_t k = 0; k < columns_; ++k) {
      const std::size_t cell = begin + k;
      if (!(scratch_.used[cell] > 0.0F)) continue;
      const Eigen::Vector3d v =
          geometry_.lever_arm_m + scratch_.across[cell] * across + scratch_.ahead[cell] * ahead;
      const double c = tilts_->cosine(k), s = tilts_->sine(k);
      const Eigen::Vector3d p(v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z());
      points_[cell] = p;
      tiles[k / tile_columns_] += momentsOf(p);
    }
  }

  // 1 where a cell takes part, 0 where not.
  void choose(int row, float* used) const {
    const float* here = inverse_.row(row);
    if (!drop_edges_) {
      for (std::size_t k = 0; k < columns_; ++k) used[k] = here[k] > 0.0F ? 1.0F : 0.0F;
      return;
    }
    // Further out than one, the border's neighbours are cells of another row, or none.
    const auto border = static_cast<std::size_t>(rule_.apart - 1);
    if (2 * border >= columns_) {
      std::fill_n(used, columns_, 0.0F);
      return;
    }
    std::fill_n(used, border, 0.0F);
    std::fill_n(used + columns_ - border, border, 0.0F);
    const float *before = inverse_.row(row - 1), *after = inverse_.row(row + 1);
    chooseCells(before + border, here + border, after + border, columns_ - 2 * border, rule_, used + border);
  }

  Scratch& scratch_ = scratch;
  const RangeImage& image_;
  const ScannerGeometry& geometry_;
  int tile_rows_;
  std::size_t tile_columns_;
  bool drop_edges_;
  InverseRanges inverse_;
  std::size_t columns_, tiles_;
  std::size_t stride_;  // of a line's cells: whole tiles
  bool has_arm_;
  std::vector<double> cosine_, sine_;
  BendRule rule_;
  std::vector<LinePlane> planes_;        // of the lines since the tiles began
  std::optional<BeamTilts> tilts_;       // where the tilt moved on
  std::vector<Eigen::Vector3d> points_;  // then: of the lines since the tiles began
};

void tileRegular(const RangeImage& image, const ScannerGeometry& geometry, int tile_rows, int tile_columns,
                 bool drop_edges, CellSamples* samples, double whole_below_m, MomentGrid& grid) {
  RegularTiles lines(image, geometry, tile_rows, tile_columns, drop_edges);
  if (lines.placesTiles()) grid.place.resize(grid.tile.size());
  CellSamples& sampled = scratch.samples;
  std::size_t count = 0;
  // One more: what is not used is written too, and then written over.
  if (samples) sampled.resize(image.cells() + 1);
  for (int row = 0; row < image.rows(); ++row) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row / tile_rows) * grid.columns;
    Moments* tiles = grid.tile.data() + first;
    lines.addLine(row, tiles, grid.place.data() + (grid.place.empty() ? 0 : first));
    if (samples && ((row + 1) % tile_rows == 0 || row + 1 == image.rows()))
      count = lines.sample(tiles, whole_below_m, sampled, count);
  }
  if (samples) samples->append(sampled, count);
}

}  // namespace

Eigen::Matrix3d Moments::covariance() const {
  const double share = 1.0 / n;
  const double mx = share * x, my = share * y, mz = share * z;
  Eigen::Matrix3d c;
  c(0, 0) = share * xx - mx * mx;
  c(1, 0) = c(0, 1) = share * xy - mx * my;
  c(2, 0) = c(0, 2) = share * xz - mx * mz;
  c(1, 1) = share * yy - my * my;
  c(2, 1) = c(1, 2) = share * yz - my * mz;
  c(2, 2) = share * zz - mz * mz;
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
  const int rows = (image.rows() + tile_rows - 1) / tile_rows;
  const int columns = (image.columns() + tile_columns - 1) / tile_columns;
  if (image.isRegular() && !tiltMoved(image))
    setSize(grid, rows, columns);  // every tile is written
  else
    clear(grid, rows, columns);
  if (image.isRegular())
    return tileRegular(image, geometry, tile_rows, tile_columns, drop_edges, samples, whole_below_m, grid);
  const auto tileOf = [&](int row, int column) -> Moments& {
    return grid.tile[static_cast<std::size_t>(row / tile_rows * grid.columns + column / tile_columns)];
  };
  for (int row = 0; row < image.rows(); ++row)
    for (int column = 0; column < image.columns(); ++column) {
      if (!image.hasPoint(row, column)) continue;
      const Eigen::Vector3d p = cellPoint(image, geometry, row, column);
      tileOf(row, column) += momentsOf(p);
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
  setSize(coarse, (fine.rows + 1) / 2, (fine.columns + 1) / 2);
  for (int row = 0; row < coarse.rows; ++row) {
    Moments* out = coarse.tile.data() + static_cast<std::ptrdiff_t>(row) * coarse.columns;
    for (int column = 0; column < coarse.columns; ++column, ++out) {
      *out = fine.at(2 * row, 2 * column);
      const bool right = 2 * column + 1 < fine.columns, below = 2 * row + 1 < fine.rows;
      if (right) *out += fine.at(2 * row, 2 * column + 1);
      if (below) *out += fine.at(2 * row + 1, 2 * column);
      if (right && below) *out += fine.at(2 * row + 1, 2 * column + 1);
    }
  }
}

}  // namespace tiltmap
