// The commands that change or copy a survey: what they do, that it can be undone, and what they refuse.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

class CliEdits : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
    for (const char* name : {"a.xyz", "b.xyz", "c.xyz"})
      writeFile(folder_.path() / name, "1 2 3\n4 5 6\n7 8 9\n");
    writeFile(folder_.path() / "o.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
    ASSERT_EQ(run({"import", "p.tiltmap", "a.xyz", "b.xyz", "c.xyz", "--odometry", "o.tum"}).exit_code, 0);
  }
  ProgramRun run(const std::vector<std::string>& words) { return tiltmap(words, folder_.path()); }
  json object(std::vector<std::string> words) {
    words.push_back("--json");
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  std::string info(const std::string& project = "p.tiltmap") { return run({"info", project, "--json"}).out; }
  std::string state() { return info() + run({"poses", "p.tiltmap", "--json"}).out; }
  // An edit that can be undone and redone; returns what it printed.
  json edit(const std::vector<std::string>& words) {
    const std::string before = state();
    const json done = object(words);
    EXPECT_FALSE(done["done"].get<std::string>().empty());
    EXPECT_TRUE(done["warnings"].is_array());
    const std::string after = state();
    EXPECT_NE(after, before);
    EXPECT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
    EXPECT_EQ(state(), before);
    EXPECT_EQ(run({"redo", "p.tiltmap"}).exit_code, 0);
    EXPECT_EQ(state(), after);
    return done;
  }
  // A full message, the exit code, and `info --json` byte for byte.
  void refused(std::vector<std::string> words, int exit_code, const std::string& mentions) {
    const std::string before = info();
    words.push_back("--json");
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, exit_code) << result.out << result.err;
    const json error = json::parse(result.out)["error"];
    for (const char* key : {"what", "where", "remedy"})
      EXPECT_FALSE(error[key].get<std::string>().empty()) << error;
    EXPECT_NE(result.err.find(mentions), std::string::npos) << result.err;
    EXPECT_EQ(info(), before);
  }
  TemporaryFolder folder_;
};

TEST_F(CliEdits, Colour) {
  edit({"colour", "p.tiltmap", "1", "#ff8800"});
  EXPECT_EQ(json::parse(info())["scans"][1]["colour"], "#ff8800");
  EXPECT_TRUE(json::parse(info())["scans"][0]["colour"].is_null());
  edit({"colour", "p.tiltmap", "1", "default"});
  EXPECT_TRUE(json::parse(info())["scans"][1]["colour"].is_null());
  refused({"colour", "p.tiltmap", "1", "orange"}, 1, "orange");
  refused({"colour", "p.tiltmap", "9", "#ff8800"}, 1, "9");
}

TEST_F(CliEdits, RenameAndNote) {
  edit({"rename", "p.tiltmap", "1", "by the gate"});
  EXPECT_EQ(object({"info", "p.tiltmap"})["scans"][1]["name"], "by the gate");
  edit({"note", "p.tiltmap", "2", "rain; the left wheel slipped"});
  EXPECT_EQ(run({"note", "p.tiltmap", "2"}).out, "rain; the left wheel slipped\n");
  EXPECT_EQ(object({"note", "p.tiltmap", "2"})["note"], "rain; the left wheel slipped");
  edit({"note", "p.tiltmap", "2", ""});
  EXPECT_EQ(run({"note", "p.tiltmap", "2"}).out, "");
  refused({"rename", "p.tiltmap", "3", "x"}, 1, "3");
  refused({"rename", "p.tiltmap", "-1", "x"}, 1, "-1");
  refused({"rename", "p.tiltmap", "0", "  "}, 1, "empty");
  refused({"rename", "p.tiltmap", "one", "x"}, 2, "one");
  refused({"note", "p.tiltmap", "9"}, 1, "9");
}

