// Pins, the picture of the site, and links by hand, from the command line.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/products/png.h"
#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

class CliSite : public ::testing::Test {
 protected:
  ProgramRun run(const std::vector<std::string>& words) { return tiltmap(words, folder_.path()); }
  json object(std::vector<std::string> words) {
    words.push_back("--json");
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  void simulate(const char* stops) {
    ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
    ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "exp1", "--stops", stops}).exit_code, 0);
  }
  TemporaryFolder folder_;
};

TEST_F(CliSite, PinnedScansStayWhenTheSurveyIsRelaxed) {
  simulate("4");
  EXPECT_EQ(object({"pin", "p.tiltmap"})["pins"], json::array());
  ASSERT_EQ(run({"pin", "p.tiltmap", "2"}).exit_code, 0);
  EXPECT_EQ(object({"pin", "p.tiltmap"})["pins"], json({2}));
  const json relaxed = object({"relax", "p.tiltmap", "--record"});
  EXPECT_EQ(relaxed["pins"], json({2}));
  EXPECT_EQ(relaxed["moved"][2]["translation_m"], 0.0);
  EXPECT_GT(relaxed["moved"][3]["translation_m"].get<double>(), 0.0);
  ASSERT_EQ(run({"pin", "p.tiltmap", "none"}).exit_code, 0);
  EXPECT_EQ(object({"pin", "p.tiltmap"})["pins"], json::array());
  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(object({"pin", "p.tiltmap"})["pins"], json({2}));
  EXPECT_EQ(run({"pin", "p.tiltmap", "9"}).exit_code, 1);
}

TEST_F(CliSite, APictureIsPlacedByTwoPoints) {
  simulate("2");
  ASSERT_TRUE(writePng(folder_.path() / "site.png", RgbImage(60, 40, Rgb{1, 2, 3})));
  EXPECT_TRUE(object({"aerial", "show", "p.tiltmap"})["picture"].is_null());
  ASSERT_EQ(run({"aerial", "add", "p.tiltmap", "site.png", "--point", "0,40,0,0", "--point", "60,40,30,0"})
                .exit_code,
            0);
  const json shown = object({"aerial", "show", "p.tiltmap"});
  EXPECT_EQ(shown["picture"], "site.png");
  EXPECT_NEAR(shown["metres_per_pixel"].get<double>(), 0.5, 1e-12);
  ASSERT_EQ(run({"aerial", "place", "p.tiltmap", "--point", "0,40,0,0", "--point", "60,40,0,60"}).exit_code,
            0);
  EXPECT_NEAR(object({"aerial", "show", "p.tiltmap"})["metres_per_pixel"].get<double>(), 1.0, 1e-12);
  ASSERT_EQ(run({"aerial", "remove", "p.tiltmap"}).exit_code, 0);
  EXPECT_TRUE(object({"aerial", "show", "p.tiltmap"})["picture"].is_null());
  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(object({"aerial", "show", "p.tiltmap"})["picture"], "site.png");
  EXPECT_NE(run({"aerial", "place", "p.tiltmap", "--point", "1,1,0,0", "--point", "1,1,5,5"}).exit_code, 0);
  EXPECT_NE(run({"aerial", "place", "p.tiltmap", "--point", "here", "--point", "1,1,5,5"}).exit_code, 0);
  EXPECT_NE(
      run({"aerial", "add", "p.tiltmap", "p.tiltmap", "--point", "0,0,0,0", "--point", "9,0,9,0"}).exit_code,
      0);
}

TEST_F(CliSite, LinksAreAddedAskedAboutAndDeleted) {
  simulate("3");
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const auto links = [&] { return object({"link", "list", "p.tiltmap"})["links"]; };
  ASSERT_EQ(links().size(), 2U);
  EXPECT_EQ(links()[0]["verdict"], "good") << links()[0]["reason"];
  const json added = object({"link", "add", "p.tiltmap", "0", "2"});
  EXPECT_EQ(added["fixed"], 0);
  EXPECT_EQ(added["moving"], 2);
  EXPECT_GT(added["overlap"].get<double>(), 0.1);
  ASSERT_EQ(links().size(), 3U);
  ASSERT_EQ(run({"link", "add", "p.tiltmap", "0", "2", "--method", "as-placed"}).exit_code, 0);
  ASSERT_EQ(links().size(), 4U);
  const std::string id = std::to_string(links()[3]["id"].get<int>());
  EXPECT_EQ(links()[3]["origin"], "by-hand");
  const json asked = object({"link", "what-if", "p.tiltmap", id});
  EXPECT_EQ(asked["links"].size(), 4U);
  EXPECT_TRUE(asked["links"][3]["left_out"].get<bool>());
  EXPECT_TRUE(asked["separated"].empty());
  EXPECT_NE(asked["text"].get<std::string>().find("the others put scan 2"), std::string::npos);
  EXPECT_EQ(links().size(), 4U) << "asking changes nothing";
  ASSERT_EQ(run({"link", "delete", "p.tiltmap", id}).exit_code, 0);
  EXPECT_EQ(links().size(), 3U);
  ASSERT_EQ(run({"undo", "p.tiltmap"}).exit_code, 0);
  EXPECT_EQ(links().size(), 4U);
  EXPECT_EQ(run({"link", "add", "p.tiltmap", "1", "1"}).exit_code, 1);
  EXPECT_EQ(run({"link", "what-if", "p.tiltmap", "999"}).exit_code, 1);
}

TEST_F(CliSite, EveryoneTellsTheSameOfALink) {
  simulate("3");
  const json registered = object({"register", "p.tiltmap", "--pairs", "0:1,1:2,0:2"});
  const json listed = object({"link", "list", "p.tiltmap"})["links"];
  ASSERT_EQ(listed.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(listed[k]["by_scans"]["verdict"], registered["pairs"][k]["verdict"]);
    EXPECT_EQ(listed[k]["by_scans"]["reason"], registered["pairs"][k]["verdict_reason"]);
    EXPECT_EQ(listed[k]["loop"]["links"], 3);
  }
  const json judged = object({"link", "judge", "p.tiltmap"})["links"];
  EXPECT_EQ(judged, listed);
  EXPECT_EQ(object({"link", "list", "p.tiltmap"})["links"], listed);
  const std::string reason = judged[0]["reason"].get<std::string>();
  EXPECT_NE(run({"link", "judge", "p.tiltmap"}).out.find(reason), std::string::npos);
  EXPECT_EQ(object({"link", "judge", "p.tiltmap", "--overlap-good", "0.99"})["links"][0]["verdict"],
            "doubtful");
  EXPECT_NE(run({"link", "judge", "p.tiltmap", "--links", "99"}).exit_code, 0);
}

}  // namespace
}  // namespace tiltmap::test
