// Parts of a registration: what they hold, and which are refused.
#include "core/project/operations/registration_shards.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/job.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

TEST(ShardTest, EveryPairIsInOnePartAndNeighboursStayTogether) {
  std::vector<IndexPair> pairs;
  for (int i = 0; i < 37; ++i) pairs.emplace_back(i, i + 1);
  for (const int n : {1, 2, 5, 37, 50}) {
    std::vector<IndexPair> whole;
    std::size_t least = pairs.size(), most = 0;
    for (int k = 1; k <= n; ++k) {
      const auto part = pairsOfShard(pairs, {k, n});
      whole.insert(whole.end(), part.begin(), part.end());
      least = std::min(least, part.size());
      most = std::max(most, part.size());
    }
    EXPECT_EQ(whole, pairs) << n;
    EXPECT_LE(most, least + 1) << n;
  }
  EXPECT_TRUE(pairsOfShard({}, {1, 3}).empty());
}

TEST(ShardTest, ReadsKOfN) {
  EXPECT_EQ(must(parseShard("2/8")), (Shard{2, 8}));
  EXPECT_EQ(shardName({2, 8}), "2/8");
  for (const char* text : {"", "2", "2/", "/8", "2/8/1", "0/8", "9/8", "-1/8", "1/0", "a/b", "1.5/2",
                           "1/100001", "1/99999999999999999999"})
    EXPECT_FALSE(parseShard(text)) << text;
}

class RegistrationShardsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = made("p.tiltmap", 1);
    for (int k = 1; k <= 2; ++k) files_.push_back(write(*project_, {k, 2}, {}, "part" + std::to_string(k)));
  }
  std::unique_ptr<Project> made(const std::string& name, long long seed) {
    auto project = must(Project::create((folder_ / name).string()));
    auto job = must(Job::start(*operations().find("simulate"), project->snapshot(), "default",
                               {{"experiment", std::string("exp1")}, {"stops", 3LL}, {"seed", seed}}));
    job->wait();
    must(job->accept(*project));
    return project;
  }
  std::filesystem::path write(const Project& project, const Shard& shard, const ParameterValues& values,
                              const std::string& name) {
    must(writeRegistrationPart(must(registerShard(project.snapshot(), "default", values, shard, {})),
                               folder_ / name));
    return folder_ / name;
  }
  void refused(const std::vector<std::filesystem::path>& files, const std::string& what,
               const std::filesystem::path& where = {}) {
    const auto result = mergeRegistrationParts(project_->snapshot(), files);
    ASSERT_FALSE(result) << what;
    EXPECT_NE(result.error().what.find(what), std::string::npos) << result.error().what;
    EXPECT_FALSE(result.error().remedy.empty());
    if (!where.empty()) {
      EXPECT_EQ(result.error().where, where.string());
    }
  }
  TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  std::vector<std::filesystem::path> files_;
};

TEST_F(RegistrationShardsTest, APartComesBackFromItsFileWithTheSameBits) {
  const RegistrationPart made = must(registerShard(project_->snapshot(), "default", {}, {1, 2}, {}));
  ASSERT_EQ(made.pairs.size(), 1U);
  must(writeRegistrationPart(made, folder_ / "again"));
  const RegistrationPart read = must(readRegistrationPart(folder_ / "again"));
  EXPECT_EQ(read.shard, made.shard);
  EXPECT_EQ(read.values, made.values);
  EXPECT_EQ(read.scans, made.scans);
  EXPECT_EQ(read.project_id, project_->snapshot()->projectId());
  ASSERT_EQ(read.pairs.size(), 1U);
  const RegisteredPair &a = read.pairs[0], &b = made.pairs[0];
  EXPECT_EQ(text(a.result.fixed_from_moving), text(b.result.fixed_from_moving));
  EXPECT_EQ(text(a.result.start), text(b.result.start));
  EXPECT_EQ(a.result.information, b.result.information);
  EXPECT_EQ(a.result.stop_reason, b.result.stop_reason);
  EXPECT_EQ(a.judgement.reason, b.judgement.reason);
  EXPECT_EQ(a.judgement.verdict, b.judgement.verdict);
  EXPECT_EQ(text(a.judgement.badness), text(b.judgement.badness));
  EXPECT_EQ(text(a.judgement.strength.weakest_m), text(b.judgement.strength.weakest_m));
  EXPECT_EQ(registeredPairsJson(read.pairs), registeredPairsJson(made.pairs));
}

