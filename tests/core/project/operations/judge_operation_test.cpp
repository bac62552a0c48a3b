#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/job.h"
#include "core/project/judgement_json.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "tests/support/program.h"

namespace tiltmap {
namespace {

class JudgeOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = Project::create((folder_ / "p.tiltmap").string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
    ASSERT_TRUE(run("simulate", {{"experiment", std::string("exp1")}, {"stops", 3LL}}));
  }
  Result<OperationResult> run(const std::string& id, const ParameterValues& values) {
    auto job = Job::start(*operations().find(id), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    auto result = (*job)->result();
    if (result)
      if (auto change = (*job)->accept(*project_); !change) return fail(change.error());
    return result;
  }
  const ProjectSnapshot& now() { return *project_->snapshot(); }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(JudgeOperationTest, RegisteringKeepsWhatJudgingAgainFinds) {
  ASSERT_TRUE(run("register", {{"pairs", std::string("0:1,1:2,0:2")}}));
  std::vector<nlohmann::json> kept;
  for (const Link& link : now().links()) {
    ASSERT_TRUE(link.judgement);
    EXPECT_EQ(link.judgement->verdict, Verdict::Good) << link.judgement->reason;
    kept.push_back(judgementJson(*link.judgement));
  }
  const auto result = run("judge", {});
  ASSERT_TRUE(result) << result.error().what;
  const auto report = nlohmann::json::parse(result->report_json)["links"];
  ASSERT_EQ(report.size(), 3U);
  const auto shown = judgeLinks(now(), now().latestStage());
  for (std::size_t k = 0; k < 3; ++k) {
    const Link& link = now().links()[k];
    EXPECT_EQ(judgementJson(*link.judgement), kept[k]);
    EXPECT_EQ(report[k], linkJson(now(), link, shown[k])) << "what is told is what is shown";
    EXPECT_EQ(report[k]["verdict"], "good") << report[k]["reason"];
    EXPECT_TRUE(report[k]["others"]["supported"].get<bool>());
    EXPECT_LT(report[k]["others"]["deviations"].get<double>(), 2.5);
    EXPECT_EQ(report[k]["loop"]["links"], 3);
    EXPECT_LT(report[k]["loop"]["misclosure_m"].get<double>(), 0.03);
  }
}

TEST_F(JudgeOperationTest, ALinkByHandIsJudgedAndItsStartIsKept) {
  ASSERT_TRUE(run("register", {}));
  ASSERT_TRUE(run("link", {{"fixed", 0LL},
                           {"moving", 2LL},
                           {"start", std::string("odometry")},
                           {"method", std::string("as-placed")}}));
  const Link placed = now().links().back();
  ASSERT_TRUE(placed.judgement);
  EXPECT_NE(placed.judgement->verdict, Verdict::Good) << "the odometry is some 10 cm off";
  EXPECT_EQ(placed.judgement->start, placed.fixed_from_moving);
  ASSERT_TRUE(run("judge", {{"links", std::to_string(placed.id)}}));
  EXPECT_EQ(judgementJson(*now().links().back().judgement), judgementJson(*placed.judgement));
}

TEST_F(JudgeOperationTest, LimitsThatAreSetHoldForWhatIsShown) {
  ASSERT_TRUE(run("register", {}));
  EXPECT_EQ(judgeLinks(now(), Stage::Pairwise)[0].quality, LinkQuality::Good);
  ASSERT_TRUE(run("judge", {{"overlap-good", 0.99}, {"others-good", 9.0}}));
  const auto strict = judgeLinks(now(), Stage::Pairwise);
  EXPECT_EQ(strict[0].quality, LinkQuality::Doubtful);
  EXPECT_NE(strict[0].reason.find("common"), std::string::npos);
  EXPECT_EQ(judgementSettingsOf(now()).others_good, 9.0);
  ASSERT_TRUE(project_->undo());
  EXPECT_EQ(judgeLinks(now(), Stage::Pairwise)[0].quality, LinkQuality::Good);
}

TEST_F(JudgeOperationTest, RefusesWhatIsNoLink) {
  EXPECT_FALSE(run("judge", {})) << "there are none";
  ASSERT_TRUE(run("register", {}));
  for (const char* links : {"4711", "x", "-1", "1-"})
    EXPECT_FALSE(run("judge", {{"links", std::string(links)}})) << links;
}

}  // namespace
}  // namespace tiltmap
