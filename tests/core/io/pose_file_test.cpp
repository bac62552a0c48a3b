#include "core/io/pose_file.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::TemporaryFolder;

Pose randomPose(RandomStream& random) {
  Vector6d d;
  for (int i = 0; i < 3; ++i) d[i] = random.uniform(-1.8, 1.8);
  for (int i = 3; i < 6; ++i) d[i] = random.uniform(-50.0, 50.0);
  return Pose().moved(d);
}

void expectSame(const Pose& a, const Pose& b, double tolerance = 1e-12) {
  EXPECT_LT(difference(a, b).translation_m, tolerance);
  EXPECT_LT(difference(a, b).rotation_rad, tolerance + 1e-7);  // acos-free, but a square root near 1
}

TEST(PosesTum, ReadBackAsWritten) {
  const TemporaryFolder folder;
  RandomStream random(7);
  IndexedPoses poses;
  for (const int index : {0, 1, 2, 7, 13}) poses[index] = index == 0 ? Pose() : randomPose(random);
  ASSERT_TRUE(writePosesTum(folder / "poses.tum", poses));
  const auto back = readPosesTum(folder / "poses.tum");
  ASSERT_TRUE(back) << back.error().what;
  ASSERT_EQ(back->size(), poses.size());
  for (const auto& [index, pose] : poses) expectSame(back->at(index), pose);
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(PosesTum, OrderOfTheColumns) {
  const TemporaryFolder folder;
  // A quarter turn to the left, as x y z w.
  const auto file = folder.write("p.tum", "# a remark\r\n\r\n3.000 1 2 3 0 0 0.70710678 0.70710678\r\n");
  const auto poses = readPosesTum(file);
  ASSERT_TRUE(poses) << poses.error().what;
  ASSERT_EQ(poses->count(3), 1U);
  EXPECT_LT((poses->at(3).translation() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((poses->at(3).heading() - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-7);
}

struct BadLine {
  const char* name;
  const char* text;
  const char* line;
};

class PosesTumBad : public testing::TestWithParam<BadLine> {};

TEST_P(PosesTumBad, IsRefusedWithFileAndLine) {
  const TemporaryFolder folder;
  const auto file = folder.write("bad.tum", GetParam().text);
  const auto poses = readPosesTum(file);
  ASSERT_FALSE(poses);
  EXPECT_NE(poses.error().where.find("bad.tum" + std::string(GetParam().line)), std::string::npos)
      << poses.error().where;
  EXPECT_FALSE(poses.error().what.empty());
  EXPECT_FALSE(poses.error().remedy.empty());
}

INSTANTIATE_TEST_SUITE_P(Table, PosesTumBad,
                         testing::Values(BadLine{"Empty", "", ""}, BadLine{"OnlyRemarks", "# nothing\n", ""},
                                         BadLine{"TooFew", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n", ":2"},
                                         BadLine{"TooMany", "0 0 0 0 0 0 0 1 9\n", ":1"},
                                         BadLine{"Word", "0 0 zero 0 0 0 0 1\n", ":1"},
                                         BadLine{"NaN", "0 0 nan 0 0 0 0 1\n", ":1"},
                                         BadLine{"Infinity", "0 0 0 inf 0 0 0 1\n", ":1"},
                                         BadLine{"Overflow", "0 0 0 1e999 0 0 0 1\n", ":1"},
                                         BadLine{"ZeroQuaternion", "0 0 0 0 0 0 0 0\n", ":1"},
                                         BadLine{"LongQuaternion", "0 0 0 0 0 0 0 2\n", ":1"},
                                         BadLine{"NegativeIndex", "-1 0 0 0 0 0 0 1\n", ":1"},
                                         BadLine{"BrokenIndex", "0.5 0 0 0 0 0 0 1\n", ":1"},
                                         BadLine{"HugeIndex", "1e12 0 0 0 0 0 0 1\n", ":1"},
                                         BadLine{"Twice", "0 0 0 0 0 0 0 1\n# x\n0 1 0 0 0 0 0 1\n", ":3"},
                                         BadLine{"Binary", "\x01\x02\xff\xfe\x7f", ":1"}),
                         [](const auto& test) { return test.param.name; });

TEST(PosesTum, AMissingFileAndAFolderAreErrors) {
  const TemporaryFolder folder;
  EXPECT_FALSE(readPosesTum(folder / "none.tum"));
  EXPECT_FALSE(readPosesTum(folder.path()));
}

TEST(PosesKitti, HoldTheUpperRowsOfTheMatrix) {
  const TemporaryFolder folder;
  const IndexedPoses poses{{0, Pose()}, {1, Pose::planar(1.5, 2.5, 0.5 * 3.14159265358979323846)}};
  ASSERT_TRUE(writePosesKitti(folder / "k.txt", poses));
  std::ifstream stream(folder / "k.txt");
  double v[24];
  for (double& x : v) ASSERT_TRUE(stream >> x);
  std::string more;
  EXPECT_FALSE(stream >> more);
  EXPECT_EQ(v[0], 1.0);
  EXPECT_EQ(v[12 + 3], 1.5);
  EXPECT_EQ(v[12 + 7], 2.5);
  EXPECT_NEAR(v[12 + 1], -1.0, 1e-12);
  EXPECT_NEAR(v[12 + 4], 1.0, 1e-12);
}

TEST(PosesKitti, AGapIsAnError) {
  const TemporaryFolder folder;
  const auto status = writePosesKitti(folder / "k.txt", {{0, Pose()}, {2, Pose()}});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("scan 1"), std::string::npos);
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(PosesCsv, NamesItsColumnsAndTellsTheHeading) {
  const std::string text = posesCsvText({{4, Pose::planar(1, 2, 0)}});
  EXPECT_EQ(text, "index,x_m,y_m,z_m,qx,qy,qz,qw,heading_x,heading_y,heading_z\n4,1,2,0,0,0,0,1,0,1,0\n");
}

// What makes the conversion right: moving points in 3DTK's own frame, with R = Rx Ry Rz written out there,
// and then converting them, gives the same as converting first and moving with our pose.
TEST(Pose3dtkConversion, CommutesWithMovingPoints) {
  RandomStream random(3);
  for (int k = 0; k < 50; ++k) {
    Pose3dtk p;
    for (int i = 0; i < 3; ++i) {
      p.position_cm[i] = random.uniform(-2000, 2000);
      p.angles_deg[i] = random.uniform(-180, 180);
    }
    const double a = p.angles_deg.x() * kDegree, b = p.angles_deg.y() * kDegree,
                 c = p.angles_deg.z() * kDegree;
    Eigen::Matrix3d rx, ry, rz;
    rx << 1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a);
    ry << std::cos(b), 0, std::sin(b), 0, 1, 0, -std::sin(b), 0, std::cos(b);
    rz << std::cos(c), -std::sin(c), 0, std::sin(c), std::cos(c), 0, 0, 0, 1;
    const Pose ours = poseFrom3dtk(p);
    for (int j = 0; j < 4; ++j) {
      const Eigen::Vector3d point(random.uniform(-900, 900), random.uniform(-900, 900),
                                  random.uniform(-900, 900));
      const Eigen::Vector3d moved_there = rx * ry * rz * point + p.position_cm;
      EXPECT_LT((pointFrom3dtk(moved_there) - ours * pointFrom3dtk(point)).norm(), 1e-11);
    }
  }
}

TEST(Pose3dtkConversion, TurnsAboutTheVerticalTheRightWay) {
  // In their left-handed frame a positive turn about y (up) carries z (forward) to x (right): to the right.
  const Pose pose = poseFrom3dtk({{0, 0, 0}, {0, 90, 0}});
  EXPECT_LT((pose.heading() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(pose.rotation().determinant(), 1.0, 1e-12);
}

TEST(Pose3dtkConversion, ComesBackAlsoAtItsEnds) {
  RandomStream random(5);
  for (int k = 0; k < 50; ++k) {
    const Pose pose = randomPose(random);
    expectSame(poseFrom3dtk(poseTo3dtk(pose)), pose, 1e-10);
    EXPECT_LE(std::abs(poseTo3dtk(pose).angles_deg.y()), 90.0);
  }
  for (const double y : {90.0, -90.0}) {
    const Pose pose = poseFrom3dtk({{1, 2, 3}, {20, y, 35}});
    expectSame(poseFrom3dtk(poseTo3dtk(pose)), pose, 1e-7);
  }
}

TEST(Pose3dtkFile, ReadsBackAndRefusesWhatIsNoPose) {
  const TemporaryFolder folder;
  RandomStream random(9);
  const Pose pose = randomPose(random);
  ASSERT_TRUE(writePose3dtk(folder / "scan000.pose", pose));
  const auto back = readPose3dtk(folder / "scan000.pose");
  ASSERT_TRUE(back) << back.error().what;
  expectSame(*back, pose, 1e-10);
  for (const char* text : {"", "1 2 3 4 5", "1 2 3 4 5 6 7", "1 2 3 4 5 six", "1 2 3 4 5 nan",
                           "1 2 inf 4 5 6", "1e300 0 0 0 0 0", "\x01\xff\x7f"}) {
    const auto bad = readPose3dtk(folder.write("bad.pose", text));
    ASSERT_FALSE(bad) << text;
    EXPECT_NE(bad.error().where.find("bad.pose"), std::string::npos);
  }
}

TEST(Frames3dtk, HoldTheColumnMajorMatrixInTheirFrame) {
  const TemporaryFolder folder;
  const Pose pose = poseFrom3dtk({{100, 200, 300}, {0, 90, 0}});
  ASSERT_TRUE(writeFrames3dtk(folder / "s.frames", pose));
  std::ifstream stream(folder / "s.frames");
  double v[17];
  for (double& x : v) ASSERT_TRUE(stream >> x);
  EXPECT_NEAR(v[12], 100, 1e-9);
  EXPECT_NEAR(v[13], 200, 1e-9);
  EXPECT_NEAR(v[14], 300, 1e-9);
  EXPECT_NEAR(v[2], -1.0, 1e-12);  // R(2,0) of Ry(90)
  EXPECT_NEAR(v[8], 1.0, 1e-12);   // R(0,2)
  EXPECT_EQ(v[16], 2.0);
}

TEST(Poses3dtk, OneFileAScanInAFolderThatIsMade) {
  const TemporaryFolder folder;
  const IndexedPoses poses{{0, Pose()}, {1, Pose::planar(1.5, 2.5, 0.7)}, {1234, Pose::planar(-3, 0, -2)}};
  const auto files = writePoses3dtk(folder / "out/poses", Poses3dtk::PoseFiles, poses);
  ASSERT_TRUE(files) << files.error().what;
  ASSERT_EQ(files->size(), 3U);
  EXPECT_EQ(std::filesystem::path((*files)[1]).filename(), "scan001.pose");
  EXPECT_EQ(std::filesystem::path((*files)[2]).filename(), "scan1234.pose");
  const auto back = readPose3dtk((*files)[1]);
  ASSERT_TRUE(back);
  EXPECT_LT(difference(*back, poses.at(1)).translation_m, 1e-9);
  EXPECT_LT(difference(*back, poses.at(1)).rotation_rad, 1e-7);
  ASSERT_TRUE(writePoses3dtk(folder / "out/frames", Poses3dtk::FramesFiles, poses));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/frames/scan000.frames"));
  folder.write("file", "x");
  EXPECT_FALSE(writePoses3dtk(folder / "file", Poses3dtk::PoseFiles, poses));
}

}  // namespace
}  // namespace tiltmap
