#include "core/world/drive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/base/random.h"
#include "core/world/route.h"

namespace tiltmap {

namespace {

enum Purpose : std::uint64_t { kTerrain = 101, kPlacing, kRoll, kWander, kOdometry, kTurns };

// Long, middle and short waves: slopes of a few percent, bumps of a few centimetres.
Terrain waves(std::uint64_t seed) {
  struct Wave {
    Eigen::Vector2d k;  // rad/m
    double phase, height_m;
  };
  struct Band {
    double shortest_m, longest_m, height_m;
  };
  RandomStream random = RandomStream::keyed({seed, kTerrain});
  std::vector<Wave> sum;
  for (const Band& band : {Band{38.0, 85.0, 0.08}, Band{10.0, 18.0, 0.04}, Band{5.0, 7.5, 0.012}})
    for (int i = 0; i < 3; ++i) {
      const double length = random.uniform(band.shortest_m, band.longest_m);
      const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
      sum.push_back({2.0 * std::numbers::pi / length * Eigen::Vector2d(std::cos(way), std::sin(way)),
                     random.uniform(0.0, 2.0 * std::numbers::pi), band.height_m * random.uniform(0.6, 1.2)});
    }
  return [sum](double x, double y) {
    double z = 0.0;
    for (const Wave& wave : sum) z += wave.height_m * std::sin(wave.k.x() * x + wave.k.y() * y + wave.phase);
    return z;
  };
}

// How strongly two places' heights go together: the lie of the land, and the bumps on it.
double kinship(double squared_distance) {
  return 0.6 * 0.6 * std::exp(-squared_distance / (2.0 * 30.0 * 30.0)) +
         0.1 * 0.1 * std::exp(-squared_distance / (2.0 * 2.2 * 2.2));
}

// The terrain bent towards the given heights: kriging with a tolerance of a few centimetres.
Terrain bent(const Terrain& terrain, const std::vector<Eigen::Vector3d>& through) {
  constexpr double kTolerance = 0.03;
  const auto n = static_cast<Eigen::Index>(through.size());
  Eigen::MatrixXd kin(n, n);
  Eigen::VectorXd missing(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d& p = through[static_cast<std::size_t>(i)];
    missing[i] = p.z() - terrain(p.x(), p.y());
    for (Eigen::Index j = 0; j < n; ++j)
      kin(i, j) = kinship((p - through[static_cast<std::size_t>(j)]).head<2>().squaredNorm());
  }
  kin.diagonal().array() += kTolerance * kTolerance;
  const Eigen::VectorXd pull = kin.ldlt().solve(missing);
  return [terrain, through, pull](double x, double y) {
    double z = terrain(x, y);
    for (std::size_t i = 0; i < through.size(); ++i)
      z += pull[static_cast<Eigen::Index>(i)] *
           kinship((x - through[i].x()) * (x - through[i].x()) + (y - through[i].y()) * (y - through[i].y()));
    return z;
  };
}

Eigen::Vector2d slopeOf(const Terrain& terrain, const Eigen::Vector2d& p) {
  const double h = 0.4;  // half the wheel base
  return Eigen::Vector2d(
             Ground::heightOf(terrain, p.x() + h, p.y()) - Ground::heightOf(terrain, p.x() - h, p.y()),
             Ground::heightOf(terrain, p.x(), p.y() + h) - Ground::heightOf(terrain, p.x(), p.y() - h)) /
         (2.0 * h);
}

Drive drivenFromTables(std::uint64_t seed, const std::vector<TableRow>& measured,
                       const std::vector<TableRow>& result, double street_rad, double stop0_v) {
  Drive drive;
  RandomStream placing = RandomStream::keyed({seed, kPlacing});
  drive.grid.seed = seed;
  drive.grid.style = &QuarterStyle::carPark();
  drive.grid.angle_rad = street_rad + placing.uniform(-0.01, 0.01);
  // Stop 0, the site's origin, lies at (u, v) of the streets.
  const double u = placing.uniform(-0.3, 0.3), v = stop0_v + placing.uniform(-0.3, 0.3);
  drive.grid.origin_m = -drive.grid.site(u, v);
  std::vector<Eigen::Vector3d> feet;
  for (const TableRow& row : result) feet.emplace_back(row.x_m, row.y_m, row.z_m - kScannerHeightM);
  drive.terrain = bent(waves(seed), feet);
  RandomStream roll = RandomStream::keyed({seed, kRoll});
  for (std::size_t i = 0; i < result.size(); ++i) {
    const Pose level = result[i].pose();
    const Eigen::Vector3d right = level.rotation() * Eigen::Vector3d::UnitX();
    // The tables give no roll: the ground's slope across the heading, and what the springs add.
    const double across = slopeOf(drive.terrain, level.translation().head<2>()).dot(right.head<2>());
    const double lean = std::clamp(-std::atan(across), -0.07, 0.07) + roll.uniform(-0.008, 0.008);
    // A roll about the heading leaves it as printed; stop 0 is the world's frame and stays level.
    const Eigen::Quaterniond rolled =
        level.quaternion() * Eigen::AngleAxisd(i == 0 ? 0.0 : lean, Eigen::Vector3d::UnitY());
    drive.site_from_scan.emplace_back(rolled, level.translation());
    drive.odometry.push_back(measured[i].pose());
  }
  return drive;
}

Drive drivenAlong(std::uint64_t seed, std::vector<CoursePlace> course) {
  Drive drive;
  drive.grid.seed = seed;
  drive.grid.style = &QuarterStyle::streets();
  drive.terrain = waves(seed);
  // The machine does not keep to the middle of the lane, nor look exactly along it.
  RandomStream wander = RandomStream::keyed({seed, kWander});
  for (CoursePlace& place : course) {
    const double aside = wander.uniform(-0.6, 0.6);
    place.u_m += aside * std::cos(place.heading_rad);
    place.v_m += aside * std::sin(place.heading_rad);
    place.heading_rad += 0.05 * wander.normal();
  }
  drive.grid.angle_rad = -course.front().heading_rad;
  drive.grid.origin_m = -drive.grid.site(course.front().u_m, course.front().v_m);
  std::vector<Pose> planar;
  for (const CoursePlace& place : course) {
    const Eigen::Vector2d p = drive.grid.site(place.u_m, place.v_m);
    planar.push_back(Pose::planar(p.x(), p.y(), place.heading_rad + drive.grid.angle_rad));
    const Eigen::Vector2d slope = slopeOf(drive.terrain, p);
    const Eigen::Quaterniond lean = Eigen::Quaterniond::FromTwoVectors(
        Eigen::Vector3d::UnitZ(), Eigen::Vector3d(-slope.x(), -slope.y(), 1.0));
    drive.site_from_scan.emplace_back(
        lean * planar.back().quaternion(),
        Eigen::Vector3d(p.x(), p.y(), Ground::heightOf(drive.terrain, p.x(), p.y()) + kScannerHeightM));
  }
  drive.odometry.emplace_back();
  RandomStream error = RandomStream::keyed({seed, kOdometry});
  for (std::size_t i = 1; i < planar.size(); ++i) {
    const double way = error.uniform(0.0, 2.0 * std::numbers::pi), size = error.uniform(0.05, 0.15);
    const Pose slip =
        Pose::planar(size * std::cos(way), size * std::sin(way), 1.5 * kDegree * error.normal());
    drive.odometry.push_back(drive.odometry.back() * (planar[i - 1].inverse() * planar[i]) * slip);
  }
  return drive;
}

}  // namespace

Drive experiment1Drive(std::uint64_t seed) {
  return drivenFromTables(seed, experiment1Measured(), experiment1Result(), 0.1, 53.0);
}

Drive experiment2Drive(std::uint64_t seed, bool mended) {
  return drivenFromTables(seed, mended ? experiment2Mended() : experiment2Measured(), experiment2Result(),
                          -0.66, 39.5);
}

Drive loopDrive(std::uint64_t seed, int stops) {
  const QuarterStyle& style = QuarterStyle::streets();
  const double round =
      2.0 * (style.pitch_u + style.pitch_v) - 8.0 * kCornerM + 2.0 * std::numbers::pi * kCornerM;
  const double start = RandomStream::keyed({seed, kPlacing}).uniform(12.0, 30.0);
  return drivenAlong(seed,
                     courseAlongStreets(QuarterStyle::streets(), static_cast<std::size_t>(stops),
                                        round / std::max(stops, 40), start, [](std::size_t) { return 1; }));
}

Drive surveyDrive(std::uint64_t seed, int stops) {
  constexpr double kStep = 4.5;
  const double start = RandomStream::keyed({seed, kPlacing}).uniform(12.0, 30.0);
  return drivenAlong(
      seed, courseAlongStreets(QuarterStyle::streets(), static_cast<std::size_t>(stops), kStep, start,
                               [seed](std::size_t crossing) {
                                 const double lot = RandomStream::keyed({seed, kTurns, crossing}).uniform();
                                 return lot < 0.3 ? -1 : (lot < 0.6 ? 1 : 0);
                               }));
}

}  // namespace tiltmap
