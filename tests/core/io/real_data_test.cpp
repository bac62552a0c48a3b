// Scans by others, as they come.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "core/io/pose_file.h"
#include "core/io/scan_reader.h"
#include "core/scan/kd_tree.h"
#include "core/scan/point_cloud.h"
#include "support/shared_data.h"

namespace tiltmap {
namespace {

std::vector<Eigen::Vector3d> linesOf3d(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::vector<Eigen::Vector3d> points;
  double x = 0, y = 0, z = 0;
  while (stream >> x >> y >> z) points.emplace_back(x / 100, z / 100, y / 100);
  return points;
}

class ThreeDtk : public testing::TestWithParam<int> {};

TEST_P(ThreeDtk, TheGridOfTheTiltedScannerIsRegained) {
  TILTMAP_NEEDS_SHARED_DATA("3dtk_dat");
  const auto path = test::sharedData("3dtk_dat/scan00" + std::to_string(GetParam()) + ".3d");
  const auto result = readScans(path, {ScanFormat::Auto, 0.5, 32.0});
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_EQ(result->scans.size(), 1U);
  EXPECT_TRUE(result->warnings.empty());
  const Scan& scan = result->scans[0].scan;
  const RangeImage& image = *scan.image;
  EXPECT_EQ(image.rows(), 226);
  EXPECT_EQ(image.columns(), 360);
  EXPECT_TRUE(image.isRegular());
  EXPECT_NEAR(scan.geometry.azimuth_start_rad, 0.0, 1e-12);
  EXPECT_NEAR(scan.geometry.azimuth_step_rad, 0.5 * kDegree, 1e-12);
  EXPECT_NEAR(image.lineTilt(0), -48.70 * kDegree, 1e-5);
  EXPECT_NEAR(image.lineTilt(225), 67.60 * kDegree, 1e-5);
  EXPECT_NEAR(scan.geometry.tilt_step_rad, 116.3 / 225 * kDegree, 1e-5);

  const auto file = linesOf3d(path);
  const auto points = cellPoints(image, scan.geometry);
  ASSERT_EQ(file.size(), points.size());
  double worst = 0.0;
  std::size_t valid = 0, far = 0, near = 0;
  for (std::size_t i = 0; i < file.size(); ++i) {
    const double range = file[i].norm();
    far += range > 32.0;
    near += range < 0.5;
    EXPECT_EQ(image.hasPoint(i), range >= 0.5 && range <= 32.0);
    if (!image.hasPoint(i)) {
      EXPECT_EQ(image.code(i), cell_code::kOutOfBounds);
      continue;
    }
    ++valid;
    worst = std::max(worst, (points[i] - file[i]).norm());
  }
  EXPECT_EQ(valid + far + near, 81360U);
  EXPECT_GT(far, 1000U);
  EXPECT_LT(worst, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Scans, ThreeDtk, testing::Range(0, 3));

TEST(RealData, TheBoundsOf3dtkAreOptionsAndNotBuiltIn) {
  TILTMAP_NEEDS_SHARED_DATA("3dtk_dat");
  const auto result = readScans(test::sharedData("3dtk_dat/scan000.3d"), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scans[0].scan.image->validCells(), 81360U);
  EXPECT_TRUE(result->scans[0].scan.image->isRegular());
}

// The only check of handedness and angle order that no formula of ours can fool: with the poses of the files
// the same walls come to lie on each other, without them they do not.
TEST(RealData, The3dtkPosesBringTheScansTogether) {
  TILTMAP_NEEDS_SHARED_DATA("3dtk_dat");
  std::vector<ImportedScan> scans;
  for (int i = 0; i < 3; ++i) {
    auto result = readScans(test::sharedData("3dtk_dat/scan00" + std::to_string(i) + ".3d"),
                            {ScanFormat::Uos, 0.5, 32.0});
    ASSERT_TRUE(result) << result.error().what;
    ASSERT_TRUE(result->scans[0].pose);
    scans.push_back(result->scans[0]);
  }
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const auto fixed = cloudOf(*scans[i].scan.image, scans[i].scan.geometry).points;
    const auto moving = cloudOf(*scans[i + 1].scan.image, scans[i + 1].scan.geometry).points;
    const KdTree tree(fixed);
    // The share of points that lie within 3 cm of the other scan.
    const auto together = [&](const Pose& fixed_from_moving) {
      int near = 0, all = 0;
      KdTree::Neighbour found;
      for (std::size_t k = 0; k < moving.size(); k += 20, ++all)
        near += tree.nearestWithin(fixed_from_moving * moving[k], 0.03, found);
      return static_cast<double>(near) / all;
    };
    const Pose pose = scans[i].pose->inverse() * *scans[i + 1].pose;
    const double with = together(pose);
    RecordProperty("together" + std::to_string(i), std::to_string(with));
    EXPECT_GT(with, 0.45) << i;
    EXPECT_GT(with, 1.05 * together(Pose())) << i;
    EXPECT_GT(with, 3.0 * together(pose.inverse())) << i;
    if (i == 0) {
      EXPECT_GT(with, 1.2 * together(Pose(pose.quaternion().conjugate(), pose.translation())));
    }
  }
}

TEST(RealData, EveryStationOfTheGarageIsReadWhole) {
  TILTMAP_NEEDS_SHARED_DATA("bedkowski_13");
  const int expected[] = {65786, 82363, 87883, 86322, 85978, 85489, 101635,
                          90796, 84368, 91031, 74710, 76933, 54533};
  for (int i = 0; i < 13; ++i) {
    std::ostringstream name;
    name << "bedkowski_13/scan0" << (i < 10 ? "0" : "") << i << ".pcd";
    const auto result = readScans(test::sharedData(name.str()), {});
    ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
    const Scan& scan = result->scans[0].scan;
    EXPECT_EQ(scan.image->validCells(), static_cast<std::size_t>(expected[i])) << name.str();
    EXPECT_FALSE(scan.image->isMatrix());
    EXPECT_TRUE(scan.image->hasIntensity());
    EXPECT_FALSE(result->scans[0].pose) << "the VIEWPOINT is the identity";
    if (i == 0) {
      const auto points = cellPoints(*scan.image, scan.geometry);
      EXPECT_LT((points[0] - Eigen::Vector3d(28.629501, -9.3484993, -6.6500001)).norm(), 1e-5);
      EXPECT_FLOAT_EQ(scan.image->intensity(1), 55.5F);
    }
  }
}

}  // namespace
}  // namespace tiltmap
