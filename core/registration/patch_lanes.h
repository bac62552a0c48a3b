// Groups of points judged as planes, many side by side: the same arithmetic as plane_patch.h.
#pragma once

#include <array>
#include <cstddef>

namespace tiltmap {

// Groups of points by their moments, scan frame, m and m^2.
struct GroupLanes {
  static constexpr std::size_t kMost = 64;
  using Lane = std::array<double, kMost>;

  Lane n, x, y, z;              // the sums of Moments; then the mean
  Lane xx, xy, xz, yy, yz, zz;  // likewise; then the covariance about the mean, divided by n
  Lane trace, least;            // of the covariance; a bound from below on its least eigenvalue
};

// Turns sums into means and covariances.
void spreadGroups(std::size_t count, GroupLanes& groups);

struct PlaneRule {
  // A group is planar while its residual's square is below 2 ((noise cos incidence)^2 + floor^2); likewise
  // rough. Squares, m^2.
  double noise_square = 0.0, floor_square = 0.0;
  double rough_noise_square = 0.0, rough_floor_square = 0.0;
  double largest_square = 0.0;                          // of a group's deviation along its longest axis
  double spot_rad = 0.0;                                // see shortRange
  double prior_noise_square = 0.0, prior_points = 0.0;  // see ResidualPrior
  bool can_split = false;                               // the groups have parts
};

enum class GroupFate { Dropped, Kept, Split };

// What becomes of each group, and the patches of those that are kept (PatchShape).
struct PlaneLanes {
  using Lane = GroupLanes::Lane;
  Lane fate;                                // a GroupFate
  Lane x, y, z;                             // set back by what slanted ranges fall short
  Lane nx, ny, nz, ux, uy, uz, vx, vy, vz;  // towards the scanner; along the longer axis; the shorter one
  Lane offset_variance, tilt_u, tilt_v, extent_u, extent_v, residual;
};

// The first `count` groups, spread, of at least four points.
void judgePlanes(std::size_t count, const GroupLanes& groups, const PlaneRule& rule, PlaneLanes& planes);

}  // namespace tiltmap
