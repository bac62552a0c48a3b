// Wrong words, bad files, projects that are none: a clear message, the right exit code, and nothing lost.
#include <csignal>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/project.h"
#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

class CliErrors : public ::testing::Test {
 protected:
  ProgramRun run(std::vector<std::string> words) { return tiltmap(words, folder_.path()); }
  // Expects the exit code and every part of a good message; returns the error object of --json.
  void refused(std::vector<std::string> words, int exit_code, const std::string& mentions) {
    const ProgramRun plain = run(words);
    EXPECT_EQ(plain.exit_code, exit_code) << plain.err;
    EXPECT_TRUE(plain.out.empty()) << plain.out;
    EXPECT_NE(plain.err.find(mentions), std::string::npos) << plain.err;
    EXPECT_NE(plain.err.find("what to do:"), std::string::npos) << plain.err;
    words.push_back("--json");
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, exit_code);
    const json object = json::parse(result.out);
    for (const char* key : {"what", "where", "remedy"})
      EXPECT_TRUE(object["error"].contains(key)) << result.out;
    EXPECT_FALSE(object["error"]["what"].get<std::string>().empty());
  }
  std::string info() { return run({"info", "p.tiltmap", "--json"}).out; }
  TemporaryFolder folder_;
};

TEST_F(CliErrors, WrongUsageIsTwoAndNamesTheNearest) {
  refused({"regsiter", "p.tiltmap"}, 2, "register");
  refused({"register"}, 2, "project");
  refused({"info", "p.tiltmap", "--jsn"}, 2, "--json");
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  refused({"register", "p.tiltmap", "--max-distanc", "3"}, 2, "--max-distance");
  refused({"register", "p.tiltmap", "--max-distance", "far"}, 2, "max-distance");
  refused({"register", "p.tiltmap", "--max-distance", "-1"}, 2, "max-distance");
  refused({"register", "p.tiltmap", "--motion", "magic"}, 2, "svd");
  refused({"register", "p.tiltmap", "--preset", "thessis"}, 2, "thesis");
  refused({"relax", "p.tiltmap", "--max-visit", "3"}, 2, "--max-visits");
  refused({"relax", "p.tiltmap", "--preset", "thessis"}, 2, "thesis");
  refused({"relax", "p.tiltmap", "--threads", "-1"}, 2, "threads");
  refused({"simulate", "p.tiltmap", "--experiment", "exp9"}, 2, "exp1");
  refused({"poses", "p.tiltmap", "--format", "xml"}, 2, "tum");
  refused({"export", "p.tiltmap", "o.ply", "--raw", "--reduced"}, 2, "--raw");
}

TEST_F(CliErrors, FailuresAreOneAndSayWhatToDo) {
  refused({"info", "missing.tiltmap"}, 1, "missing.tiltmap");
  writeFile(folder_.path() / "garbage.tiltmap", std::string(5000, 'x'));
  refused({"info", "garbage.tiltmap"}, 1, "garbage.tiltmap");
  EXPECT_EQ(fileText(folder_.path() / "garbage.tiltmap"), std::string(5000, 'x'));
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  refused({"new", "p.tiltmap"}, 1, "p.tiltmap");
  refused({"new", "no/such/folder/p.tiltmap"}, 1, "no/such/folder");
  refused({"register", "p.tiltmap"}, 1, "two scans");
  refused({"relax", "p.tiltmap"}, 1, "two scans");
  refused({"relax", "missing.tiltmap"}, 1, "missing.tiltmap");
  refused({"export", "p.tiltmap", "map.ply"}, 1, "no scans");
  refused({"evaluate", "p.tiltmap"}, 1, "");
  refused({"import", "p.tiltmap", "missing.pcd"}, 1, "missing.pcd");
}

TEST_F(CliErrors, ARefusedCommandLeavesTheProjectAsItWas) {
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "exp1"}).exit_code, 0);
  const std::string before = info();
  writeFile(folder_.path() / "good.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 6\n");
  writeFile(folder_.path() / "short.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n1 2 3\n4 5 6\n");
  refused({"import", "p.tiltmap", "good.pcd", "short.pcd"}, 1, "short.pcd");
  refused({"import", "p.tiltmap", "good.pcd", "--odometry", "none.tum"}, 1, "none.tum");
  refused({"import", "p.tiltmap", "good.pcd", "--min-range", "5", "--max-range", "2"}, 1, "range");
  refused({"register", "p.tiltmap", "--pairs", "0:9"}, 1, "0:9");
  refused({"register", "p.tiltmap", "--pairs", "1:1"}, 1, "1:1");
  refused({"register", "p.tiltmap", "--pairs", "one"}, 1, "one");
  refused({"relax", "p.tiltmap", "--pin", "0,9"}, 1, "9");
  refused({"relax", "p.tiltmap", "--pin", "one"}, 1, "one");
  refused({"relax", "p.tiltmap", "--preset", "thesis", "--method", "joint"}, 1, "closed forms");
  refused({"simulate", "p.tiltmap", "--experiment", "exp1"}, 1, "already");
  refused({"export", "p.tiltmap", "map.stl"}, 1, "stl");
  refused({"export", "p.tiltmap", "map.ply", "--stage", "relaxed"}, 1, "relaxed");
  refused({"export", "p.tiltmap", "map.ply", "--scans", "3-12"}, 1, "3-12");
  refused({"export", "p.tiltmap", "no/folder/map.ply"}, 1, "no/folder");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "map.ply"));
  EXPECT_EQ(info(), before);
}

