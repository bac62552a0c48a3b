#include <sstream>

#include <gtest/gtest.h>

#include "core/io/pose_file.h"
#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "tests/support/program.h"

namespace tiltmap {
namespace {

class ImportOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = Project::create((folder_ / "p.tiltmap").string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
  }
  // A cloud of two points, with the viewpoint's position and heading (radians, left positive).
  std::string cloud(const std::string& name, double x, double y, double heading) {
    const Pose pose = Pose::planar(x, y, heading);
    const auto& q = pose.quaternion();
    std::ostringstream text;
    text.precision(17);
    text << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT "
         << x << " " << y << " 0 " << q.w() << " " << q.x() << " " << q.y() << " " << q.z()
         << "\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n";
    test::writeFile(folder_.path() / name, text.str());
    return (folder_ / name).string();
  }
  Result<OperationResult> import(const std::string& files, const std::string& odometry = "") {
    ParameterValues values = {{"files", files}};
    if (!odometry.empty()) values["odometry"] = odometry;
    auto job = Job::start(*operations().find("import"), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    auto result = (*job)->result();
    if (result)
      if (auto change = (*job)->accept(*project_); !change) return fail(change.error());
    return result;
  }
  double off(std::size_t scan, const Pose& expected) {
    const PoseDifference d = difference(project_->snapshot()->scans()[scan].odometry(), expected);
    return d.translation_m + d.rotation_rad;
  }
  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(ImportOperationTest, PosesAreRebasedOnTheFirstScanAndTheOffsetIsKept) {
  ASSERT_TRUE(import(cloud("a.pcd", 10, 20, 1.0) + "\n" + cloud("b.pcd", 12, 20, 1.2)));
  const Pose a = Pose::planar(10, 20, 1.0), b = Pose::planar(12, 20, 1.2), c = Pose::planar(15, 21, -0.4);
  EXPECT_LT(off(0, Pose()), 1e-6);
  EXPECT_LT(off(1, a.inverse() * b), 1e-6);
  ASSERT_TRUE(project_->snapshot()->survey().site_from_world);
  EXPECT_LT(difference(*project_->snapshot()->survey().site_from_world, a).translation_m, 1e-6);
  // Later scans come through the same offset, and it survives reopening.
  project_.reset();
  project_ = std::move(*Project::open((folder_ / "p.tiltmap").string(), Access::ReadWrite));
  ASSERT_TRUE(import(cloud("c.pcd", 15, 21, -0.4)));
  EXPECT_LT(off(2, a.inverse() * c), 1e-6);
}

TEST_F(ImportOperationTest, OdometryFileCountsFromZeroOrByProjectIndex) {
  const std::string one = cloud("a.pcd", 0, 0, 0), two = cloud("b.pcd", 0, 0, 0);
  const IndexedPoses poses = {{0, Pose()}, {1, Pose::planar(1, 2, 0.3)}};
  ASSERT_TRUE(writePosesTum(folder_.path() / "o.tum", poses));
  const auto result = import(one + "\n" + two, (folder_ / "o.tum").string());
  ASSERT_TRUE(result) << result.error().what;
  EXPECT_LT(off(1, poses.at(1)), 1e-9);
  const IndexedPoses later = {{2, Pose::planar(5, 6, 0)}};
  ASSERT_TRUE(writePosesTum(folder_.path() / "later.tum", later));
  ASSERT_TRUE(import(one, (folder_ / "later.tum").string()));
  EXPECT_LT(off(2, later.at(2)), 1e-9);
  const IndexedPoses few = {{7, Pose()}};
  ASSERT_TRUE(writePosesTum(folder_.path() / "few.tum", few));
  EXPECT_FALSE(import(one, (folder_ / "few.tum").string()));
  EXPECT_EQ(project_->snapshot()->scans().size(), 3U);
}

TEST_F(ImportOperationTest, AScanWithoutAPoseStandsWhereTheOneBeforeStoodAndSaysSo) {
  const auto result = import(cloud("a.pcd", 3, 4, 0.5) + "\n" + cloud("b.pcd", 0, 0, 0));
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->warnings.empty());
  EXPECT_LT(off(1, Pose()), 1e-9);
}

TEST_F(ImportOperationTest, OneBadFileAndNothingIsAdded) {
  test::writeFile(folder_.path() / "bad.pcd", "VERSION 0.7\n");
  EXPECT_FALSE(import(cloud("a.pcd", 0, 0, 0) + "\n" + (folder_ / "bad.pcd").string()));
  EXPECT_TRUE(project_->snapshot()->scans().empty());
  EXPECT_FALSE(import(""));
}

}  // namespace
}  // namespace tiltmap
