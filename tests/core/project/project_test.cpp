// Storing and reading back: scans, matrices, poses, links, survey data.
#include "core/project/project.h"

#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

void expectSameImage(const RangeImage& a, const RangeImage& b) {
  EXPECT_EQ(a.rows(), b.rows());
  EXPECT_EQ(a.columns(), b.columns());
  EXPECT_EQ(a.data().range_m, b.data().range_m);
  EXPECT_EQ(a.data().code, b.data().code);
  EXPECT_EQ(a.data().intensity, b.data().intensity);
  EXPECT_EQ(a.data().line_tilt_rad, b.data().line_tilt_rad);
  EXPECT_EQ(a.data().line_time_s, b.data().line_time_s);
  ASSERT_EQ(a.data().direction.size(), b.data().direction.size());
  for (std::size_t i = 0; i < a.data().direction.size(); ++i)
    EXPECT_EQ(a.data().direction[i], b.data().direction[i]);
}

class ProjectTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "site.tiltmap";
};

TEST_F(ProjectTest, NewProjectIsEmptyAndOpensAgain) {
  std::string id;
  {
    const auto project = must(Project::create(path_));
    EXPECT_TRUE(project->snapshot()->scans().empty());
    EXPECT_EQ(project->snapshot()->latestStage(), Stage::Odometry);
    EXPECT_TRUE(project->history().empty());
    id = project->snapshot()->projectId();
    EXPECT_EQ(id.size(), 32U);
  }
  const auto again = must(Project::open(path_, Access::ReadOnly));
  EXPECT_EQ(again->snapshot()->projectId(), id);
  EXPECT_TRUE(again->snapshot()->links().empty());
}

TEST_F(ProjectTest, ClosedProjectIsOneFile) {
  {
    const auto project = must(Project::create(path_));
    must(project->apply(importEdit(sampleScans(2))));
  }
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.path())) ++files;
  EXPECT_EQ(files, 1);
}

TEST_F(ProjectTest, CreateRefusesAnythingThere) {
  std::ofstream(path_) << "precious";
  const auto project = Project::create(path_);
  ASSERT_FALSE(project);
  EXPECT_THAT(project.error().what, ::testing::HasSubstr("already"));
  std::ifstream in(path_);
  std::string word;
  in >> word;
  EXPECT_EQ(word, "precious");
  EXPECT_FALSE(Project::create(folder_.path()));
  EXPECT_FALSE(Project::create(folder_ / "no" / "such" / "folder.tiltmap"));
}

TEST_F(ProjectTest, MatricesComeBackBitForBit) {
  std::vector<Scan> scans = {
      sampleScan(1), sampleScan(2, {3, 4, false, false, false}), sampleScan(3, {4, 6, true, false, true}),
      sampleScan(4, {1, 50, false, false, true}), sampleScan(5, {1, 1, false, true, false})};
  {
    const auto project = must(Project::create(path_));
    const Change change = must(project->apply(importEdit(scans)));
    EXPECT_EQ(change.scans_added.size(), scans.size());
    EXPECT_EQ(change.stages_changed, std::vector{Stage::Odometry});
  }
  const auto project = must(Project::open(path_, Access::ReadOnly));
  const auto snapshot = project->snapshot();
  ASSERT_EQ(snapshot->scans().size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanEntry& entry = snapshot->scans()[i];
    EXPECT_EQ(entry.valid_cells, scans[i].image->validCells());
    EXPECT_EQ(entry.lines, scans[i].image->rows());
    EXPECT_EQ(entry.name, scans[i].name);
    EXPECT_EQ(entry.source, scans[i].source);
    EXPECT_EQ(text(entry.odometry()), text(scans[i].odometry));
    EXPECT_EQ(entry.geometry.lever_arm_m, scans[i].geometry.lever_arm_m);
    EXPECT_EQ(entry.geometry.mounting.coeffs(), scans[i].geometry.mounting.coeffs());
    EXPECT_EQ(entry.geometry.columns, scans[i].geometry.columns);
    expectSameImage(*must(entry.image()), *scans[i].image);
    EXPECT_EQ(must(entry.scan()).name, scans[i].name);
  }
}

TEST_F(ProjectTest, ImagesAreLoadedOnceAndOutliveTheProject) {
  auto project = must(Project::create(path_));
  must(project->apply(importEdit(sampleScans(2))));
  const SnapshotPtr snapshot = project->snapshot();
  const RangeImagePtr first = must(snapshot->scans()[0].image());
  EXPECT_EQ(first.get(), must(snapshot->scans()[0].image()).get());
  must(project->apply(renameEdit(snapshot->scans()[0].id, "north gate")));
  EXPECT_EQ(first.get(), must(project->snapshot()->scans()[0].image()).get());
  project.reset();
  EXPECT_TRUE(snapshot->scans()[1].image());
}

TEST_F(ProjectTest, ImagesLoadFromSeveralThreads) {
  const auto project = must(Project::create(path_));
  must(project->apply(importEdit(sampleScans(6))));
  const SnapshotPtr snapshot = project->snapshot();
  std::vector<std::size_t> valid(4, 0);
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < valid.size(); ++t)
      threads.emplace_back([&, t] {
        for (const ScanEntry& scan : snapshot->scans()) valid[t] += must(scan.image())->validCells();
      });
    for (std::uint64_t i = 0; i < 5; ++i) must(project->apply(sampleRelax(project->snapshot(), i + 1)));
  }
  std::size_t expected = 0;
  for (const ScanEntry& scan : snapshot->scans()) expected += scan.valid_cells;
  for (const std::size_t sum : valid) EXPECT_EQ(sum, expected);
}

