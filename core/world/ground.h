// The ground of a simulated site: a smooth height field over the site's x and y, metres.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/world/shapes.h"

namespace tiltmap {

using Terrain = std::function<double(double x_m, double y_m)>;  // control heights of the spline

// A quadratic B-spline (once continuously differentiable) over a lattice of control heights taken from a
// terrain function. The lattice lies on whole multiples of the spacing, so that two grounds over the same
// terrain agree wherever both reach.
class Ground {
 public:
  static constexpr double kSpacingM = 1.25;

  // Covers the rectangle low to high; beyond it the height stays that of the border.
  Ground(const Terrain& terrain, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

  double height(double x_m, double y_m) const;
  Eigen::Vector2d gradient(double x_m, double y_m) const;
  // Upward unit normal.
  Eigen::Vector3d normal(double x_m, double y_m) const;
  // Distance along the ray to where it goes below the ground.
  std::optional<double> hit(const Ray& ray, double max_distance_m) const;

  // The spline's value at one place without building a lattice: equal to height() of any ground that covers
  // it.
  static double heightOf(const Terrain& terrain, double x_m, double y_m);

 private:
  struct Place;
  Place placeOf(double x_m, double y_m) const;

  int first_x_ = 0, first_y_ = 0;  // lattice index of the first control height
  int count_x_ = 0, count_y_ = 0;
  std::vector<double> control_;  // row-major, y rows
  double lowest_ = 0.0, highest_ = 0.0, steepest_ = 0.0;
};

}  // namespace tiltmap