TEST_F(CliEdits, SurveyData) {
  edit({"survey", "p.tiltmap", "--site", "Old mill", "--operator", "E. Example"});
  edit({"survey", "p.tiltmap", "--date", "2031-04-05", "--device", "LMS-291"});
  const json survey = object({"survey", "p.tiltmap"});
  EXPECT_EQ(
      survey,
      json(
          {{"site", "Old mill"}, {"operator", "E. Example"}, {"device", "LMS-291"}, {"date", "2031-04-05"}}));
  EXPECT_NE(run({"survey", "p.tiltmap"}).out.find("Old mill"), std::string::npos);
  edit({"survey", "p.tiltmap", "--site", ""});
  EXPECT_EQ(object({"survey", "p.tiltmap"})["site"], "");
  refused({"survey", "p.tiltmap", "--sit", "x"}, 2, "--site");
}

TEST_F(CliEdits, DeleteAndRebase) {
  edit({"rebase", "p.tiltmap", "2"});
  EXPECT_EQ(object({"poses", "p.tiltmap"})["poses"][0]["translation_m"], json({-2.0, 0.0, 0.0}));
  edit({"delete", "p.tiltmap", "0,2"});
  const json left = object({"info", "p.tiltmap"})["scans"];
  ASSERT_EQ(left.size(), 1U);
  EXPECT_NE(left[0]["source"].get<std::string>().find("b.xyz"), std::string::npos);
  refused({"delete", "p.tiltmap", "1"}, 1, "1");
  refused({"delete", "p.tiltmap", "all"}, 1, "all");
  refused({"rebase", "p.tiltmap", "7"}, 1, "7");
}

TEST_F(CliEdits, PhotographsGoInAndComeOutByteForByte) {
  const std::string jpeg = "\xFF\xD8\xFF\xE0 any bytes \x01\x02\n\r end";
  writeFile(folder_.path() / "gate.jpg", jpeg);
  edit({"photo", "add", "p.tiltmap", "1", "gate.jpg", "--caption", "The gate"});
  const json list = object({"photo", "list", "p.tiltmap"})["photographs"];
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0]["scan"], 1);
  EXPECT_EQ(list[0]["caption"], "The gate");
  EXPECT_EQ(list[0]["media_type"], "image/jpeg");
  EXPECT_EQ(list[0]["bytes"], jpeg.size());
  EXPECT_NE(run({"photo", "list", "p.tiltmap"}).out.find("The gate"), std::string::npos);
  const std::string id = std::to_string(list[0]["id"].get<int>());
  // Kept in the project, so the file may go.
  std::filesystem::remove(folder_.path() / "gate.jpg");
  ASSERT_EQ(run({"photo", "save", "p.tiltmap", id, "out.jpg"}).exit_code, 0);
  EXPECT_EQ(fileText(folder_.path() / "out.jpg"), jpeg);
  edit({"photo", "add", "p.tiltmap", "0", "out.jpg", "--outside"});
  EXPECT_EQ(object({"photo", "list", "p.tiltmap"})["photographs"][0]["bytes"], 0);
  edit({"photo", "remove", "p.tiltmap", id});
  EXPECT_EQ(object({"photo", "list", "p.tiltmap"})["photographs"].size(), 1U);

  refused({"photo", "save", "p.tiltmap", id, "gone.jpg"}, 1, id);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "gone.jpg"));
  // A picture or a list never takes a project's place.
  const std::string other =
      std::to_string(object({"photo", "list", "p.tiltmap"})["photographs"][0]["id"].get<int>());
  std::filesystem::create_symlink("p.tiltmap", folder_.path() / "link.jpg");
  for (const char* name : {"p.tiltmap", "new.tiltmap", "p.tiltmap-wal", "link.jpg"}) {
    refused({"photo", "save", "p.tiltmap", other, name}, 1, name);
    refused({"poses", "p.tiltmap", "--format", "tum", "--out", name}, 1, name);
  }
  refused({"photo", "add", "p.tiltmap", "0", "a.xyz"}, 1, "not a picture");
  refused({"photo", "add", "p.tiltmap", "0", "none.jpg"}, 1, "none.jpg");
  refused({"photo", "add", "p.tiltmap", "5", "out.jpg"}, 1, "5");
  refused({"photo", "remove", "p.tiltmap", "77"}, 1, "77");
  refused({"photo", "ad", "p.tiltmap", "0", "out.jpg"}, 2, "add");
  refused({"photo"}, 2, "photo --help");
}

