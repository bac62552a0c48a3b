// What a registration left over, cell by cell.
#include "core/products/residuals.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/products/depth_image.h"
#include "core/project/project.h"
#include "tests/support/project_samples.h"
#include "tests/support/room_scene.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap::test {
namespace {

using Eigen::Vector3d;
using test_support::roomScene;
using test_support::sceneScan;

std::vector<float> against(const Scan& scan, const Pose& pose, const Scan& other, const Pose& other_pose,
                           const ResidualSettings& settings = {}) {
  const PlacedSurface surface{std::make_shared<const ResidualSurface>(*other.image, other.geometry),
                              other_pose};
  return must(cellResiduals(*scan.image, scan.geometry, pose, std::span(&surface, 1), settings));
}

TEST(Residuals, WithTheTruePosesOnlyNoiseIsLeft) {
  const Pose there = Pose::planar(0.4, 0.6, 0.2);
  const Scan fixed = sceneScan(roomScene(), Pose(), 0.01, 1), moving = sceneScan(roomScene(), there, 0.01, 2);
  const ResidualSummary summary = summaryOf(against(moving, there, fixed, Pose()));
  EXPECT_GT(summary.cells, moving.image->validCells() / 2);
  EXPECT_LT(summary.median_m, 0.015);
  EXPECT_GT(summary.median_m, 0.003);  // the noise is seen
}

TEST(Residuals, TellHowFarAndToWhichSideASurfaceIsOff) {
  // Lifted by 6 cm: the floor lies above the other's floor, on its scanner's side.
  const Pose there = Pose::planar(0.4, 0.6, 0.2);
  Vector6d lift = Vector6d::Zero();
  lift[5] = 0.06;
  const Scan fixed = sceneScan(roomScene(), Pose()), moving = sceneScan(roomScene(), there);
  const Pose wrong = there.moved(lift);
  const std::vector<float> up = against(moving, wrong, fixed, Pose());
  const std::vector<float> down = against(fixed, Pose(), moving, wrong);
  const auto floor_median = [](const Scan& scan, const Pose& truth, const std::vector<float>& residuals) {
    std::vector<float> values;
    const auto points = cellPoints(*scan.image, scan.geometry);
    for (std::size_t cell = 0; cell < residuals.size(); ++cell)
      if (std::isfinite(residuals[cell]) && std::abs((truth * points[cell]).z() + 1.0) < 1e-3)
        values.push_back(residuals[cell]);
    EXPECT_GT(values.size(), 1000U);
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  };
  EXPECT_NEAR(floor_median(moving, there, up), 0.06, 0.002);
  EXPECT_NEAR(floor_median(fixed, Pose(), down), -0.06, 0.002);
  EXPECT_LT(summaryOf(against(moving, there, fixed, Pose())).median_m, 1e-4);
}

TEST(Residuals, MissingWhereNothingOverlaps) {
  const Scan scan = sceneScan(roomScene(), Pose());
  const std::vector<float> far = against(scan, Pose::planar(500, 0, 0), scan, Pose());
  EXPECT_EQ(summaryOf(far).cells, 0U);
  EXPECT_EQ(far.size(), scan.image->cells());
  const std::vector<float> near = against(scan, Pose(), scan, Pose());
  for (std::size_t cell = 0; cell < near.size(); ++cell)
    EXPECT_TRUE(scan.image->hasPoint(cell) || std::isnan(near[cell]));
  // The two sides of a thin wall are not one surface.
  const Scan inside = sceneScan({{{0, 1, 0}, 3.0}}, Pose());
  const Scan behind = sceneScan({{{0, 1, 0}, 3.05}}, Pose::planar(0, 6, std::numbers::pi));
  EXPECT_EQ(summaryOf(against(inside, Pose(), behind, Pose::planar(0, 6, std::numbers::pi))).cells, 0U);
}

TEST(Residuals, AScanWithoutPointsHasNoneAndGivesNone) {
  const Scan scan = sceneScan(roomScene(), Pose());
  RangeImageData data = scan.image->data();
  data.range_m.assign(data.cells(), 0.0F);
  data.code.assign(data.cells(), cell_code::kNoReturn);
  Scan nothing = scan;
  nothing.image = must(RangeImage::make(std::move(data)));
  EXPECT_EQ(summaryOf(against(nothing, Pose(), scan, Pose())).cells, 0U);
  EXPECT_EQ(summaryOf(against(scan, Pose(), nothing, Pose())).cells, 0U);
}

TEST(Residuals, StopWhenCancelledAndDoNotDependOnThreads) {
  const Scan scan = sceneScan(roomScene(), Pose(), 0.01);
  const PlacedSurface surface{std::make_shared<const ResidualSurface>(*scan.image, scan.geometry), Pose()};
  const Pose shifted = Pose::planar(0.02, 0.01, 0.0);
  const auto run = [&](const JobControl& control, int threads) {
    return cellResiduals(*scan.image, scan.geometry, shifted, std::span(&surface, 1), {}, control, threads);
  };
  const std::vector<float> one = must(run({}, 1)), two = must(run({}, 2));
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    EXPECT_TRUE(one[i] == two[i] || (std::isnan(one[i]) && std::isnan(two[i])));
  std::stop_source source;
  source.request_stop();
  EXPECT_FALSE(run({{}, source.get_token()}, 2));
}

class ProjectResidualsTest : public ::testing::Test {
 protected:
  ProjectResidualsTest() : project(must(Project::create(folder / "rooms.tiltmap"))) {
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < 4; ++i) {
      scans.push_back(sceneScan(roomScene(), truth[i], 0.005, i + 1));
      scans.back().odometry = odometry[i];
    }
    must(project->apply(importEdit(std::move(scans))));
    std::vector<std::pair<ScanId, Pose>> poses;
    for (std::size_t i = 0; i < 4; ++i) poses.emplace_back(snapshot()->scans()[i].id, truth[i]);
    must(project->apply(posesEdit(Stage::Truth, poses)));
  }
  SnapshotPtr snapshot() const { return project->snapshot(); }

