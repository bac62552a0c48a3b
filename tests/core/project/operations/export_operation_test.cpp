#include <sstream>

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "core/scan/point_cloud.h"
#include "tests/support/program.h"

namespace tiltmap {
namespace {

// Two scans of a 2 x 3 matrix, the second two metres to the right of the first.
class ExportOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    RangeImageData data;
    data.rows = 2;
    data.columns = 3;
    data.range_m.assign(6, 5.0F);
    data.code.assign(6, cell_code::kMeasured);
    data.code[4] = cell_code::kLmsNoSignal;
    data.line_tilt_rad = {-0.1, 0.1};
    Scan scan;
    scan.image = RangeImage::make(data).value();
    scan.geometry.rows = 2;
    scan.geometry.columns = 3;
    scan.geometry.azimuth_start_rad = 1.0;
    scan.geometry.azimuth_step_rad = 0.5;
    Scan second = scan;
    second.odometry = Pose::planar(2, 0, 0);
    cloud_ = cloudOf(*scan.image, scan.geometry);
    auto made = Project::create((folder_ / "p.tiltmap").string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
    ASSERT_TRUE(project_->apply(importEdit({scan, second})));
  }
  Result<OperationResult> run(ParameterValues values) {
    auto job = Job::start(*operations().find("export"), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    return (*job)->result();
  }
  std::vector<Eigen::Vector3d> pointsOf(const std::string& name) {
    std::istringstream text(test::fileText(folder_.path() / name));
    std::vector<Eigen::Vector3d> points;
    for (std::string line; std::getline(text, line);) {
      std::istringstream words(line);
      Eigen::Vector3d p;
      words >> p.x() >> p.y() >> p.z();
      points.push_back(p);
    }
    return points;
  }
  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  PointCloud cloud_;
};

TEST_F(ExportOperationTest, PointsStandWhereThePosesPutThem) {
  ASSERT_TRUE(run({{"file", (folder_ / "map.xyz").string()}}));
  const auto points = pointsOf("map.xyz");
  ASSERT_EQ(points.size(), 10U);
  EXPECT_LT((points[0] - cloud_.points[0]).norm(), 1e-3);
  EXPECT_LT((points[5] - cloud_.points[0] - Eigen::Vector3d(2, 0, 0)).norm(), 1e-3);
}

TEST_F(ExportOperationTest, StageAndScansAreChosen) {
  const auto snapshot = project_->snapshot();
  ASSERT_TRUE(
      project_->apply(posesEdit(Stage::Pairwise, {{snapshot->scans()[1].id, Pose::planar(7, 0, 0)}})));
  ASSERT_TRUE(run({{"file", (folder_ / "one.xyz").string()}, {"scans", std::string("1")}}));
  auto points = pointsOf("one.xyz");
  ASSERT_EQ(points.size(), 5U);
  EXPECT_LT((points[0] - cloud_.points[0] - Eigen::Vector3d(7, 0, 0)).norm(), 1e-3);
  ASSERT_TRUE(run({{"file", (folder_ / "one.xyz").string()},
                   {"scans", std::string("1")},
                   {"stage", std::string("odometry")}}));
  points = pointsOf("one.xyz");
  EXPECT_LT((points[0] - cloud_.points[0] - Eigen::Vector3d(2, 0, 0)).norm(), 1e-3);
}

TEST_F(ExportOperationTest, ReducedHoldsFewer) {
  ASSERT_TRUE(
      run({{"file", (folder_ / "small.xyz").string()}, {"reduced", true}, {"reduction-distance", 50.0}}));
  EXPECT_LT(pointsOf("small.xyz").size(), 10U);
  EXPECT_GT(pointsOf("small.xyz").size(), 0U);
}

TEST_F(ExportOperationTest, RefusalsWriteNothing) {
  EXPECT_FALSE(run({{"file", (folder_ / "map.stl").string()}}));
  EXPECT_FALSE(run({{"file", (folder_ / "map.ply").string()}, {"stage", std::string("relaxed")}}));
  EXPECT_FALSE(run({{"file", (folder_ / "map.ply").string()}, {"scans", std::string("2")}}));
  EXPECT_FALSE(run({}));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "map.ply"));
}

}  // namespace
}  // namespace tiltmap