TEST_F(CliEdits, LinksAreDisabledEnabledAndAccepted) {
  ASSERT_EQ(run({"new", "s.tiltmap"}).exit_code, 0);
  std::filesystem::remove(folder_.path() / "p.tiltmap");
  ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "exp1"}).exit_code, 0);
  ASSERT_EQ(run({"register", "p.tiltmap", "--pairs", "0:1,1:2"}).exit_code, 0);
  const auto links = [&] { return object({"link", "list", "p.tiltmap"})["links"]; };
  ASSERT_EQ(links().size(), 2U);
  const std::string first = std::to_string(links()[0]["id"].get<int>());
  EXPECT_EQ(links()[0]["state"], "active");
  EXPECT_EQ(links()[0]["origin"], "automatic");
  edit({"link", "disable", "p.tiltmap", first});
  EXPECT_EQ(links()[0]["state"], "disabled");
  EXPECT_NE(run({"link", "list", "p.tiltmap"}).out.find("disabled"), std::string::npos);
  edit({"link", "enable", "p.tiltmap", first});
  EXPECT_EQ(links()[0]["state"], "active");
  edit({"link", "accept", "p.tiltmap", first});
  const auto byHand = [&] {
    std::size_t count = 0;
    for (const json& link : links()) count += link["origin"] == "by-hand" ? 1U : 0U;
    return count;
  };
  EXPECT_EQ(links().size(), 2U);
  EXPECT_EQ(byHand(), 1U);
  // Registering again replaces its own, not the one a person vouched for.
  ASSERT_EQ(run({"register", "p.tiltmap", "--pairs", "0:1,1:2"}).exit_code, 0);
  EXPECT_EQ(byHand(), 1U);
  EXPECT_EQ(links().size(), 3U);
  refused({"link", "disable", "p.tiltmap", "999"}, 1, "999");
  refused({"link", "accept", "p.tiltmap", first}, 1, first);
  refused({"link", "disable", "p.tiltmap", "first"}, 2, "first");
}

TEST_F(CliEdits, CopyIsWholeAndReplacesNothing) {
  ASSERT_EQ(run({"rename", "p.tiltmap", "0", "start"}).exit_code, 0);
  EXPECT_EQ(object({"copy", "p.tiltmap", "copy.tiltmap"})["project"], "copy.tiltmap");
  EXPECT_EQ(info("copy.tiltmap"), info());
  // With its history.
  ASSERT_EQ(run({"undo", "copy.tiltmap"}).exit_code, 0);
  EXPECT_NE(info("copy.tiltmap"), info());
  const std::string bytes = fileText(folder_.path() / "copy.tiltmap");
  refused({"copy", "p.tiltmap", "copy.tiltmap"}, 1, "copy.tiltmap");
  EXPECT_EQ(fileText(folder_.path() / "copy.tiltmap"), bytes);
  refused({"copy", "p.tiltmap", "no/folder/copy.tiltmap"}, 1, "no/folder");
}

TEST_F(CliEdits, CompactDropsDeletedStopsAndUndoEnds) {
  ASSERT_EQ(run({"delete", "p.tiltmap", "1"}).exit_code, 0);
  const std::string before = info();
  const json report = object({"compact", "p.tiltmap"});
  EXPECT_EQ(report["matrices_dropped"], 1);
  EXPECT_LE(report["bytes_after"].get<long long>(), report["bytes_before"].get<long long>());
  EXPECT_EQ(info(), before);
  refused({"undo", "p.tiltmap"}, 1, "undo");
  EXPECT_EQ(object({"verify", "p.tiltmap"}), json({{"whole", true}, {"scans", 2}}));
}