TEST_F(ProjectTest, LinksAndStagesComeBack) {
  Link link;
  {
    const auto project = must(Project::create(path_));
    must(project->apply(importEdit(sampleScans(3))));
    const Change change = must(project->apply(sampleRegister(project->snapshot())));
    EXPECT_EQ(change.links_added.size(), 2U);
    EXPECT_EQ(change.stages_changed, std::vector{Stage::Pairwise});
    EXPECT_EQ(project->snapshot()->latestStage(), Stage::Pairwise);
    must(project->apply(sampleRelax(project->snapshot())));
    must(project->apply(posesEdit(Stage::Truth, {{project->snapshot()->scans()[1].id, samplePose(9)}})));
    link = sampleLink(project->snapshot()->scans()[0].id, project->snapshot()->scans()[1].id, 2);
  }
  const auto snapshot = must(Project::open(path_, Access::ReadOnly))->snapshot();
  EXPECT_EQ(snapshot->stages(),
            (std::vector{Stage::Truth, Stage::Odometry, Stage::Pairwise, Stage::Relaxed}));
  EXPECT_EQ(snapshot->latestStage(), Stage::Relaxed);
  EXPECT_FALSE(snapshot->poses(Stage::Truth)[0]);
  EXPECT_EQ(text(*snapshot->poses(Stage::Truth)[1]), text(samplePose(9)));
  ASSERT_EQ(snapshot->links().size(), 2U);
  const Link& stored = snapshot->links()[0];
  EXPECT_EQ(text(stored.fixed_from_moving), text(link.fixed_from_moving));
  EXPECT_EQ(stored.rms_m, link.rms_m);
  EXPECT_EQ(stored.stop_reason, "converged");
  EXPECT_TRUE(stored.usable());
  ASSERT_TRUE(stored.information);
  EXPECT_EQ(*stored.information, *link.information);
  EXPECT_EQ(snapshot->linksOf(snapshot->scans()[1].id).size(), 2U);
  EXPECT_EQ(snapshot->findLink(stored.id)->id, stored.id);
  EXPECT_EQ(snapshot->findLink(99), nullptr);
}

TEST_F(ProjectTest, MissingPosesAreFilledFromOdometry) {
  const auto project = must(Project::create(path_));
  must(project->apply(importEdit(sampleScans(4))));
  auto snapshot = project->snapshot();
  const auto& scans = snapshot->scans();
  EXPECT_EQ(text(snapshot->filledPoses(Stage::Pairwise)[2]), text(scans[2].odometry()));
  must(project->apply(
      posesEdit(Stage::Pairwise, {{scans[1].id, samplePose(50)}, {scans[2].id, samplePose(51)}})));
  const auto filled = project->snapshot()->filledPoses(Stage::Pairwise);
  ASSERT_EQ(filled.size(), 4U);
  EXPECT_EQ(text(filled[1]), text(samplePose(50)));
  // The first hangs on the second, the last on the third: the motions between them are the odometry's.
  const auto motion = [](const Pose& a, const Pose& b) { return a.inverse() * b; };
  for (const auto& [from, to] : {std::pair{1, 0}, std::pair{2, 3}}) {
    const auto d =
        difference(motion(filled[static_cast<std::size_t>(from)], filled[static_cast<std::size_t>(to)]),
                   motion(scans[static_cast<std::size_t>(from)].odometry(),
                          scans[static_cast<std::size_t>(to)].odometry()));
    EXPECT_LT(d.translation_m, 1e-9);
    EXPECT_LT(d.rotation_rad, 1e-9);
  }
}

TEST_F(ProjectTest, IndexOutOfRangeNamesTheRange) {
  const auto project = must(Project::create(path_));
  EXPECT_THAT(project->snapshot()->scanAt(0).error().what, ::testing::HasSubstr("no scans"));
  must(project->apply(importEdit(sampleScans(3))));
  EXPECT_THAT(project->snapshot()->scanAt(3).error().remedy, ::testing::HasSubstr("0 to 2"));
  EXPECT_FALSE(project->snapshot()->scanAt(-1));
  EXPECT_EQ(must(project->snapshot()->scanAt(2))->name, "stop 3");
}

TEST_F(ProjectTest, ReaderFollowsTheWriter) {
  const auto writer = must(Project::create(path_));
  const auto reader = must(Project::open(path_, Access::ReadOnly));
  EXPECT_FALSE(must(reader->refresh()));
  must(writer->apply(importEdit(sampleScans(2))));
  EXPECT_TRUE(reader->snapshot()->scans().empty());
  EXPECT_TRUE(must(reader->refresh()));
  EXPECT_EQ(visibleState(*reader->snapshot()), visibleState(*writer->snapshot()));
  const auto refused = reader->apply(renameEdit(1, "x"));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, ::testing::HasSubstr("reading only"));
  EXPECT_FALSE(reader->undo());
}

TEST_F(ProjectTest, SecondWriterIsRefusedInTheSameProcess) {
  auto first = must(Project::create(path_));
  const auto second = Project::open(path_, Access::ReadWrite);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().what, ::testing::HasSubstr("open for writing elsewhere: process"));
  first.reset();
  EXPECT_TRUE(Project::open(path_, Access::ReadWrite));
}

TEST_F(ProjectTest, PathWithStrangeCharacters) {
  const auto path = folder_ / "a b?c#d%41&é.tiltmap";
  {
    const auto project = must(Project::create(path));
    must(project->apply(importEdit(sampleScans(1))));
  }
  EXPECT_EQ(must(Project::open(path, Access::ReadOnly))->snapshot()->scans().size(), 1U);
}

}  // namespace
}  // namespace tiltmap
