#include "core/registration/plane_patch.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tiltmap {

namespace {

constexpr int kNewtonSteps = 20;
constexpr double kEnough = 1e-5;  // of the root: a step so short has left a square of it, 1e-10

// x^3 - trace x^2 + minors x - determinant is zero at the eigenvalues.
struct Characteristic {
  double trace, minors, determinant;

  explicit Characteristic(const Eigen::Matrix3d& c) : trace(c(0, 0) + c(1, 1) + c(2, 2)) {
    const double xx = c(1, 1) * c(2, 2) - c(1, 2) * c(1, 2), yy = c(0, 0) * c(2, 2) - c(0, 2) * c(0, 2),
                 zz = c(0, 0) * c(1, 1) - c(0, 1) * c(0, 1);
    minors = xx + yy + zz;
    determinant = c(0, 0) * xx - c(0, 1) * (c(0, 1) * c(2, 2) - c(1, 2) * c(0, 2)) +
                  c(0, 2) * (c(0, 1) * c(1, 2) - c(1, 1) * c(0, 2));
  }
  // The sum of the inverse eigenvalues is minors / determinant.
  double leastAtLeast() const { return minors > 0.0 ? std::max(determinant / minors, 0.0) : 0.0; }
  // Convex and falling left of the least root, so that no step goes beyond it.
  double least() const {
    double x = leastAtLeast();
    for (int step = 0; step < kNewtonSteps; ++step) {
      const double slope = minors - x * (2.0 * trace - 3.0 * x);
      if (!(slope > 0.0)) break;
      const double on = (determinant - x * (minors - x * (trace - x))) / slope;
      x += std::max(on, 0.0);
      if (!(on > kEnough * x)) break;
    }
    return x;
  }
};

// At right angles to all rows of a matrix of rank two; to the longest where it has less, anything for zero.
Eigen::Vector3d freeDirection(const Eigen::Matrix3d& m) {
  const Eigen::Vector3d x = m.col(0), y = m.col(1), z = m.col(2);
  const Eigen::Vector3d xy = x.cross(y), yz = y.cross(z), zx = z.cross(x);
  const double a = xy.squaredNorm(), b = yz.squaredNorm(), c = zx.squaredNorm();
  const Eigen::Vector3d& longest = a > b ? (a > c ? xy : zx) : (b > c ? yz : zx);
  const double square = std::max({a, b, c});
  const double scale = m.squaredNorm();
  if (square > 1e-24 * scale * scale) return longest / std::sqrt(square);
  const double xx = x.squaredNorm(), yy = y.squaredNorm(), zz = z.squaredNorm();
  const Eigen::Vector3d& row = xx > yy ? (xx > zz ? x : z) : (yy > zz ? y : z);
  return scale > 0.0 ? row.unitOrthogonal() : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

// At right angles to a unit vector, at least 0.8 long.
Eigen::Vector3d acrossOf(const Eigen::Vector3d& n) {
  const double x = std::abs(n.x()), y = std::abs(n.y()), z = std::abs(n.z());
  if (x <= y && x <= z) return {0.0, n.z(), -n.y()};
  if (y <= z) return {-n.z(), 0.0, n.x()};
  return {n.y(), -n.x(), 0.0};
}

double cosIncidence(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal) {
  const double range = mean.norm();
  return range > 0.0 ? std::min(std::abs(normal.dot(mean)) / range, 1.0) : 1.0;
}

}  // namespace

double leastResidual(const Eigen::Matrix3d& covariance) {
  return Characteristic(covariance).leastAtLeast();
}

PlaneAxes planeAxes(const Eigen::Matrix3d& covariance) {
  PlaneAxes result;
  const double least = Characteristic(covariance).least();
  Eigen::Matrix3d off = covariance;
  off.diagonal().array() -= least;
  const Eigen::Vector3d normal = freeDirection(off);
  // Within the plane: (a b; b c), along two axes at right angles of the same length.
  const Eigen::Vector3d first = acrossOf(normal), second = normal.cross(first);
  const double square = first.squaredNorm(), share = 1.0 / square;
  const Eigen::Vector3d along = covariance * first;
  const double a = share * first.dot(along), b = share * second.dot(along);
  const double c = share * second.dot(covariance * second);
  const double half = 0.5 * (a - c), mean = 0.5 * (a + c);
  const double spread = std::sqrt(half * half + b * b);
  result.values = {least, std::max(mean - spread, least), std::max(mean + spread, least)};
  double p = 1.0, q = 0.0;
  if (spread > 0.0) p = half > 0.0 ? half + spread : b, q = half > 0.0 ? b : spread - half;
  const double length = 1.0 / std::sqrt((p * p + q * q) * square);
  result.axes.col(0) = normal;
  result.axes.col(2) = (length * p) * first + (length * q) * second;
  result.axes.col(1) = result.axes.col(2).cross(normal);
  return result;
}

bool fitsPlane(const Eigen::Vector3d& mean, const Eigen::Vector3d& values, const Eigen::Vector3d& normal,
               double noise_m, double floor_m) {
  const double noise = noise_m * cosIncidence(mean, normal);
  return values[0] < 2.0 * (noise * noise + floor_m * floor_m);
}

// Across a spot of deviation s the range varies as r (1 +- s tan incidence), and the light that returns by
// its inverse square, so the mean falls short by r (s tan incidence)^2.
std::optional<double> shortRange(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal,
                                 double spot_rad) {
  const double range = mean.norm();
  if (spot_rad <= 0.0 || range <= 0.0) return 0.0;
  const double cos_incidence = cosIncidence(mean, normal);
  const double spread =
      spot_rad * std::sqrt(1.0 - cos_incidence * cos_incidence) / std::max(cos_incidence, 1e-6);
  if (4.0 * spread * range > kLongestSpot_m) return std::nullopt;
  return range * spread * spread;
}

bool appendPatch(const Eigen::Vector3d& mean, const Eigen::Vector3d& values, const Eigen::Matrix3d& axes,
                 double count, SurfaceElements& out, const ResidualPrior& prior) {
  // The second extent must stand out of the residual.
  if (values[1] < 9.0 * values[0] || !(values[1] > 0.0)) return false;
  Eigen::Vector3d normal = axes.col(0);
  if (normal.dot(mean) > 0.0) normal = -normal;
  const double expected = prior.noise_m * cosIncidence(mean, normal);
  const double freedom = std::max(count - kPlaneFreedom, 1.0);
  const double residual =
      (std::max(values[0], 0.0) * count + prior.points * expected * expected) / (freedom + prior.points) +
      kResidualFloor_m * kResidualFloor_m;
  PatchShape shape;
  shape.u = axes.col(2);
  shape.v = axes.col(1);
  shape.offset_variance_m2 = residual / count + kOffsetFloor_m * kOffsetFloor_m;
  shape.tilt_variance_u = residual / (count * values[2]);
  shape.tilt_variance_v = residual / (count * values[1]);
  shape.extent_u_m = std::sqrt(values[2]);
  shape.extent_v_m = std::sqrt(values[1]);
  shape.residual_m = std::sqrt(std::max(values[0], 0.0));
  shape.count = static_cast<std::uint32_t>(count);
  out.position.push_back(mean);
  out.normal.push_back(normal);
  out.shape.push_back(shape);
  return true;
}

}  // namespace tiltmap
