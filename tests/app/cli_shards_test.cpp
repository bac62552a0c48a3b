// A survey's registration split over processes, as the job array in resources/slurm does it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/project/project.h"
#include "tests/support/program.h"
#include "tests/support/project_samples.h"

namespace tiltmap::test {
namespace {

class CliShards : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"new", "one.tiltmap"}).exit_code, 0);
    ASSERT_EQ(run({"simulate", "one.tiltmap", "--experiment", "exp1"}).exit_code, 0);
    std::filesystem::copy_file(folder_ / "one.tiltmap", folder_ / "split.tiltmap");
  }
  ProgramRun run(const std::vector<std::string>& words) { return tiltmap(words, folder_.path()); }
  ProgramRun refused(const std::vector<std::string>& words, int code, const std::string& says) {
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, code);
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    return result;
  }
  // Words as bash runs them in the folder; the scripts find the program under test.
  int bash(const std::string& words) {
    const std::string command = "cd '" + folder_.path().string() + "' && TILTMAP='" + programPath() +
                                "' scripts='" + TILTMAP_SOURCE_DIR + "/resources/slurm' bash -c '" + words +
                                "' >out.txt 2>err.txt";
    return std::system(command.c_str());
  }
  std::string err() { return fileText(folder_ / "err.txt"); }

  // What the registration left, every bit of it, but for what a clock says.
  std::string state(const std::string& project) {
    const auto opened = must(Project::open((folder_ / project).string(), Access::ReadOnly));
    const SnapshotPtr snapshot = opened->snapshot();
    std::ostringstream out;
    for (const Link& link : snapshot->links()) {
      out << link.id << ": " << link.fixed << "-" << link.moving << " " << text(link.fixed_from_moving)
          << link.iterations << " " << link.correspondences << " " << text(link.rms_m) << " "
          << text(link.overlap) << " " << link.stop_reason << link.succeeded << linkOriginName(link.origin)
          << linkStateName(link.state) << "\n";
      for (int i = 0; link.information && i < 36; ++i) out << text(link.information->data()[i]) << " ";
    }
    for (const ScanEntry& scan : snapshot->scans())
      for (const auto& [stage, pose] : scan.poses) out << stageName(stage) << " " << text(pose) << "\n";
    for (const JobRecord& job : snapshot->jobs()) {
      ParameterValues values = job.values;
      values.erase("threads");
      out << job.operation << " " << job.preset << " " << parametersToJson(values) << job.program_version
          << jobStateName(job.state);
      for (const std::string& warning : job.warnings) out << warning << "\n";
    }
    return out.str();
  }
  TemporaryFolder folder_;
};

TEST_F(CliShards, AJobArrayOfLocalProcessesGivesTheBitsOfOneProcess) {
  const std::string before = state("one.tiltmap");
  ASSERT_EQ(run({"register", "one.tiltmap", "--threads", "1"}).exit_code, 0);
  // Three at once, each with threads of its own choice, as a scheduler starts them.
  ASSERT_EQ(bash("for k in 1 2 3; do SLURM_ARRAY_TASK_ID=$k SLURM_CPUS_PER_TASK=$k "
                 "$scripts/register-part 3 split.tiltmap parts & tasks+=($!); done; "
                 "for task in ${tasks[@]}; do wait $task || exit 1; done"),
            0)
      << err();
  EXPECT_EQ(state("split.tiltmap"), before) << "a part must leave the project alone";
  ASSERT_EQ(bash("$scripts/merge-parts 3 split.tiltmap parts"), 0) << err();
  EXPECT_NE(state("one.tiltmap"), before);
  EXPECT_EQ(state("split.tiltmap"), state("one.tiltmap"));
  // One edit, which can be taken back.
  ASSERT_EQ(run({"undo", "split.tiltmap"}).exit_code, 0);
  EXPECT_TRUE(must(Project::open((folder_ / "split.tiltmap").string(), Access::ReadOnly))
                  ->snapshot()
                  ->links()
                  .empty());
}

TEST_F(CliShards, MorePartsThanPairsAndParametersOfTheUser) {
  ASSERT_EQ(run({"register", "one.tiltmap", "--pairs", "0:1,0:2,1:2", "--max-distance", "4"}).exit_code, 0);
  std::vector<std::string> merge = {"merge", "split.tiltmap"};
  for (const char* k : {"5", "3", "1", "2", "4"}) {
    merge.push_back(std::string("part") + k);
    ASSERT_EQ(run({"register", "split.tiltmap", "--shard", std::string(k) + "/5", "--out", merge.back(),
                   "--pairs", "0:1,0:2,1:2", "--max-distance", "4", "--quiet"})
                  .exit_code,
              0);
  }
  const ProgramRun merged = run(merge);
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(state("split.tiltmap"), state("one.tiltmap"));
}

TEST_F(CliShards, TellsWhatIsWrongWithTheWords) {
  refused({"register", "one.tiltmap", "--shard", "0/2", "--out", "a"}, 2, "no part 0 of 2");
  refused({"register", "one.tiltmap", "--shard", "half", "--out", "a"}, 2, "K/N");
  refused({"register", "one.tiltmap", "--shard", "1/2"}, 2, "--out");
  refused({"register", "one.tiltmap", "--out", "a"}, 2, "--shard");
  refused({"register", "one.tiltmap", "--shard", "1/2", "--out", "split.tiltmap"}, 1, "never replaced");
  writeFile(folder_ / "notes.txt", "mine");
  refused({"register", "one.tiltmap", "--shard", "1/2", "--out", "notes.txt"}, 1, "something else");
  EXPECT_EQ(fileText(folder_ / "notes.txt"), "mine");

  ASSERT_EQ(run({"register", "one.tiltmap", "--shard", "1/2", "--out", "a"}).exit_code, 0);
  refused({"merge", "one.tiltmap", "a"}, 1, "part 2/2 is missing");
  refused({"merge", "one.tiltmap", "a", "a"}, 1, "twice");
  refused({"merge", "one.tiltmap", "a", "--at", "1", "2", "3"}, 2, "--at");
  refused({"merge", "one.tiltmap", "a", "split.tiltmap"}, 1, "no part of a registration");
  refused({"merge", "one.tiltmap", "split.tiltmap", "split.tiltmap"}, 1, "one project");
  EXPECT_EQ(bash("$scripts/register-part 3 one.tiltmap"), 2 << 8) << err();
  EXPECT_EQ(bash("$scripts/merge-parts 3 one.tiltmap nowhere"), 1 << 8) << err();
  EXPECT_TRUE(
      must(Project::open((folder_ / "one.tiltmap").string(), Access::ReadOnly))->snapshot()->links().empty());
}

}  // namespace
}  // namespace tiltmap::test
