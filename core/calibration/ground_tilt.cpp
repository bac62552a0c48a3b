#include "core/calibration/ground_tilt.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/base/parallel.h"
#include "core/base/ranks.h"
#include "core/registration/metric.h"

namespace tiltmap {

namespace {

constexpr double kLowest_m = -3.0, kHighest_m = -0.15;  // the ground lies below the mirror
constexpr double kNoise_m = 0.012, kFloor_m = 0.005;    // of a range, and of the ground itself
constexpr double kGrazing = 0.05;                       // cosine; flatter beams tell nothing
constexpr double kBend = 0.03;                          // curvature to be expected, 1/m
constexpr double kLoss_m = 0.02;
constexpr int kRounds = 6;
constexpr std::size_t kFewest = 30;
constexpr double kWellSeen_rad = 0.4 * kDegree;

struct GroundPoint {
  double x, y, z, variance;
};

// Cells of one scan about the foot of another, in the other's frame.
void collect(const PreparedScan& from, const Pose& foot_from_scan, double radius_m,
             std::vector<GroundPoint>& out) {
  const Eigen::Matrix3d rotation = foot_from_scan.rotation();
  const Eigen::Vector3d origin = foot_from_scan.translation();
  const double spot = from.spot_rad;
  for (std::size_t i = 0; i < from.cells.size(); ++i) {
    const Eigen::Vector3d ray =
        rotation * Eigen::Vector3d(static_cast<double>(from.cells.x[i]), static_cast<double>(from.cells.y[i]),
                                   static_cast<double>(from.cells.z[i]));
    Eigen::Vector3d p = origin + ray;
    if (p.z() < kLowest_m || p.z() > kHighest_m || p.head<2>().squaredNorm() > radius_m * radius_m) continue;
    const double cosine = -ray.z() / ray.norm();
    if (cosine < kGrazing) continue;
    // The spot's near side returns more (see shortRange).
    p += spot * spot * (1.0 - cosine * cosine) / (cosine * cosine) * ray;
    const double noise = kNoise_m * cosine;
    const double count = static_cast<double>(from.cells.count[i]);
    out.push_back({p.x(), p.y(), p.z(), noise * noise / count + kFloor_m * kFloor_m});
  }
}

// z = a + b x + c y + bends, by iterated least squares. False where the points do not tell the slope.
bool fitGround(const std::vector<GroundPoint>& points, GroundUnderStop& out) {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  if (points.size() < kFewest) return false;
  std::vector<double> heights;
  for (const GroundPoint& p : points) heights.push_back(p.z);
  Vector6 fit = Vector6::Zero();
  fit[0] = medianOf(std::move(heights));
  Matrix6d h;
  double loss = 5.0 * kLoss_m;
  for (int round = 0; round < kRounds; ++round) {
    h.setZero();
    Vector6 b = Vector6::Zero();
    for (const GroundPoint& p : points) {
      Vector6 j;
      j << 1.0, p.x, p.y, 0.5 * p.x * p.x, p.x * p.y, 0.5 * p.y * p.y;
      const double r = p.z - j.dot(fit);
      const double w = gemanMcClureWeight(r * r, loss * loss) / p.variance;
      h += w * j * j.transpose();
      b += w * p.z * j;
    }
    h.diagonal().tail<3>().array() += 1.0 / (kBend * kBend);
    fit = h.ldlt().solve(b);
    loss = std::max(kLoss_m, 0.5 * loss);
  }
  const Matrix6d covariance = h.ldlt().solve(Matrix6d::Identity());
  if (!fit.allFinite() || !covariance.allFinite() || !(covariance(2, 2) > 0.0)) return false;
  out.points = points.size();
  out.roll_rad = std::atan(fit[1]);
  out.pitch_rad = -std::atan(fit[2]);
  out.deviation_rad = std::sqrt(covariance(2, 2));
  return out.deviation_rad < kWellSeen_rad;
}

}  // namespace

GroundTilt groundTilt(std::span<const PreparedScanPtr> scans, std::span<const Pose> world_from_scan,
                      double radius_m, int threads) {
  std::vector<GroundUnderStop> slots(scans.size());
  std::vector<char> seen(scans.size(), 0);
  parallelFor(scans.size(), threads, [&](std::size_t i) {
    std::vector<GroundPoint> points;
    for (std::size_t k = 0; k < scans.size(); ++k)
      collect(*scans[k], world_from_scan[i].inverse() * world_from_scan[k], radius_m, points);
    slots[i].scan = static_cast<int>(i);
    seen[i] = fitGround(points, slots[i]) ? 1 : 0;
  });
  GroundTilt tilt;
  for (std::size_t i = 0; i < scans.size(); ++i)
    if (seen[i]) tilt.stops.push_back(slots[i]);
  if (tilt.stops.empty()) return tilt;
  const auto count = static_cast<double>(tilt.stops.size());
  // The stops differ by what ground and springs do, not by what is measured of each: they count alike, less
  // where they stand out.
  std::vector<double> pitches, off;
  for (const GroundUnderStop& stop : tilt.stops) pitches.push_back(stop.pitch_rad);
  double mean = medianOf(pitches);
  for (const double pitch : pitches) off.push_back(std::abs(pitch - mean));
  const double scale = 3.0 * 1.4826 * medianOf(off) + 0.02 * kDegree;
  double weights = 0.0, squares = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0.0;
    weights = squares = 0.0;
    for (const double pitch : pitches) {
      const double w = gemanMcClureWeight((pitch - mean) * (pitch - mean), scale * scale);
      weights += w, sum += w * pitch, squares += w * (pitch - mean) * (pitch - mean);
    }
    mean = sum / weights;
  }
  tilt.change_rad = mean;
  // Of a mean of few the deviation itself is known badly: that of Student's distribution.
  const double freedom = std::max(weights - 1.0, 0.5);
  const double few = freedom > 2.5 ? freedom / (freedom - 2.0) : 5.0;
  tilt.deviation_rad = std::sqrt(squares / freedom / weights * few);
  for (const GroundUnderStop& stop : tilt.stops) tilt.roll_rad += stop.roll_rad / count;
  return tilt;
}

}  // namespace tiltmap
