#include "core/world/ground.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tiltmap {

namespace {

// Weights of the three control heights around a place; u in [-0.5, 0.5] from the middle one.
std::array<double, 3> weights(double u) {
  return {0.5 * (0.5 - u) * (0.5 - u), 0.75 - u * u, 0.5 * (0.5 + u) * (0.5 + u)};
}
std::array<double, 3> slopes(double u) {
  return {u - 0.5, -2.0 * u, u + 0.5};
}

}  // namespace

struct Ground::Place {
  const double* corner;  // the first of the 3 x 3 control heights
  double u, v;
};

Ground::Ground(const Terrain& terrain, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  first_x_ = static_cast<int>(std::floor(low.x() / kSpacingM)) - 1;
  first_y_ = static_cast<int>(std::floor(low.y() / kSpacingM)) - 1;
  count_x_ = static_cast<int>(std::ceil(high.x() / kSpacingM)) + 2 - first_x_;
  count_y_ = static_cast<int>(std::ceil(high.y() / kSpacingM)) + 2 - first_y_;
  control_.reserve(static_cast<std::size_t>(count_x_) * static_cast<std::size_t>(count_y_));
  for (int j = 0; j < count_y_; ++j)
    for (int i = 0; i < count_x_; ++i)
      control_.push_back(terrain((first_x_ + i) * kSpacingM, (first_y_ + j) * kSpacingM));
  // A B-spline lies between its control heights, and its slope between their differences.
  const auto [least, most] = std::minmax_element(control_.begin(), control_.end());
  lowest_ = *least;
  highest_ = *most;
  double across = 0.0, along = 0.0;
  for (int j = 0; j < count_y_; ++j)
    for (int i = 0; i < count_x_; ++i) {
      const std::size_t k =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(count_x_) + static_cast<std::size_t>(i);
      if (i + 1 < count_x_) across = std::max(across, std::abs(control_[k + 1] - control_[k]));
      if (j + 1 < count_y_)
        along = std::max(along, std::abs(control_[k + static_cast<std::size_t>(count_x_)] - control_[k]));
    }
  steepest_ = std::hypot(across, along) / kSpacingM;
}

Ground::Place Ground::placeOf(double x_m, double y_m) const {
  const double x = std::clamp(x_m / kSpacingM - first_x_, 0.5, count_x_ - 1.5);
  const double y = std::clamp(y_m / kSpacingM - first_y_, 0.5, count_y_ - 1.5);
  const int i = std::clamp(static_cast<int>(x + 0.5), 1, count_x_ - 2),
            j = std::clamp(static_cast<int>(y + 0.5), 1, count_y_ - 2);
  return {&control_[static_cast<std::size_t>(j - 1) * static_cast<std::size_t>(count_x_) +
                    static_cast<std::size_t>(i - 1)],
          x - i, y - j};
}

double Ground::height(double x_m, double y_m) const {
  const Place p = placeOf(x_m, y_m);
  const auto a = weights(p.u), b = weights(p.v);
  double sum = 0.0;
  for (int j = 0; j < 3; ++j) {
    const double* row = p.corner + j * count_x_;
    sum += b[static_cast<std::size_t>(j)] * (a[0] * row[0] + a[1] * row[1] + a[2] * row[2]);
  }
  return sum;
}

Eigen::Vector2d Ground::gradient(double x_m, double y_m) const {
  const Place p = placeOf(x_m, y_m);
  const auto a = weights(p.u), b = weights(p.v), da = slopes(p.u), db = slopes(p.v);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int j = 0; j < 3; ++j) {
    const double* row = p.corner + j * count_x_;
    sum.x() += b[static_cast<std::size_t>(j)] * (da[0] * row[0] + da[1] * row[1] + da[2] * row[2]);
    sum.y() += db[static_cast<std::size_t>(j)] * (a[0] * row[0] + a[1] * row[1] + a[2] * row[2]);
  }
  return sum / kSpacingM;
}

Eigen::Vector3d Ground::normal(double x_m, double y_m) const {
  const Eigen::Vector2d g = gradient(x_m, y_m);
  return Eigen::Vector3d(-g.x(), -g.y(), 1.0).normalized();
}

std::optional<double> Ground::hit(const Ray& ray, double max_distance_m) const {
  const double rise = ray.direction.z();
  const double run = ray.direction.head<2>().norm();
  const double closing = steepest_ * run - rise;  // the fastest the gap to the ground can shrink
  if (closing <= 0.0) return std::nullopt;
  const auto gap = [&](double t) {
    return ray.origin.z() + t * rise -
           height(ray.origin.x() + t * ray.direction.x(), ray.origin.y() + t * ray.direction.y());
  };
  double before = rise < 0.0 ? std::max(0.0, (highest_ - ray.origin.z()) / rise) : 0.0;
  double gap_before = gap(before);
  if (gap_before < 0.0) return std::nullopt;  // starts below the ground
  while (before < max_distance_m) {
    if (rise >= 0.0 && ray.origin.z() + before * rise > highest_) return std::nullopt;
    // Never less than a quarter of a metre: the ground has no shorter waves that a beam could step over.
    const double after = before + std::max(gap_before / closing, 0.25);
    const double gap_after = gap(after);
    if (gap_after <= 0.0) {
      // Regula falsi with bisection as the guard, to a hundredth of a millimetre.
      double low = before, high = after, f_low = gap_before, f_high = gap_after;
      for (int step = 0; step < 40 && high - low > 1e-5; ++step) {
        double t = step % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * f_low / (f_low - f_high);
        t = std::clamp(t, low, high);
        const double f = gap(t);
        if (std::abs(f) < 1e-7) {
          low = high = t;
        } else if (f > 0.0) {
          low = t;
          f_low = f;
        } else {
          high = t;
          f_high = f;
        }
      }
      const double t = 0.5 * (low + high);
      if (t > max_distance_m) return std::nullopt;
      return t;
    }
    before = after;
    gap_before = gap_after;
  }
  return std::nullopt;
}

double Ground::heightOf(const Terrain& terrain, double x_m, double y_m) {
  const Eigen::Vector2d here(x_m, y_m);
  return Ground(terrain, here, here).height(x_m, y_m);
}

}  // namespace tiltmap