TEST_F(RegistrationShardsTest, TheReportIsThatOfOneProcess) {
  const Operation& whole = *operations().find("register");
  const auto one = must(whole.run(project_->snapshot(), must(whole.presetValues("default")), {}));
  const auto merged = must(mergeRegistrationParts(project_->snapshot(), {files_[1], files_[0]}));
  auto a = nlohmann::json::parse(one.report_json), b = nlohmann::json::parse(merged.report_json);
  ASSERT_EQ(a["pairs"].size(), 2U);
  for (auto* report : {&a, &b}) {
    report->erase("milliseconds");
    for (auto& pair : (*report)["pairs"]) pair.erase("milliseconds");
  }
  EXPECT_EQ(a, b);
  EXPECT_EQ(one.warnings, merged.warnings);
}

TEST_F(RegistrationShardsTest, AMatrixWithoutNumbersSurvivesTheFile) {
  // A pair that fails: no information, infinities in its judgement.
  const auto part = must(registerShard(project_->snapshot(), "default", {{"max-angle", 0.0}}, {1, 1}, {}));
  ASSERT_FALSE(part.pairs[0].result.succeeded());
  must(writeRegistrationPart(part, folder_ / "failed"));
  const auto read = must(readRegistrationPart(folder_ / "failed"));
  EXPECT_EQ(registeredPairsJson(read.pairs), registeredPairsJson(part.pairs));
  const auto merged = must(mergeRegistrationParts(project_->snapshot(), {folder_ / "failed"}));
  EXPECT_EQ(merged.warnings.size(), 2U);
}

TEST_F(RegistrationShardsTest, MissingDoubledAndForeignPartsAreRefused) {
  refused({}, "no part");
  refused({files_[0]}, "part 2/2 is missing");
  refused({files_[0], files_[0], files_[1]}, "twice", files_[0]);
  refused({files_[0], folder_ / "none"}, "no such file", folder_ / "none");
  refused({files_[0], write(*project_, {2, 3}, {}, "third")}, "not of one whole", folder_ / "third");
  const auto other = made("other.tiltmap", 2);
  refused({files_[0], write(*other, {2, 2}, {}, "foreign")}, "another project", folder_ / "foreign");
  refused({files_[0], write(*project_, {2, 2}, {{"max-distance", 3.0}}, "wide")}, "max-distance",
          folder_ / "wide");
  // The number of threads changes nothing of what is computed.
  EXPECT_TRUE(mergeRegistrationParts(project_->snapshot(),
                                     {files_[0], write(*project_, {2, 2}, {{"threads", 1LL}}, "threads")}));
}

TEST_F(RegistrationShardsTest, APartOfScansThatChangedSinceIsRefused) {
  const SnapshotPtr snapshot = project_->snapshot();
  must(project_->apply(posesEdit(Stage::Odometry, {{snapshot->scans()[1].id, Pose::planar(9, 9, 0)}})));
  refused(files_, "scan 1 has other", files_[0]);
  must(project_->undo());
  EXPECT_TRUE(mergeRegistrationParts(project_->snapshot(), files_));
  must(project_->apply(deleteEdit(*project_->snapshot(), {project_->snapshot()->scans()[2].id})));
  refused(files_, "3 scans, the project has 2", files_[0]);
}

TEST_F(RegistrationShardsTest, DamagedPartsAreRefusedWhereverTheyAreCut) {
  std::ifstream file(files_[1], std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const auto put = [&](const std::string& text) {
    std::ofstream(folder_ / "cut", std::ios::binary | std::ios::trunc) << text;
  };
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 6) {
    put(bytes.substr(0, length));
    EXPECT_FALSE(readRegistrationPart(folder_ / "cut")) << length;
  }
  for (std::size_t at = 0; at < bytes.size(); at += 1 + at / 4) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    put(changed);
    EXPECT_FALSE(readRegistrationPart(folder_ / "cut")) << at;
  }
  std::string newer = bytes;
  newer.replace(newer.find("part 2"), 6, "part 3");
  put(newer);
  refused({files_[0], folder_ / "cut"}, "another version", folder_ / "cut");
  put("anything");
  refused({files_[0], folder_ / "cut"}, "no part of a registration", folder_ / "cut");
  EXPECT_FALSE(isRegistrationPart(folder_ / "cut"));
  EXPECT_FALSE(writeRegistrationPart(must(readRegistrationPart(files_[0])), folder_ / "cut"));
}

TEST_F(RegistrationShardsTest, ACancelledPartIsAnError) {
  std::stop_source source;
  source.request_stop();
  JobControl control;
  control.stop = source.get_token();
  const auto part = registerShard(project_->snapshot(), "default", {}, {1, 2}, control);
  ASSERT_FALSE(part);
  EXPECT_EQ(part.error().what, kCancelled);
}

}  // namespace
}  // namespace tiltmap
