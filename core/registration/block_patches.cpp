#include "core/registration/block_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/registration/grid_moments.h"
#include "core/registration/plane_patch.h"

namespace tiltmap {

namespace {

constexpr int kLargestLevel = 5;  // 32 x 32 tiles

class Pyramid {
 public:
  Pyramid(const RangeImage& image, const ScannerGeometry& geometry, const RegistrationSettings& settings,
          BlockPatches& out)
      : settings_(settings),
        spot_rad_(out.spot_rad),
        most_of_a_plane_(mostOfAPlane(settings.patch_noise_m, settings.patch_floor_m)),
        most_of_a_rough_plane_(mostOfAPlane(settings.patch_rough_noise_m, settings.patch_rough_floor_m)),
        out_(out) {
    tileMoments(image, geometry, settings.patch_rows, settings.patch_columns, settings.patch_drop_edges,
                settings.refine ? &out.cells : nullptr, settings.refine_whole_m, levels_.front());
    while (top_ < kLargestLevel && (level(top_).rows > 1 || level(top_).columns > 1)) {
      halve(level(top_), levels_[static_cast<std::size_t>(top_) + 1]);
      ++top_;
    }
  }

  void descend() {
    const MomentGrid& grid = level(top_);
    for (int row = 0; row < grid.rows; ++row)
      for (int column = 0; column < grid.columns; ++column) look(top_, row, column);
  }

 private:
  static const MomentGrid& level(int at) { return levels_[static_cast<std::size_t>(at)]; }

  void look(int level, int row, int column) {
    const Moments& m = this->level(level).at(row, column);
    if (m.n < settings_.patch_min_points) return;
    const Eigen::Matrix3d covariance = m.covariance();
    // The variance of a uniform line of length L is L^2 / 12.
    const double largest = settings_.patch_block_m * settings_.patch_block_m / 12.0;
    if (level > 0 && covariance.trace() > 2.0 * largest) return split(level, row, column);
    // Most of what is no plane is told without its axes.
    const double least = leastResidual(covariance);
    if (level > 0 && least > most_of_a_plane_) return split(level, row, column);
    if (level == 0 && least > std::max(most_of_a_plane_, most_of_a_rough_plane_)) return;
    const auto [values, axes] = planeAxes(covariance);
    if (level > 0 && values[2] > largest) return split(level, row, column);
    const Eigen::Vector3d mean = m.mean();
    const bool planar =
        fitsPlane(mean, values, axes.col(0), settings_.patch_noise_m, settings_.patch_floor_m);
    if (!planar && level > 0) return split(level, row, column);
    if (!planar &&
        !fitsPlane(mean, values, axes.col(0), settings_.patch_rough_noise_m, settings_.patch_rough_floor_m))
      return;
    const auto short_m = shortRange(mean, axes.col(0), spot_rad_);
    if (!short_m) return;
    const auto patch = static_cast<std::uint32_t>(out_.elements.size());
    const Eigen::Vector3d place = mean + *short_m * mean.normalized();
    const ResidualPrior prior{settings_.patch_noise_m, settings_.patch_prior};
    if (!appendPatch(place, values, axes, m.n, out_.elements, prior)) return;
    paint(level, row, column, patch);
  }

  // Onto the directions of the block's tiles.
  void paint(int level, int row, int column, std::uint32_t patch) {
    const MomentGrid& tiles = levels_.front();
    const int last_row = std::min(tiles.rows, (row + 1) << level);
    const int first_column = column << level, last_column = std::min(tiles.columns, (column + 1) << level);
    for (int r = row << level; r < last_row; ++r)
      for (int c = first_column; c < last_column; ++c) {
        const Moments& tile = tiles.at(r, c);
        if (!(tile.n > 0.0)) continue;
        if (tiles.place.empty())
          out_.raster.paint({tile.x, tile.y, tile.z}, patch);
        else
          out_.raster.paintAt(tiles.place[static_cast<std::size_t>(r * tiles.columns + c)], patch);
      }
  }

  // What fitsPlane allows at most, whichever way the plane is seen.
  static double mostOfAPlane(double noise_m, double floor_m) {
    return 2.0 * (noise_m * noise_m + floor_m * floor_m);
  }

  void split(int level, int row, int column) {
    const MomentGrid& grid = this->level(level - 1);
    for (const int r : {2 * row, 2 * row + 1})
      for (const int c : {2 * column, 2 * column + 1})
        if (r < grid.rows && c < grid.columns) look(level - 1, r, c);
  }

  const RegistrationSettings& settings_;
  double spot_rad_, most_of_a_plane_, most_of_a_rough_plane_;
  BlockPatches& out_;
  int top_ = 0;
  // Fresh memory costs more than what is added up there.
  static thread_local std::array<MomentGrid, kLargestLevel + 1> levels_;
};

thread_local std::array<MomentGrid, kLargestLevel + 1> Pyramid::levels_;

}  // namespace

BlockPatches blockPatches(const RangeImage& image, const ScannerGeometry& geometry,
                          const RegistrationSettings& settings) {
  BlockPatches out;
  out.spot_rad = image.isRegular() ? settings.patch_spot_rad : 0.0;
  Pyramid pyramid(image, geometry, settings, out);
  pyramid.descend();
  out.raster.closeGaps();
  return out;
}

}  // namespace tiltmap