TEST_F(CliEdits, VerifyFindsDamage) {
  std::string bytes = fileText(folder_.path() / "p.tiltmap");
  ASSERT_GT(bytes.size(), 5U * 16384U);
  for (std::size_t i = 16384; i < 5U * 16384U; ++i) bytes[i] = 'x';
  writeFile(folder_.path() / "bad.tiltmap", bytes);
  const ProgramRun result = run({"verify", "bad.tiltmap"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("damaged"), std::string::npos) << result.err;
  EXPECT_EQ(fileText(folder_.path() / "bad.tiltmap"), bytes);
}

TEST_F(CliEdits, MergeAppendsTheOtherWhereItStands) {
  ASSERT_EQ(run({"new", "other.tiltmap"}).exit_code, 0);
  writeFile(folder_.path() / "far.tum", "0 10 0 0 0 0 0 1\n1 11 0 0 0 0 0 1\n");
  ASSERT_EQ(run({"import", "other.tiltmap", "a.xyz", "b.xyz", "--odometry", "far.tum"}).exit_code, 0);
  ASSERT_EQ(run({"rename", "other.tiltmap", "0", "far away"}).exit_code, 0);
  const std::string other = info("other.tiltmap");
  const json done = edit({"merge", "p.tiltmap", "other.tiltmap"});
  // Both came with poses of one frame.
  EXPECT_TRUE(done["warnings"].empty()) << done;
  ASSERT_EQ(object({"info", "p.tiltmap"})["scans"].size(), 5U);
  EXPECT_EQ(object({"info", "p.tiltmap"})["scans"][3]["name"], "far away");
  EXPECT_EQ(object({"poses", "p.tiltmap"})["poses"][4]["translation_m"], json({11.0, 0.0, 0.0}));
  EXPECT_EQ(info("other.tiltmap"), other);

  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  edit({"merge", "p.tiltmap", "other.tiltmap", "--at", "5", "-2", "90"});
  const json placed = object({"poses", "p.tiltmap"})["poses"][4]["translation_m"];
  EXPECT_NEAR(placed[0].get<double>(), 5.0, 1e-12);
  EXPECT_NEAR(placed[1].get<double>(), -1.0, 1e-12);

  // Nobody knows where simulated stops are in the frame of the imported ones.
  ASSERT_EQ(run({"new", "third.tiltmap"}).exit_code, 0);
  ASSERT_EQ(run({"import", "third.tiltmap", "a.xyz"}).exit_code, 0);
  EXPECT_EQ(edit({"merge", "p.tiltmap", "third.tiltmap"})["warnings"].size(), 1U);

  refused({"merge", "p.tiltmap", "p.tiltmap"}, 1, "itself");
  refused({"merge", "p.tiltmap", "none.tiltmap"}, 1, "none.tiltmap");
  refused({"merge", "p.tiltmap", "a.xyz"}, 1, "a.xyz");
  refused({"merge", "p.tiltmap", "other.tiltmap", "--at", "1", "2"}, 2, "--at");
}

TEST_F(CliEdits, EveryCommandIsInTheHelp) {
  const std::string help = run({"--help"}).out;
  for (const char* command : {"rename", "note", "survey", "delete", "rebase", "photo", "link", "copy",
                              "merge", "compact", "verify", "undo", "redo", "history"})
    EXPECT_NE(help.find(command), std::string::npos) << command;
  EXPECT_NE(run({"photo", "--help"}).out.find("save"), std::string::npos);
  EXPECT_NE(run({"photo", "add", "--help"}).out.find("--caption"), std::string::npos);
}

}  // namespace
}  // namespace tiltmap::test
