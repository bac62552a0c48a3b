// The default preset on real scans, the same settings for all.
#include "support/real_scans.h"

#include <gtest/gtest.h>

#include "core/base/ranks.h"
#include "core/registration/register_pair.h"
#include "core/scan/kd_tree.h"
#include "core/scan/normals.h"
#include "core/scan/point_cloud.h"

namespace tiltmap {
namespace {

using test_support::cloudScan;
using test_support::readAsciiVtk;
using test_support::readStations;
using test_support::readUosScan;
using test_support::realData;

PairResult registered(const PreparedScanPtr& fixed, const PreparedScanPtr& moving, const Pose& start) {
  const auto result = registerPair(fixed, moving, start, RegistrationSettings{});
  EXPECT_TRUE(result.has_value());
  EXPECT_TRUE(result->succeeded()) << stopReasonName(result->stop_reason) << ", agreement "
                                   << result->agreement << ", overlap " << result->overlap;
  return *result;
}

TEST(RealScans, StationsChainedAgreeWithDirect) {
  const auto folder = realData("bedkowski_13");
  if (!folder) GTEST_SKIP() << "the folder of real scans is absent: bedkowski_13";
  const std::vector<Scan> scans = readStations(*folder);
  ASSERT_EQ(scans.size(), 13U);
  std::vector<PreparedScanPtr> prepared;
  for (const Scan& scan : scans) prepared.push_back(prepare(scan, {}));
  const auto link = [&](std::size_t i, std::size_t j) {
    return registered(prepared[i], prepared[j], scans[i].odometry.inverse() * scans[j].odometry);
  };
  std::vector<Pose> neighbours;
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const PairResult result = link(i, i + 1);
    EXPECT_LT(result.rms_m, 0.012) << i;
    neighbours.push_back(result.fixed_from_moving);
  }
  for (std::size_t i = 0; i + 2 < scans.size(); ++i) {
    const PoseDifference off =
        difference(link(i, i + 2).fixed_from_moving, neighbours[i] * neighbours[i + 1]);
    EXPECT_LT(off.translation_m, 0.01) << i;
    EXPECT_LT(off.rotation_rad, 0.1 * kDegree) << i;
  }
}

TEST(RealScans, IndoorGridIsNearItsPoses) {
  const auto folder = realData("3dtk_dat");
  if (!folder) GTEST_SKIP() << "the folder of real scans is absent: 3dtk_dat";
  for (int i = 0; i < 2; ++i) {
    const Scan fixed = readUosScan(*folder, i), moving = readUosScan(*folder, i + 1);
    const Pose pose = fixed.odometry.inverse() * moving.odometry;
    const PairResult result = registered(prepare(fixed, {}), prepare(moving, {}), pose);
    const PoseDifference off = difference(result.fixed_from_moving, pose);
    EXPECT_GT(off.translation_m, 0.0);
    EXPECT_LT(off.translation_m, 0.05) << i;
    EXPECT_LT(off.rotation_rad, 0.7 * kDegree) << i;
  }
}

// Median distance of the moving scan's points from the surfaces of the fixed one, along their normals: a
// yardstick that is not the registration's own.
double medianOffSurface(const Scan& fixed, const Scan& moving, const Pose& fixed_from_moving) {
  const std::vector<Eigen::Vector3d> points = cloudOf(*fixed.image, fixed.geometry).points;
  const std::vector<Eigen::Vector3d> normals = cloudNormals(points, 12, Eigen::Vector3d::Zero());
  const KdTree tree(points);
  std::vector<double> off;
  for (const Eigen::Vector3d& point : cloudOf(*moving.image, moving.geometry).points) {
    const Eigen::Vector3d p = fixed_from_moving * point;
    KdTree::Neighbour near;
    if (tree.nearestWithin(p, 0.5, near))
      off.push_back(std::abs(normals[near.index].dot(p - points[near.index])));
  }
  return medianOf(std::move(off));
}

TEST(RealScans, OutdoorSweepsConvergeFromTheIdentity) {
  const auto folder = realData("libpointmatcher");
  if (!folder) GTEST_SKIP() << "the folder of real scans is absent: libpointmatcher";
  std::vector<Scan> scans;
  std::vector<PreparedScanPtr> prepared;
  for (int i = 0; i < 3; ++i) {
    const std::string name = "cloud.0000" + std::to_string(i) + ".vtk";
    scans.push_back(cloudScan(readAsciiVtk(*folder / name), name));
    prepared.push_back(prepare(scans.back(), {}));
  }
  const PairResult a = registered(prepared[0], prepared[1], Pose()),
                   b = registered(prepared[1], prepared[2], Pose()),
                   c = registered(prepared[0], prepared[2], Pose());
  const auto turn = [](const PairResult& r) {
    return difference(r.fixed_from_moving, Pose()).rotation_rad / kDegree;
  };
  EXPECT_NEAR(turn(a), 14.7, 0.5);
  EXPECT_NEAR(turn(b), 14.3, 0.5);
  EXPECT_NEAR(turn(c), 1.3, 0.5);
  // Weighted by a loss that lets two deviations of these rough surfaces in.
  for (const PairResult& r : {a, b, c}) EXPECT_LT(r.rms_m, 0.04);
  // Thin clouds have poor normals: even right poses leave centimetres, wrong ones much more.
  EXPECT_LT(medianOffSurface(scans[0], scans[1], a.fixed_from_moving), 0.045);
  EXPECT_LT(medianOffSurface(scans[1], scans[2], b.fixed_from_moving), 0.050);
  EXPECT_GT(medianOffSurface(scans[0], scans[1], Pose()), 0.1);
  const PoseDifference closed = difference(c.fixed_from_moving, a.fixed_from_moving * b.fixed_from_moving);
  EXPECT_LT(closed.translation_m, 0.03);
  EXPECT_LT(closed.rotation_rad, 0.7 * kDegree);
}

}  // namespace
}  // namespace tiltmap
