// The commands as scripts call them: every key that scripts rely on, and results that are there and right.
#include <cmath>
#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

class Cli : public ::testing::Test {
 protected:
  ProgramRun run(std::vector<std::string> words) { return tiltmap(words, folder_.path()); }
  // Runs with --json, expects success, returns the object.
  json object(std::vector<std::string> words) {
    words.push_back("--json");
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  void simulate(const std::string& experiment, int seed = 1, const std::string& file = "p.tiltmap") {
    ASSERT_EQ(run({"new", file}).exit_code, 0);
    ASSERT_EQ(run({"simulate", file, "--experiment", experiment, "--seed", std::to_string(seed)}).exit_code,
              0);
  }
  TemporaryFolder folder_;
};

TEST_F(Cli, HelpAndVersionNeedNoProject) {
  EXPECT_NE(run({"--version"}).out.find("tiltmap 0."), std::string::npos);
  const ProgramRun help = run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"new", "simulate", "import", "info", "register", "relax", "poses", "evaluate",
                              "export", "parameters", "demo"})
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  EXPECT_NE(run({"register", "--help"}).out.find("--max-distance"), std::string::npos);
}

TEST_F(Cli, NewProjectIsEmptyAndIsNotMadeTwice) {
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  const json info = object({"info", "p.tiltmap"});
  EXPECT_TRUE(info["scans"].empty());
  EXPECT_TRUE(info["links"].empty());
  EXPECT_TRUE(info["stages"].empty());
  EXPECT_EQ(run({"new", "p.tiltmap"}).exit_code, 1);
}

TEST_F(Cli, SimulatedSurveyIsRegisteredAndBetterThanItsOdometry) {
  simulate("exp1");
  const json info = object({"info", "p.tiltmap"});
  ASSERT_EQ(info["scans"].size(), 5U);
  for (const json& scan : info["scans"]) {
    EXPECT_EQ(scan["rows"], 101);
    EXPECT_EQ(scan["columns"], 361);
    EXPECT_EQ(scan["lines"], 101);
    EXPECT_GE(scan["valid"].get<int>(), 20000);
    EXPECT_LE(scan["valid"].get<int>(), 31000);
    EXPECT_NE(scan["source"].get<std::string>().find("exp1"), std::string::npos);
  }
  EXPECT_EQ(info["stages"], json({"truth", "odometry"}));

  const json before = object({"evaluate", "p.tiltmap"});
  const json registered = object({"register", "p.tiltmap"});
  ASSERT_EQ(registered["pairs"].size(), 4U);
  EXPECT_GT(registered["milliseconds"].get<double>(), 0.0);
  for (int i = 0; i < 4; ++i) {
    const json& pair = registered["pairs"][static_cast<std::size_t>(i)];
    EXPECT_EQ(pair["fixed"], i);
    EXPECT_EQ(pair["moving"], i + 1);
    EXPECT_GT(pair["milliseconds"].get<double>(), 0.0);
    EXPECT_GT(pair["iterations"].get<int>(), 1);
    EXPECT_GT(pair["correspondences"].get<int>(), 50);
    EXPECT_GT(pair["rms_m"].get<double>(), 0.0);
    EXPECT_LT(pair["rms_m"].get<double>(), 0.1);
    EXPECT_GT(pair["overlap"].get<double>(), 0.2);
    EXPECT_LE(pair["overlap"].get<double>(), 1.0);
    EXPECT_FALSE(pair["stop_reason"].get<std::string>().empty());
  }
  const json after = object({"evaluate", "p.tiltmap"});
  EXPECT_EQ(before["stage"], "odometry");
  EXPECT_EQ(after["stage"], "pairwise");
  EXPECT_LT(after["rmse_translation_m"].get<double>(), 0.05);
  EXPECT_GT(before["rmse_translation_m"].get<double>(), 5.0 * after["rmse_translation_m"].get<double>());
  ASSERT_EQ(after["stops"].size(), 5U);
  EXPECT_EQ(after["stops"][0]["translation_error_m"], 0.0);
  EXPECT_GT(after["stops"][4]["rotation_error_deg"].get<double>(), 0.0);
  // A stage can be named, and the older one is still there.
  EXPECT_EQ(object({"evaluate", "p.tiltmap", "--stage", "odometry"})["rmse_translation_m"],
            before["rmse_translation_m"]);
  EXPECT_EQ(object({"info", "p.tiltmap"})["links"].size(), 4U);
}