  const std::vector<Pose> truth = {Pose(), Pose::planar(0.5, 0, 0.1), Pose::planar(0.6, 0.5, 0.3),
                                   Pose::planar(0, 0.5, -0.2)};
  const std::vector<Pose> odometry = {Pose(), Pose::planar(0.6, 0, 0.1), Pose::planar(0.7, 0.6, 0.32),
                                      Pose::planar(0, 0.6, -0.2)};
  TemporaryFolder folder;
  std::unique_ptr<Project> project;
};

TEST_F(ProjectResidualsTest, AreSmallerAtABetterStage) {
  ProjectResiduals good(snapshot(), Stage::Truth), rough(snapshot(), Stage::Odometry);
  for (std::size_t scan = 0; scan < 4; ++scan) {
    const ResidualSummary after = summaryOf(must(good.of(scan))), before = summaryOf(must(rough.of(scan)));
    EXPECT_LT(after.median_m, 0.008) << scan;
    EXPECT_GT(before.median_m, 2 * after.median_m) << scan;
  }
}

TEST_F(ProjectResidualsTest, AreTakenAgainstLinkedScansElseNeighbours) {
  EXPECT_EQ(residualPartners(*snapshot(), 0), (std::vector<std::size_t>{1}));
  EXPECT_EQ(residualPartners(*snapshot(), 2), (std::vector<std::size_t>{1, 3}));
  const auto before = ProjectResiduals::fingerprint(*snapshot(), snapshot()->filledPoses(Stage::Truth), 0);
  const auto id = [&](std::size_t i) { return snapshot()->scans()[i].id; };
  must(project->apply(registerEdit(snapshot(), {sampleLink(id(0), id(3))}, {})));
  EXPECT_EQ(residualPartners(*snapshot(), 0), (std::vector<std::size_t>{3}));
  EXPECT_EQ(residualPartners(*snapshot(), 3), (std::vector<std::size_t>{0}));
  EXPECT_EQ(residualPartners(*snapshot(), 2), (std::vector<std::size_t>{1, 3}));
  const auto after = ProjectResiduals::fingerprint(*snapshot(), snapshot()->filledPoses(Stage::Truth), 0);
  EXPECT_NE(before, after);
  // A new name changes nothing that residuals come from.
  must(project->apply(renameEdit(id(0), "another name")));
  EXPECT_EQ(after, ProjectResiduals::fingerprint(*snapshot(), snapshot()->filledPoses(Stage::Truth), 0));
  EXPECT_NE(after, ProjectResiduals::fingerprint(*snapshot(), snapshot()->filledPoses(Stage::Odometry), 0));
}

TEST_F(ProjectResidualsTest, AreDrawnAroundZero) {
  ProjectResiduals residuals(snapshot(), Stage::Odometry);
  const ScanEntry& scan = snapshot()->scans()[1];
  const auto image = must(scan.image());
  const DepthImage depth =
      must(depthImageOf(image, scan.geometry, DepthQuantity::Residual, must(residuals.of(1))));
  EXPECT_EQ(depth.low, -depth.high);
  EXPECT_GT(depth.high, 0.01);
  EXPECT_GT(depth.overlapping, 1000U);
  EXPECT_TRUE(depth.hasColourBar());
  const Rgb zero = depthColour(depth, 0.0, -0.1, 0.2), far = depthColour(depth, 0.2, -0.1, 0.2);
  EXPECT_LE(std::max({zero.r, zero.g, zero.b}) - std::min({zero.r, zero.g, zero.b}), 4);  // grey
  EXPECT_GT(far.r, far.b + 100);                                                          // orange
  EXPECT_GT(depthColour(depth, -0.2, -0.1, 0.2).b, 150);                                  // blue
  EXPECT_FALSE(depthImageOf(image, scan.geometry, DepthQuantity::Residual));              // none given
}

}  // namespace
}  // namespace tiltmap::test
