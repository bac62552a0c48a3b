#include "core/registration/block_patches.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "core/registration/grid_moments.h"
#include "core/registration/patch_lanes.h"

namespace tiltmap {

namespace {

constexpr int kLargestLevel = 5;  // 32 x 32 tiles
constexpr std::size_t kUsualPatches = 1024;

class Pyramid {
 public:
  Pyramid(const RangeImage& image, const ScannerGeometry& geometry, const RegistrationSettings& settings,
          BlockPatches& out)
      : settings_(settings),
        most_of_a_plane_(mostOfAPlane(settings.patch_noise_m, settings.patch_floor_m)),
        most_of_a_rough_plane_(mostOfAPlane(settings.patch_rough_noise_m, settings.patch_rough_floor_m)),
        out_(out) {
    rule_.noise_square = rule_.prior_noise_square = settings.patch_noise_m * settings.patch_noise_m;
    rule_.floor_square = settings.patch_floor_m * settings.patch_floor_m;
    rule_.rough_noise_square = settings.patch_rough_noise_m * settings.patch_rough_noise_m;
    rule_.rough_floor_square = settings.patch_rough_floor_m * settings.patch_rough_floor_m;
    // The variance of a uniform line of length L is L^2 / 12.
    rule_.largest_square = settings.patch_block_m * settings.patch_block_m / 12.0;
    rule_.spot_rad = out.spot_rad;
    rule_.prior_points = settings.patch_prior;
    tileMoments(image, geometry, settings.patch_rows, settings.patch_columns, settings.patch_drop_edges,
                settings.refine ? &out.cells : nullptr, settings.refine_whole_m, levels_.front());
    while (top_ < kLargestLevel && (level(top_).rows > 1 || level(top_).columns > 1)) {
      halve(level(top_), levels_[static_cast<std::size_t>(top_) + 1]);
      ++top_;
    }
  }

  // From the largest blocks down, a level at a time: many blocks side by side.
  void descend() {
    const MomentGrid& grid = level(top_);
    open_.clear();
    for (int row = 0; row < grid.rows; ++row)
      for (int column = 0; column < grid.columns; ++column) open_.push_back({row, column});
    out_.elements.position.reserve(kUsualPatches);
    out_.elements.normal.reserve(kUsualPatches);
    out_.elements.shape.reserve(kUsualPatches);
    for (int at = top_; at >= 0; --at) {
      parts_.clear();
      rule_.can_split = at > 0;
      for (std::size_t first = 0; first < open_.size(); first += GroupLanes::kMost)
        spread(at, std::span(open_).subspan(first, std::min(GroupLanes::kMost, open_.size() - first)));
      judge(at);
      std::swap(open_, parts_);
    }
  }

 private:
  struct Block {
    int row = 0, column = 0;
  };

  static const MomentGrid& level(int at) { return levels_[static_cast<std::size_t>(at)]; }

  // Most of what is no plane is told without its axes.
  void spread(int at, std::span<const Block> blocks) {
    std::size_t count = 0;
    std::array<Block, GroupLanes::kMost> spread;
    for (const Block& block : blocks) {
      const Moments& m = level(at).at(block.row, block.column);
      if (m.n < settings_.patch_min_points) continue;
      GroupLanes& g = groups_;
      g.n[count] = m.n, g.x[count] = m.x, g.y[count] = m.y, g.z[count] = m.z;
      g.xx[count] = m.xx, g.xy[count] = m.xy, g.xz[count] = m.xz;
      g.yy[count] = m.yy, g.yz[count] = m.yz, g.zz[count] = m.zz;
      spread[count++] = block;
    }
    spreadGroups(count, groups_);
    for (std::size_t i = 0; i < count; ++i) {
      if (at > 0 && (groups_.trace[i] > 2.0 * rule_.largest_square || groups_.least[i] > most_of_a_plane_))
        split(at, spread[i]);
      else if (at > 0 || groups_.least[i] <= std::max(most_of_a_plane_, most_of_a_rough_plane_))
        addCandidate(at, spread[i], i);
    }
  }

  void addCandidate(int at, const Block& block, std::size_t i) {
    if (candidates_ == GroupLanes::kMost) judge(at);
    const GroupLanes& g = groups_;
    GroupLanes& to = planar_;
    const std::size_t k = candidates_++;
    candidate_[k] = block;
    to.n[k] = g.n[i], to.x[k] = g.x[i], to.y[k] = g.y[i], to.z[k] = g.z[i];
    to.xx[k] = g.xx[i], to.xy[k] = g.xy[i], to.xz[k] = g.xz[i];
    to.yy[k] = g.yy[i], to.yz[k] = g.yz[i], to.zz[k] = g.zz[i];
    to.trace[k] = g.trace[i], to.least[k] = g.least[i];
  }

  // Those that may be planes.
  void judge(int at) {
    judgePlanes(candidates_, planar_, rule_, planes_);
    for (std::size_t k = 0; k < candidates_; ++k) {
      if (planes_.fate[k] == static_cast<double>(GroupFate::Split))
        split(at, candidate_[k]);
      else if (planes_.fate[k] == static_cast<double>(GroupFate::Kept))
        keep(at, candidate_[k], k);
    }
    candidates_ = 0;
  }

  void keep(int at, const Block& block, std::size_t k) {
    const auto patch = static_cast<std::uint32_t>(out_.elements.size());
    const PlaneLanes& p = planes_;
    out_.elements.position.emplace_back(p.x[k], p.y[k], p.z[k]);
    out_.elements.normal.emplace_back(p.nx[k], p.ny[k], p.nz[k]);
    PatchShape& shape = out_.elements.shape.emplace_back();
    shape.u = {p.ux[k], p.uy[k], p.uz[k]};
    shape.v = {p.vx[k], p.vy[k], p.vz[k]};
    shape.offset_variance_m2 = p.offset_variance[k];
    shape.tilt_variance_u = p.tilt_u[k], shape.tilt_variance_v = p.tilt_v[k];
    shape.extent_u_m = p.extent_u[k], shape.extent_v_m = p.extent_v[k];
    shape.residual_m = p.residual[k];
    shape.count = static_cast<std::uint32_t>(planar_.n[k]);
    paint(at, block.row, block.column, patch);
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

  void split(int at, const Block& block) {
    const MomentGrid& grid = level(at - 1);
    for (const int r : {2 * block.row, 2 * block.row + 1})
      for (const int c : {2 * block.column, 2 * block.column + 1})
        if (r < grid.rows && c < grid.columns) parts_.push_back({r, c});
  }

  const RegistrationSettings& settings_;
  double most_of_a_plane_, most_of_a_rough_plane_;
  BlockPatches& out_;
  int top_ = 0;
  PlaneRule rule_;
  std::vector<Block> open_, parts_;  // of the level at work, and of the next
  GroupLanes groups_, planar_;
  PlaneLanes planes_;
  std::array<Block, GroupLanes::kMost> candidate_;
  std::size_t candidates_ = 0;
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
