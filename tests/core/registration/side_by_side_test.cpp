// The loops that run side by side, held against the plain ones.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/registration/direction_index.h"
#include "core/registration/grid_moments.h"
#include "core/registration/patch_lanes.h"
#include "core/registration/patch_raster.h"
#include "core/registration/plane_patch.h"
#include "core/registration/registration.h"
#include "core/world/experiment.h"

namespace tiltmap {
namespace {

using V = Eigen::Vector3d;

// Points on a plane some metres away, off it by `noise_m`.
Moments somePlane(RandomStream& random, double noise_m) {
  const V middle(random.uniform(-20.0, 20.0), random.uniform(2.0, 20.0), random.uniform(-2.0, 5.0));
  const V u = V(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
  const V v = u.unitOrthogonal(), n = u.cross(v);
  Moments sum;
  for (int i = 0; i < 40; ++i) {
    const V p = middle + random.uniform(-0.4, 0.4) * u + random.uniform(-0.2, 0.2) * v +
                random.uniform(-noise_m, noise_m) * n;
    sum += {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
            p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
  }
  return sum;
}

void put(const Moments& m, std::size_t at, GroupLanes& g) {
  g.n[at] = m.n, g.x[at] = m.x, g.y[at] = m.y, g.z[at] = m.z;
  g.xx[at] = m.xx, g.xy[at] = m.xy, g.xz[at] = m.xz, g.yy[at] = m.yy, g.yz[at] = m.yz, g.zz[at] = m.zz;
}

struct PlaneLanesTest : ::testing::Test {
  PlaneRule rule;
  PlaneLanesTest() {
    rule.noise_square = rule.prior_noise_square = 0.012 * 0.012;
    rule.floor_square = 0.002 * 0.002;
    rule.rough_noise_square = 0.03 * 0.03, rule.rough_floor_square = 0.02 * 0.02;
    rule.largest_square = 1.0 / 12.0;
    rule.spot_rad = 0.16 * kDegree;
    rule.prior_points = 10.0;
  }
};

TEST_F(PlaneLanesTest, JudgeAndDescribeAsThePlainFunctionsDo) {
  RandomStream random(7);
  std::size_t kept = 0, split = 0, dropped = 0;
  for (const bool can_split : {false, true}) {
    GroupLanes groups;
    PlaneLanes planes;
    std::vector<Moments> plain;
    for (std::size_t i = 0; i < GroupLanes::kMost; ++i) {
      plain.push_back(somePlane(random, i % 3 == 0 ? 0.005 : i % 3 == 1 ? 0.04 : 0.3));
      put(plain.back(), i, groups);
    }
    rule.can_split = can_split;
    spreadGroups(GroupLanes::kMost, groups);
    judgePlanes(GroupLanes::kMost, groups, rule, planes);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      const Eigen::Matrix3d covariance = plain[i].covariance();
      const V mean = plain[i].mean();
      EXPECT_NEAR(groups.trace[i], covariance.trace(), 1e-9);
      EXPECT_NEAR(groups.least[i], leastResidual(covariance), 1e-9);
      const auto [values, axes] = planeAxes(covariance);
      const bool planar = fitsPlane(mean, values, axes.col(0), 0.012, 0.002);
      const bool rough = fitsPlane(mean, values, axes.col(0), 0.03, 0.02);
      const auto short_m = shortRange(mean, axes.col(0), rule.spot_rad);
      SurfaceElements out;
      GroupFate fate = GroupFate::Dropped;
      if (can_split && (!planar || values[2] > rule.largest_square))
        fate = GroupFate::Split;
      else if ((planar || rough) && short_m &&
               appendPatch(mean + *short_m * mean.normalized(), values, axes, plain[i].n, out, {0.012, 10.0}))
        fate = GroupFate::Kept;
      ASSERT_EQ(planes.fate[i], static_cast<double>(fate)) << i;
      ++(fate == GroupFate::Kept ? kept : fate == GroupFate::Split ? split : dropped);
      if (fate != GroupFate::Kept) continue;
      EXPECT_LT((V(planes.x[i], planes.y[i], planes.z[i]) - out.position[0]).norm(), 1e-6);
      EXPECT_LT((V(planes.nx[i], planes.ny[i], planes.nz[i]) - out.normal[0]).norm(), 1e-6);
      EXPECT_GT(std::abs(V(planes.ux[i], planes.uy[i], planes.uz[i]).dot(out.shape[0].u)), 1.0 - 1e-6);
      EXPECT_GT(std::abs(V(planes.vx[i], planes.vy[i], planes.vz[i]).dot(out.shape[0].v)), 1.0 - 1e-6);
      EXPECT_NEAR(planes.offset_variance[i], out.shape[0].offset_variance_m2, 1e-9);
      EXPECT_NEAR(planes.tilt_u[i], out.shape[0].tilt_variance_u, 1e-7);
      EXPECT_NEAR(planes.tilt_v[i], out.shape[0].tilt_variance_v, 1e-7);
      EXPECT_NEAR(planes.extent_u[i], out.shape[0].extent_u_m, 1e-7);
      EXPECT_NEAR(planes.extent_v[i], out.shape[0].extent_v_m, 1e-7);
      EXPECT_NEAR(planes.residual[i], out.shape[0].residual_m, 1e-7);
    }
  }
  EXPECT_GT(kept, 20U);
  EXPECT_GT(split, 10U);
  EXPECT_GT(dropped, 10U);
}

TEST_F(PlaneLanesTest, WhatSpansNoPlaneIsDropped) {
  GroupLanes groups;
  PlaneLanes planes;
  Moments line, point;
  for (int i = 0; i < 10; ++i) {
    const V p(1.0, 5.0 + 0.1 * i, 0.0);
    line += {1.0,           p.x(),         p.y(),         p.z(),         p.x() * p.x(),
             p.x() * p.y(), p.x() * p.z(), p.y() * p.y(), p.y() * p.z(), p.z() * p.z()};
    point += {1.0, 1.0, 5.0, 2.0, 1.0, 5.0, 2.0, 25.0, 10.0, 4.0};
  }
  put(line, 0, groups);
  put(point, 1, groups);
  spreadGroups(2, groups);
  judgePlanes(2, groups, rule, planes);
  for (const std::size_t i : {0U, 1U})
    EXPECT_EQ(planes.fate[i], static_cast<double>(GroupFate::Dropped)) << i;
}

TEST(DirectionIndex, NearestFittingIsTheNearestOfThoseAround) {
  RandomStream random(3);
  std::vector<V> positions, normals;
  for (int i = 0; i < 3000; ++i) {
    positions.emplace_back(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-3, 3));
    normals.push_back(V(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized());
  }
  const DirectionIndex index(positions, 9.0 * kDegree, normals);
  for (int i = 0; i < 300; ++i) {
    const V p(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-3, 3));
    const V n = V(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
    const double min_cos = i % 2 == 0 ? 0.8 : 0.999;
    std::uint32_t best = DirectionIndex::kNobody, any = best;
    double best_square = std::numeric_limits<double>::infinity(), any_square = best_square;
    index.around(p, [&](const std::uint32_t* first, const std::uint32_t* last) {
      for (; first != last; ++first) {
        const double square = (positions[*first] - p).squaredNorm();
        if (square < any_square) any_square = square, any = *first;
        if (normals[*first].dot(n) >= min_cos && square < best_square) best_square = square, best = *first;
      }
    });
    const std::uint32_t found = index.nearestFitting(p, n, min_cos);
    if (best != DirectionIndex::kNobody)
      EXPECT_EQ(found, best);
    else if (any != DirectionIndex::kNobody)
      EXPECT_LT(normals[found].dot(n), min_cos);
    else
      EXPECT_EQ(found, DirectionIndex::kNobody);
  }
}

// Looked up without special cases, the raster goes all round and ends at its poles.
TEST(PatchRaster, TheFirstAndTheLastLineAreNeighbours) {
  const auto at = [](double turn_deg, double from_axis_deg) {
    const double turn = turn_deg * kDegree, from_axis = from_axis_deg * kDegree;
    return V(std::cos(from_axis), std::sin(from_axis) * std::cos(turn), std::sin(from_axis) * std::sin(turn));
  };
  PatchRaster raster;
  raster.paint(at(359.5, 90.0), 5);
  raster.paint(at(0.5, 60.0), 6);
  raster.closeGaps();
  const auto sees = [&](const V& p, std::uint32_t patch, int reach) {
    bool seen = false;
    raster.around(p, reach, [&](std::uint32_t found) { return !(seen = seen || found == patch); });
    return seen;
  };
  EXPECT_TRUE(sees(at(0.5, 90.0), 5, 0));    // the gap was closed across the seam
  EXPECT_TRUE(sees(at(359.5, 60.0), 6, 0));  // and the other way
  EXPECT_TRUE(sees(at(2.0, 90.0), 5, 1));
  EXPECT_FALSE(sees(at(2.0, 90.0), 5, 0));
  EXPECT_TRUE(sees(at(5.0, 90.0), 5, 3));
  EXPECT_FALSE(sees(at(90.0, 0.5), 5, 3));
  EXPECT_FALSE(sees(at(90.0, 179.5), 6, 3));
}

// Two quarter turns with little in common, on whose way some direction looks as if nothing held it.
TEST(WeakDirections, DoNotHoldAPairUpOnItsWay) {
  for (const auto& [seed, stop] : {std::pair(109, 12), std::pair(110, 9)}) {
    const auto drive = Experiment::make(ExperimentId::Exp2Fixed, static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(drive.has_value());
    const auto fixed = drive->simulate(stop, 0), moving = drive->simulate(stop + 1, 0);
    ASSERT_TRUE(fixed.has_value() && moving.has_value());
    Registration registration(fixed->scan, moving->scan,
                              fixed->scan.odometry.inverse() * moving->scan.odometry, RegistrationSettings{});
    while (!registration.done()) registration.step();
    EXPECT_TRUE(isSuccess(*registration.stopReason()));
    const PoseDifference off =
        difference(registration.fixedFromMoving(), fixed->truth.inverse() * moving->truth);
    EXPECT_LT(off.translation_m, 0.006) << "seed " << seed;
    EXPECT_LT(off.rotation_rad, 0.02 * kDegree) << "seed " << seed;
  }
}

}  // namespace
}  // namespace tiltmap
