// Where the simulated sites' streets, parking bays and blocks lie: an endless grid, every block a function of
// the seed and its place, so that any part of it can be built alone.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/world/site.h"

namespace tiltmap {

// Main streets run along v with parking bays on both sides; cross streets run along u. Lane centres lie at
// u = k * kPitchU and v = l * kPitchV; block (k, l) is the rectangle from crossing (k, l) to (k+1, l+1).
struct StreetGrid {
  static constexpr double kPitchU = 54.0;
  static constexpr double kPitchV = 66.0;
  static constexpr double kHalfLane = 3.4;  // from the lane's centre to the bays or the kerb
  static constexpr double kBayDepth = 5.0;
  static constexpr double kBayWidth = 2.5;

  std::uint64_t seed = 1;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  // crossing (0, 0) in the site frame
  double angle_rad = 0.0;                              // of the main streets against +y, left positive

  Eigen::Vector2d site(double u_m, double v_m) const;
  Eigen::Vector2d grid(const Eigen::Vector2d& site_m) const;  // (u, v)
  // Asphalt, paint between the bays, pavement, grass.
  double groundReflectivity(double x_m, double y_m) const;
};

// All shapes of the blocks that reach within radius_m of the centre (site frame) and lie within it
// themselves.
std::vector<Shape> shapesAround(const StreetGrid& grid, const Ground& ground, const Eigen::Vector2d& centre_m,
                                double radius_m);

}  // namespace tiltmap