TEST_F(CliErrors, WhileAnotherWritesReadingWorksAndWritingIsRefused) {
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "exp1"}).exit_code, 0);
  const auto writer = Project::open(folder_.path() / "p.tiltmap", Access::ReadWrite);
  ASSERT_TRUE(writer);
  ASSERT_TRUE((*writer)->apply(renameEdit((*writer)->snapshot()->scans()[0].id, "by the writer")));
  const std::string before = info();
  EXPECT_NE(before.find("by the writer"), std::string::npos);
  for (const auto& words : std::vector<std::vector<std::string>>{{"rename", "p.tiltmap", "0", "x"},
                                                                 {"register", "p.tiltmap"},
                                                                 {"delete", "p.tiltmap", "0"},
                                                                 {"undo", "p.tiltmap"},
                                                                 {"compact", "p.tiltmap"}})
    refused(words, 1, "elsewhere");
  for (const auto& words : std::vector<std::vector<std::string>>{{"poses", "p.tiltmap"},
                                                                 {"history", "p.tiltmap"},
                                                                 {"verify", "p.tiltmap"},
                                                                 {"copy", "p.tiltmap", "copy.tiltmap"},
                                                                 {"export", "p.tiltmap", "map.ply"}})
    EXPECT_EQ(run(words).exit_code, 0) << words[0];
  EXPECT_EQ(info(), before);
}

// One writing and one reading command on each kind of file that is no project of ours to change.
TEST_F(CliErrors, FilesThatAreNoProjectsAreLeftAsTheyAre) {
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  const std::string whole = fileText(folder_.path() / "p.tiltmap");
  std::string newer = whole, foreign = whole;
  newer[63] = 99;     // user_version, the last of its four bytes
  foreign[71] = 'X';  // application_id
  const std::vector<std::pair<std::string, std::string>> files = {
      {"empty", ""},
      {"garbage", std::string(70000, 'x')},
      {"truncated", whole.substr(0, whole.size() / 2)},
      {"newer", newer},
      {"foreign", foreign},
      {"header", whole.substr(0, 50)}};
  for (const auto& [name, bytes] : files) {
    const std::string file = name + ".tiltmap";
    writeFile(folder_.path() / file, bytes);
    refused({"info", file}, 1, file);
    refused({"survey", file, "--site", "x"}, 1, file);
    refused({"compact", file}, 1, file);
    refused({"new", file}, 1, file);
    refused({"copy", file, name + "2.tiltmap"}, 1, file);
    EXPECT_EQ(fileText(folder_.path() / file), bytes) << name;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / (name + "2.tiltmap")));
  }
}

TEST_F(CliErrors, QuietSaysNothingButResults) {
  ASSERT_EQ(run({"new", "p.tiltmap", "--quiet"}).exit_code, 0);
  const ProgramRun result = run({"simulate", "p.tiltmap", "--experiment", "exp1", "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.err.empty()) << result.err;
}

TEST_F(CliErrors, InterruptedRelaxationChangesNothing) {
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "exp2fixed"}).exit_code, 0);
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const std::string before = info();
  // The thesis' method takes seconds, so the signal comes in the middle.
  const pid_t child = startTiltmap({"relax", "p.tiltmap", "--preset", "thesis"}, folder_.path());
  usleep(400'000);
  ASSERT_EQ(kill(child, SIGINT), 0);
  const ProgramRun stopped = waitForTiltmap(child, folder_.path());
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  EXPECT_NE(stopped.err.find("cancelled"), std::string::npos) << stopped.err;
  EXPECT_EQ(info(), before);
}

TEST_F(CliErrors, InterruptStopsCleanly) {
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  const std::string before = info();
  const pid_t child =
      startTiltmap({"simulate", "p.tiltmap", "--experiment", "survey", "--stops", "400"}, folder_.path());
  usleep(700'000);
  ASSERT_EQ(kill(child, SIGINT), 0);
  const ProgramRun stopped = waitForTiltmap(child, folder_.path());
  EXPECT_EQ(stopped.exit_code, 1) << stopped.err;
  EXPECT_NE(stopped.err.find("cancelled"), std::string::npos) << stopped.err;
  EXPECT_EQ(info(), before);
}

}  // namespace
}  // namespace tiltmap::test
