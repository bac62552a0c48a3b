#include "core/project/operations/merge_operation.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

class MergeOperationTest : public ::testing::Test {
 protected:
  MergeOperationTest() : project(must(Project::create(folder / "into.tiltmap"))) {
    const auto other = must(Project::create(folder / "other.tiltmap"));
    must(other->apply(importEdit(sampleScans(2))));
    must(other->apply(noteEdit(other->snapshot()->scans()[1].id, "wet")));
    must(other->apply(colourEdit(*other->snapshot(), {other->snapshot()->scans()[0].id}, 0x123456U)));
  }
  Result<OperationResult> run(const std::string& file, const std::string& at = {}) {
    const ParameterValues values = {{"file", (folder / file).string()}, {"at", at}};
    const Operation& merge = *must(operations().get("merge"));
    if (Status good = merge.check(*project->snapshot(), values); !good) return fail(good.error());
    return merge.run(project->snapshot(), values, {});
  }
  TemporaryFolder folder;
  std::unique_ptr<Project> project;
};

TEST_F(MergeOperationTest, BringsScansNotesAndColoursWhereTheyAreToldToStand) {
  must(project->apply(importEdit({sampleScan(7)})));
  const auto result = must(run("other.tiltmap", " 4 5\t-90 "));
  EXPECT_TRUE(result.warnings.empty());
  must(project->apply(result.edit));
  const auto& scans = project->snapshot()->scans();
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_EQ(scans[2].note, "wet");
  EXPECT_EQ(scans[1].colour, 0x123456U);
  EXPECT_FALSE(scans[0].colour);
  const Pose expected = Pose::planar(4, 5, -90 * kDegree) * sampleScan(2).odometry;
  EXPECT_LT((scans[2].odometry().translation() - expected.translation()).norm(), 1e-9);
  EXPECT_EQ(must(scans[1].image())->validCells(), sampleScan(1).image->validCells());
}

TEST_F(MergeOperationTest, WarnsWhereThePlaceIsNotKnown) {
  must(project->apply(importEdit({sampleScan(7)})));
  EXPECT_EQ(must(run("other.tiltmap")).warnings.size(), 1U);
}

TEST_F(MergeOperationTest, AnEmptyProjectTakesTheOthersWorld) {
  const auto result = must(run("other.tiltmap"));
  EXPECT_TRUE(result.warnings.empty());
  must(project->apply(result.edit));
  EXPECT_EQ(project->snapshot()->scans()[0].odometry().translation(), sampleScan(1).odometry.translation());
}

TEST_F(MergeOperationTest, RefusesWhatMakesNoSense) {
  for (const char* at : {"5", "1 2 3 4", "a b c", "1 2 nan"}) EXPECT_FALSE(run("other.tiltmap", at)) << at;
  EXPECT_FALSE(run("none.tiltmap"));
  EXPECT_FALSE(run(""));
  const auto itself = run("into.tiltmap");
  ASSERT_FALSE(itself);
  EXPECT_NE(itself.error().what.find("itself"), std::string::npos);
}

TEST_F(MergeOperationTest, CheckingAFileFindsDamage) {
  must(project->apply(importEdit(sampleScans(6, {101, 361}))));
  const SnapshotPtr snapshot = project->snapshot();
  EXPECT_TRUE(verifyOperation().run(snapshot, {}, {}));
  const auto path = project->path();
  project.reset();
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 2));
    file << std::string(40000, '\x5a');
  }
  EXPECT_FALSE(verifyOperation().run(snapshot, {}, {}));
}

}  // namespace
}  // namespace tiltmap
