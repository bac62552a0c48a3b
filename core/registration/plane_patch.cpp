#include "core/registration/plane_patch.h"

#include <algorithm>
#include <cmath>

namespace tiltmap {

namespace {

constexpr double kResidualFloor_m = 0.002;  // no surface measured by us is known better, ours
constexpr double kOffsetFloor_m = 0.0005;
constexpr double kPlaneFreedom = 3.0;
constexpr double kLongestSpot_m = 2.0;  // from 2 s to 2 s; an LMS' pulse is some 2.5 m long

double cosIncidence(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal) {
  const double range = mean.norm();
  return range > 0.0 ? std::min(std::abs(normal.dot(mean)) / range, 1.0) : 1.0;
}

}  // namespace

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
