#include "tests/benchmarks/noise_floor.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/base/parallel.h"

namespace tiltmap::benchmarks {

namespace {

constexpr double kSmoothest_m = 0.001;
constexpr double kFlat_m = 0.05;     // the neighbours' strikes lie this near the plane of a cell's own
constexpr double kMeasured_m = 0.1;  // so near its true range a range was measured on that surface
constexpr double kSameCosine = 0.9;
constexpr double kCast_m = 100.0;

// Where the beams' axes of one stop strike, site frame.
struct Strikes {
  ScannerGeometry geometry;
  Pose site_from_scan;
  std::vector<Eigen::Vector3d> place, normal;  // a cell each; normal zero where it does not count

  const Eigen::Vector3d& origin() const { return site_from_scan.translation(); }
  std::size_t cell(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(geometry.columns) +
           static_cast<std::size_t>(column);
  }
};

Strikes strikesOf(const Experiment& experiment, int stop, const Scan& scan) {
  const std::shared_ptr<const Site> site = experiment.siteAt(stop);
  const RangeImage& image = *scan.image;
  Strikes strikes{scan.geometry, experiment.siteFromScan(stop), {}, {}};
  strikes.place.assign(image.cells(), Eigen::Vector3d::Zero());
  strikes.normal.assign(image.cells(), Eigen::Vector3d::Zero());
  for (int row = 0; row < image.rows(); ++row)
    for (int column = 0; column < image.columns(); ++column) {
      const std::size_t cell = image.index(row, column);
      if (!image.hasPoint(cell)) continue;
      const Eigen::Vector3d direction =
          strikes.site_from_scan.rotation() *
          scan.geometry.direction(image.lineTilt(row), scan.geometry.azimuthOfColumn(column));
      const auto hit = site->cast({strikes.origin(), direction}, kCast_m);
      if (!hit || std::abs(hit->distance_m - static_cast<double>(image.range(cell))) > kMeasured_m) continue;
      strikes.place[cell] = strikes.origin() + hit->distance_m * direction;
      strikes.normal[cell] = hit->normal;
    }
  std::vector<Eigen::Vector3d> flat(image.cells(), Eigen::Vector3d::Zero());
  for (int row = 1; row + 1 < image.rows(); ++row)
    for (int column = 1; column + 1 < image.columns(); ++column) {
      const std::size_t cell = image.index(row, column);
      const Eigen::Vector3d& normal = strikes.normal[cell];
      bool is_flat = !normal.isZero();
      for (const std::size_t near : {image.index(row - 1, column), image.index(row + 1, column),
                                     image.index(row, column - 1), image.index(row, column + 1)})
        is_flat = is_flat && !strikes.normal[near].isZero() &&
                  std::abs(normal.dot(strikes.place[near] - strikes.place[cell])) < kFlat_m;
      if (is_flat) flat[cell] = normal;
    }
  strikes.normal = std::move(flat);
  return strikes;
}

// Whether `by` has a cell on the surface at `place`.
bool isSeen(const Strikes& by, const Eigen::Vector3d& place, const Eigen::Vector3d& normal) {
  const auto at = by.geometry.place(by.site_from_scan.inverse() * place);
  if (!at) return false;
  const int row = static_cast<int>(std::lround(at->row)), column = static_cast<int>(std::lround(at->column));
  if (row < 0 || row >= by.geometry.rows || column < 0 || column >= by.geometry.columns) return false;
  const std::size_t cell = by.cell(row, column);
  return by.normal[cell].dot(normal) > kSameCosine && std::abs(normal.dot(by.place[cell] - place)) < kFlat_m;
}

// What the cells of `of` on surfaces that one of `others` sees tell about its pose: a turn about `centre` and
// a shift, site frame.
Matrix6d information(const Strikes& of, const std::vector<const Strikes*>& others,
                     const Eigen::Vector3d& centre) {
  const LmsBeam beam;
  const double range_variance = beam.noise_m * beam.noise_m + beam.resolution_m * beam.resolution_m / 12.0;
  Matrix6d sum = Matrix6d::Zero();
  for (std::size_t cell = 0; cell < of.place.size(); ++cell) {
    const Eigen::Vector3d &p = of.place[cell], &n = of.normal[cell];
    if (n.isZero()) continue;
    bool seen = false;
    for (std::size_t k = 0; k < others.size() && !seen; ++k) seen = isSeen(*others[k], p, n);
    if (!seen) continue;
    const double cosine = n.dot((p - of.origin()).normalized());
    Vector6d j;
    j << (p - centre).cross(n), n;
    sum += j * j.transpose() / (range_variance * cosine * cosine + kSmoothest_m * kSmoothest_m);
  }
  return sum;
}

NoiseFloor floorOf(const Matrix6d& one, const Matrix6d& other) {
  const Eigen::FullPivLU<Matrix6d> first(one), second(other);
  if (!first.isInvertible() || !second.isInvertible())
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const Matrix6d covariance = first.inverse() + second.inverse();
  return {std::sqrt(covariance.bottomRightCorner<3, 3>().trace()),
          std::sqrt(covariance.topLeftCorner<3, 3>().trace())};
}

std::vector<Strikes> allStrikes(const Experiment& experiment, const std::vector<SimulatedStop>& stops) {
  std::vector<Strikes> all(stops.size());
  parallelFor(stops.size(), 0,
              [&](std::size_t i) { all[i] = strikesOf(experiment, static_cast<int>(i), stops[i].scan); });
  return all;
}

}  // namespace

std::vector<NoiseFloor> pairFloors(const Experiment& experiment, const std::vector<SimulatedStop>& stops) {
  const std::vector<Strikes> all = allStrikes(experiment, stops);
  std::vector<NoiseFloor> floors;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    const Eigen::Vector3d& centre = all[i + 1].origin();
    floors.push_back(
        floorOf(information(all[i], {&all[i + 1]}, centre), information(all[i + 1], {&all[i]}, centre)));
  }
  return floors;
}

std::vector<NoiseFloor> driveFloors(const Experiment& experiment, const std::vector<SimulatedStop>& stops) {
  const std::vector<Strikes> all = allStrikes(experiment, stops);
  const auto of = [&](std::size_t stop, const Eigen::Vector3d& centre) {
    std::vector<const Strikes*> others;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (k != stop) others.push_back(&all[k]);
    return information(all[stop], others, centre);
  };
  std::vector<NoiseFloor> floors(all.empty() ? 0 : all.size() - 1);
  parallelFor(floors.size(), 0, [&](std::size_t i) {
    const Eigen::Vector3d& centre = all[i + 1].origin();
    floors[i] = floorOf(of(0, centre), of(i + 1, centre));
  });
  return floors;
}

}  // namespace tiltmap::benchmarks
