// Real scans by others through the commands: imported, registered, exported.
#include <fstream>
#include <sstream>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/geometry/pose.h"
#include "core/io/pose_file.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

class CliRealData : public ::testing::Test {
 protected:
  json object(std::vector<std::string> words) {
    words.push_back("--json");
    const ProgramRun result = tiltmap(words, folder_.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  static Pose poseOf(const json& pair) {
    const json& t = pair["fixed_from_moving"]["translation_m"];
    const json& q = pair["fixed_from_moving"]["quaternion_xyzw"];
    const auto number = [](const json& list, std::size_t k) { return list[k].get<double>(); };
    return {Eigen::Quaterniond(number(q, 3), number(q, 0), number(q, 1), number(q, 2)),
            Eigen::Vector3d(number(t, 0), number(t, 1), number(t, 2))};
  }
  TemporaryFolder folder_;
};

TEST_F(CliRealData, TiltedSickIndoorsKeepsItsMatrixAndAgreesWithItsPoses) {
  TILTMAP_NEEDS_SHARED_DATA("3dtk_dat");
  const auto data = sharedData("3dtk_dat");
  object({"new", "p.tiltmap"});
  const json added =
      object({"import", "p.tiltmap", (data / "scan000.3d").string(), (data / "scan001.3d").string(),
              (data / "scan002.3d").string(), "--min-range", "0.5", "--max-range", "32"});
  EXPECT_EQ(added["added"], 3);
  EXPECT_TRUE(added["warnings"].is_array());
  const json info = object({"info", "p.tiltmap"});
  ASSERT_EQ(info["scans"].size(), 3U);
  for (const json& scan : info["scans"]) {
    EXPECT_EQ(scan["rows"], 226);
    EXPECT_EQ(scan["columns"], 360);
    EXPECT_GT(scan["valid"].get<int>(), 70000);
  }
  const json registered = object({"register", "p.tiltmap"});
  ASSERT_EQ(registered["pairs"].size(), 2U);
  std::vector<Pose> published;
  for (const char* name : {"scan000.pose", "scan001.pose", "scan002.pose"})
    published.push_back(*readPose3dtk(data / name));
  for (std::size_t i = 0; i < 2; ++i) {
    const PoseDifference off =
        difference(poseOf(registered["pairs"][i]), published[i].inverse() * published[i + 1]);
    EXPECT_LT(off.translation_m, 0.05) << i;
    EXPECT_LT(off.rotation_rad, 0.7 * kDegree) << i;
    EXPECT_TRUE(registered["pairs"][i]["succeeded"].get<bool>());
  }
  EXPECT_EQ(tiltmap({"export", "p.tiltmap", "map.ply"}, folder_.path()).exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(folder_.path() / "map.ply"), 2'000'000U);
}

TEST_F(CliRealData, GarageStationsChainAsTheyRegisterDirectly) {
  TILTMAP_NEEDS_SHARED_DATA("bedkowski_13");
  const auto data = sharedData("bedkowski_13");
  constexpr int kScans = 13;
  // The initial poses are rows of 4 x 4 matrices; the program takes TUM lines.
  std::ifstream poses(data / "initial_poses.txt");
  std::string line;
  IndexedPoses odometry;
  while (std::getline(poses, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name;
    Eigen::Matrix4d m;
    words >> name;
    for (int k = 0; k < 16; ++k) words >> m(k / 4, k % 4);
    odometry.emplace(static_cast<int>(odometry.size()),
                     Pose(Eigen::Matrix3d(m.topLeftCorner<3, 3>()), m.topRightCorner<3, 1>()));
  }
  ASSERT_EQ(odometry.size(), static_cast<std::size_t>(kScans));
  ASSERT_TRUE(writePosesTum(folder_.path() / "odometry.tum", odometry));
  object({"new", "p.tiltmap"});
  std::vector<std::string> words = {"import", "p.tiltmap"};
  for (int i = 0; i < kScans; ++i)
    words.push_back(
        (data / ("scan0" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".pcd")).string());
  words.insert(words.end(), {"--odometry", "odometry.tum"});
  EXPECT_EQ(object(words)["added"], kScans);
  // Re-based on scan 0.
  const json first = object({"poses", "p.tiltmap"})["poses"][0];
  EXPECT_EQ(first["translation_m"], json({0.0, 0.0, 0.0}));

  std::string pairs;
  for (int i = 0; i + 1 < kScans; ++i) pairs += std::to_string(i) + ":" + std::to_string(i + 1) + ",";
  for (int i = 0; i + 2 < kScans; ++i)
    pairs += std::to_string(i) + ":" + std::to_string(i + 2) + (i + 3 < kScans ? "," : "");
  const json registered = object({"register", "p.tiltmap", "--pairs", pairs});
  ASSERT_EQ(registered["pairs"].size(), 23U);
  for (const json& pair : registered["pairs"]) {
    EXPECT_TRUE(pair["succeeded"].get<bool>()) << pair;
    EXPECT_LT(pair["rms_m"].get<double>(), 0.015) << pair;
  }
  for (std::size_t i = 0; i + 2 < kScans; ++i) {
    const Pose chained = poseOf(registered["pairs"][i]) * poseOf(registered["pairs"][i + 1]);
    EXPECT_LT(difference(chained, poseOf(registered["pairs"][kScans - 1 + i])).translation_m, 0.01)
        << "triangle " << i;
  }
}

}  // namespace
}  // namespace tiltmap::test