TEST_F(Cli, RegisteringNamedPairsOnly) {
  simulate("exp1");
  const json registered = object({"register", "p.tiltmap", "--pairs", "2:3,0:2"});
  ASSERT_EQ(registered["pairs"].size(), 2U);
  EXPECT_EQ(registered["pairs"][0]["fixed"], 2);
  EXPECT_EQ(registered["pairs"][1]["moving"], 2);
  // Registering again replaces, and the number of threads changes nothing.
  const json again = object({"register", "p.tiltmap", "--pairs", "2:3,0:2", "--threads", "1"});
  EXPECT_EQ(object({"info", "p.tiltmap"})["links"].size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(registered["pairs"][i]["fixed_from_moving"], again["pairs"][i]["fixed_from_moving"]);
}

TEST_F(Cli, ThesisPresetRunsAndParametersReachIt) {
  simulate("exp1");
  const json thesis = object({"register", "p.tiltmap", "--preset", "thesis"});
  for (const json& pair : thesis["pairs"]) EXPECT_LE(pair["iterations"].get<int>(), 100);
  const json limited = object({"register", "p.tiltmap", "--preset", "thesis", "--max-iterations", "3"});
  for (const json& pair : limited["pairs"]) EXPECT_LE(pair["iterations"].get<int>(), 3);
}

TEST_F(Cli, PosesInEveryFormat) {
  simulate("exp1");
  const std::string table = run({"poses", "p.tiltmap"}).out;
  EXPECT_NE(table.find("4.000"), std::string::npos) << table;
  const std::string tum = run({"poses", "p.tiltmap", "--format", "tum"}).out;
  EXPECT_EQ(tum.substr(0, 2), "0 ");
  EXPECT_EQ(std::count(tum.begin(), tum.end(), '\n'), 5);
  EXPECT_NE(run({"poses", "p.tiltmap", "--format", "csv"}).out.find("index,x_m"), std::string::npos);
  // The truth of stop 1 has the thesis' result with a negative x.
  const json truth = object({"poses", "p.tiltmap", "--stage", "truth"});
  EXPECT_NEAR(truth["poses"][1]["heading"][0].get<double>(), -0.603, 0.01);
  // What was printed as TUM serves as truth of itself.
  writeFile(folder_.path() / "same.tum", tum);
  EXPECT_NEAR(object({"evaluate", "p.tiltmap", "--truth", "same.tum"})["rmse_translation_m"].get<double>(),
              0.0, 1e-12);
}

TEST_F(Cli, PosesForOtherPrograms) {
  simulate("exp1");
  std::istringstream kitti(run({"poses", "p.tiltmap", "--format", "kitti"}).out);
  std::vector<double> numbers;
  for (double v = 0.0; kitti >> v;) numbers.push_back(v);
  EXPECT_EQ(numbers.size(), 5U * 12U);
  EXPECT_EQ(numbers[0], 1.0);
  ASSERT_EQ(run({"poses", "p.tiltmap", "--format", "tum", "--out", "p.tum"}).exit_code, 0);
  EXPECT_EQ(fileText(folder_.path() / "p.tum"), run({"poses", "p.tiltmap", "--format", "tum"}).out);
  EXPECT_EQ(object({"poses", "p.tiltmap", "--format", "pose", "--out", "poses"})["files"].size(), 5U);
  const json listed = object({"poses", "p.tiltmap"})["poses"][4]["translation_m"];
  std::istringstream pose(fileText(folder_.path() / "poses/scan004.pose"));
  double x = 0.0, y = 0.0, z = 0.0;
  ASSERT_TRUE(pose >> x >> y >> z);
  // Left-handed, y up, centimetres.
  EXPECT_NEAR(x, 100.0 * listed[0].get<double>(), 1e-6);
  EXPECT_NEAR(y, 100.0 * listed[2].get<double>(), 1e-6);
  EXPECT_NEAR(z, 100.0 * listed[1].get<double>(), 1e-6);
  ASSERT_EQ(run({"poses", "p.tiltmap", "--format", "frames", "--out", "poses"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "poses/scan000.frames"));
  EXPECT_EQ(run({"poses", "p.tiltmap", "--format", "pose"}).exit_code, 2);
  EXPECT_EQ(run({"poses", "p.tiltmap", "--format", "tum", "--out", "no/folder/p.tum"}).exit_code, 1);
}

TEST_F(Cli, ExportOneFileAScanForThreeDtk) {
  simulate("exp1");
  const json report = object({"export", "p.tiltmap", "scan.3d", "--per-scan"});
  EXPECT_EQ(report["files"].size(), 10U) << "five clouds and their poses";
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "scan004.pose"));
  ASSERT_EQ(run({"new", "back.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"import", "back.tiltmap", "scan000.3d", "scan001.3d"}).exit_code, 0);
  const json info = object({"info", "p.tiltmap"}), back = object({"info", "back.tiltmap"});
  for (std::size_t i = 0; i < 2; ++i)
    for (const char* key : {"rows", "columns", "valid"})
      EXPECT_EQ(info["scans"][i][key], back["scans"][i][key]);
  const ProgramRun merged = run({"export", "p.tiltmap", "all.3d"});
  EXPECT_EQ(merged.exit_code, 1);
  EXPECT_NE(merged.err.find("--per-scan"), std::string::npos) << merged.err;
}

TEST_F(Cli, SameSeedSameSurveyOtherSeedAnother) {
  simulate("exp1", 3, "a.tiltmap");
  simulate("exp1", 3, "b.tiltmap");
  simulate("exp1", 4, "c.tiltmap");
  const auto valid = [&](const std::string& file) {
    std::vector<int> list;
    const json info = object({"info", file});
    for (const json& scan : info["scans"]) list.push_back(scan["valid"]);
    EXPECT_EQ(list.size(), 5U);
    return list;
  };
  EXPECT_EQ(valid("a.tiltmap"), valid("b.tiltmap"));
  EXPECT_NE(valid("a.tiltmap"), valid("c.tiltmap"));
}

TEST_F(Cli, ExportHoldsEveryPointOnceAndReducedHoldsFewer) {
  simulate("exp1");
  std::size_t valid = 0;
  const json info = object({"info", "p.tiltmap"});
  for (const json& scan : info["scans"]) valid += scan["valid"].get<std::size_t>();
  ASSERT_EQ(run({"export", "p.tiltmap", "map.xyz"}).exit_code, 0);
  const std::string raw = fileText(folder_.path() / "map.xyz");
  EXPECT_EQ(static_cast<std::size_t>(std::count(raw.begin(), raw.end(), '\n')), valid);
  ASSERT_EQ(run({"export", "p.tiltmap", "small.xyz", "--reduced", "--scans", "0-1"}).exit_code, 0);
  const std::string reduced = fileText(folder_.path() / "small.xyz");
  const auto lines = std::count(reduced.begin(), reduced.end(), '\n');
  EXPECT_GT(lines, 8000);
  EXPECT_LT(lines, 25000);
  for (const std::string name : {"map.ply", "map.pcd"}) {
    ASSERT_EQ(run({"export", "p.tiltmap", name, "--stage", "truth"}).exit_code, 0);
    EXPECT_NE(fileText(folder_.path() / name).find(std::to_string(valid)), std::string::npos) << name;
  }
}

TEST_F(Cli, ParametersAreListedWithEverything) {
  const std::string text = run({"parameters", "register"}).out;
  for (const char* word : {"--max-distance", "Source:", "default", "In preset thesis"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
  const json all = object({"parameters"});
  std::size_t count = 0;
  for (const json& operation : all["operations"])
    for (const json& parameter : operation["parameters"]) {
      ++count;
      for (const char* key : {"name", "unit", "default", "help", "source", "kind"})
        EXPECT_TRUE(parameter.contains(key)) << parameter;
      EXPECT_FALSE(parameter["help"].get<std::string>().empty()) << parameter;
      EXPECT_FALSE(parameter["source"].get<std::string>().empty()) << parameter;
    }
  EXPECT_GT(count, 20U);
  EXPECT_EQ(run({"parameters", "registre"}).exit_code, 2);
}

TEST_F(Cli, RelaxationHasItsKeysAndIsTheLatestStage) {
  simulate("exp1");
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const json before = object({"evaluate", "p.tiltmap"});
  const json registered = object({"info", "p.tiltmap"});
  const json relaxed = object({"relax", "p.tiltmap", "--threads", "2"});
  std::vector<std::string> keys;
  for (const auto& entry : relaxed.items()) keys.push_back(entry.key());
  EXPECT_EQ(keys, (std::vector<std::string>{"added", "milliseconds", "moved", "unlinked", "warnings"}));
  EXPECT_GT(relaxed["milliseconds"].get<double>(), 0.0);
  EXPECT_TRUE(relaxed["unlinked"].empty());
  EXPECT_TRUE(relaxed["warnings"].empty());
  ASSERT_EQ(relaxed["moved"].size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const json& moved = relaxed["moved"][i];
    EXPECT_EQ(moved.size(), 3U);
    EXPECT_EQ(moved["scan"], i);
    EXPECT_EQ(moved["translation_m"].get<double>() > 0.0, i > 0) << moved;
    EXPECT_EQ(moved["rotation_deg"].get<double>() > 0.0, i > 0) << moved;
  }
  const json after = object({"evaluate", "p.tiltmap"});
  EXPECT_EQ(after["stage"], "relaxed");
  EXPECT_LT(after["rmse_translation_m"].get<double>(), 0.010);
  EXPECT_LT(after["rmse_rotation_deg"].get<double>(), 0.05);
  EXPECT_LT(after["rmse_translation_m"].get<double>(), 0.01);
  EXPECT_NE(after["rmse_translation_m"], before["rmse_translation_m"]);

  // Every command takes it as the latest.
  const json poses = object({"poses", "p.tiltmap"});
  EXPECT_EQ(poses["stage"], "relaxed");
  EXPECT_EQ(poses, object({"poses", "p.tiltmap", "--stage", "relaxed"}));
  EXPECT_NE(poses["poses"], object({"poses", "p.tiltmap", "--stage", "pairwise"})["poses"]);
  ASSERT_EQ(run({"export", "p.tiltmap", "latest.xyz"}).exit_code, 0);
  ASSERT_EQ(run({"export", "p.tiltmap", "relaxed.xyz", "--stage", "relaxed"}).exit_code, 0);
  ASSERT_EQ(run({"export", "p.tiltmap", "pairwise.xyz", "--stage", "pairwise"}).exit_code, 0);
  EXPECT_EQ(fileText(folder_.path() / "latest.xyz"), fileText(folder_.path() / "relaxed.xyz"));
  EXPECT_NE(fileText(folder_.path() / "latest.xyz"), fileText(folder_.path() / "pairwise.xyz"));
  const json info = object({"info", "p.tiltmap"});
  EXPECT_EQ(info["stages"], json({"truth", "odometry", "pairwise", "relaxed"}));
  EXPECT_GT(info["links"].size(), 4U);
  for (const json& link : info["links"]) EXPECT_EQ(link["origin"], "automatic");

  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(object({"info", "p.tiltmap"}), registered);
  ASSERT_EQ(run({"redo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(object({"info", "p.tiltmap"}), info);
  EXPECT_EQ(object({"poses", "p.tiltmap"}), poses);
}

TEST_F(Cli, RelaxationKeepsPinsAndRecordsItsSteps) {
  simulate("exp1");
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const json pinned = object({"relax", "p.tiltmap", "--pin", "0,3"});
  EXPECT_EQ(pinned["moved"][3]["translation_m"], 0.0);
  EXPECT_EQ(pinned["moved"][3]["rotation_deg"], 0.0);
  EXPECT_GT(pinned["moved"][2]["translation_m"].get<double>(), 0.0);

  const json thesis = object({"relax", "p.tiltmap", "--preset", "thesis", "--record"});
  std::map<std::string, int> count;
  for (const json& event : thesis["events"]) ++count[event["event"].get<std::string>()];
  EXPECT_EQ(count["activated"], 5);
  EXPECT_GE(count["queued"], 4);
  EXPECT_GE(count["aligned"], 4);
  EXPECT_EQ(count["moved by"], count["aligned"]);
  EXPECT_EQ(count["finished"], 1);
  const std::string told = run({"relax", "p.tiltmap", "--preset", "thesis", "--record"}).out;
  EXPECT_NE(told.find("activated"), std::string::npos) << told;
  EXPECT_NE(told.find("finished"), std::string::npos) << told;
}

TEST_F(Cli, RelaxationReportsAScanThatNothingLinks) {
  simulate("exp1");
  // A lump a few metres off and far above whatever the stops have seen.
  std::string points;
  for (int i = 0; i < 400; ++i)
    points += std::to_string(0.01 * (i % 20)) + " " + std::to_string(0.01 * (i / 20)) + " 500\n";
  writeFile(folder_.path() / "lump.xyz", points);
  ASSERT_EQ(run({"import", "p.tiltmap", "lump.xyz"}).exit_code, 0);
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const json before = object({"poses", "p.tiltmap"});
  for (const std::string preset : {"default", "thesis"}) {
    const json relaxed = object({"relax", "p.tiltmap", "--preset", preset});
    EXPECT_EQ(relaxed["unlinked"], json({5})) << preset;
    EXPECT_EQ(relaxed["moved"][5]["translation_m"], 0.0);
    EXPECT_FALSE(relaxed["warnings"].empty());
    EXPECT_EQ(object({"poses", "p.tiltmap"})["poses"][5], before["poses"][5]);
  }
}

TEST_F(Cli, UndoRedoAndHistorySurviveReopening) {
  simulate("exp1");
  const json simulated = object({"info", "p.tiltmap"});
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const json registered = object({"info", "p.tiltmap"});
  EXPECT_NE(simulated, registered);
  EXPECT_EQ(object({"history", "p.tiltmap"})["history"].size(), 2U);
  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(object({"info", "p.tiltmap"}), simulated);
  EXPECT_EQ(object({"history", "p.tiltmap"})["history"][1]["state"], "undone");
  ASSERT_EQ(run({"redo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(object({"info", "p.tiltmap"}), registered);
  EXPECT_EQ(run({"redo", "p.tiltmap"}).exit_code, 1);
  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  EXPECT_TRUE(object({"info", "p.tiltmap"})["scans"].empty());
  EXPECT_EQ(run({"undo", "p.tiltmap"}).exit_code, 1);
}

TEST_F(Cli, DemoMakesMapPictureAndReport) {
  const ProgramRun demo = run({"demo", "--out", "demo", "--experiment", "exp1"});
  ASSERT_EQ(demo.exit_code, 0) << demo.err;
  std::vector<std::string> lines;
  std::istringstream out(demo.out);
  for (std::string line; std::getline(out, line);) lines.push_back(line);
  ASSERT_GE(lines.size(), 3U);
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"map: ", "ply"}, {"picture: ", "PNG"}, {"report: ", "<html"}};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string& line = lines[lines.size() - 3 + i];
    ASSERT_TRUE(line.starts_with(expected[i].first)) << line;
    const std::string head = fileText(folder_.path() / line.substr(expected[i].first.size())).substr(0, 400);
    EXPECT_NE(head.find(expected[i].second), std::string::npos) << line;
  }
  const std::string report = fileText(folder_.path() / "demo/report.html");
  EXPECT_NE(report.find("Stops after global relaxation"), std::string::npos);
  EXPECT_NE(report.find("<h2>Relaxation</h2>"), std::string::npos);
  EXPECT_NE(demo.err.find("relaxed"), std::string::npos) << demo.err;
  EXPECT_EQ(object({"info", "demo/demo.tiltmap"})["stages"],
            json({"truth", "odometry", "pairwise", "relaxed"}));
  // A second demo replaces its own files, but never a project of somebody's.
  EXPECT_EQ(run({"demo", "--out", "demo", "--experiment", "exp1"}).exit_code, 0);
  std::filesystem::create_directory(folder_.path() / "mine");
  ASSERT_EQ(run({"new", "mine/demo.tiltmap"}).exit_code, 0);
  EXPECT_EQ(run({"demo", "--out", "mine", "--experiment", "exp1"}).exit_code, 1);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "mine/demo.tiltmap"));
}

}  // namespace
}  // namespace tiltmap::test
