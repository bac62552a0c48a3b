// What becomes of edits over a project's life: results that come late, copies, compacting, merging, links
// that a person accepts, lines that a capture appends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/edited_project.h"

namespace tiltmap {
namespace {

using namespace test;
using ::testing::HasSubstr;

using ProjectLifeTest = EditedProject;

TEST_F(ProjectLifeTest, ResultsOfAnOlderStateAreRefusedOnlyWhereItMatters) {
  const auto base = project_->snapshot();
  const auto result = [&] {
    return registerEdit(base, {sampleLink(id(0), id(1), 60)}, {{id(0), Pose()}, {id(1), samplePose(61)}});
  };
  // Names, notes and other scans do not matter.
  must(project_->apply(renameEdit(id(0), "new name")));
  must(project_->apply(noteEdit(id(1), "a note")));
  must(project_->apply(posesEdit(Stage::Truth, {{id(2), samplePose(1)}})));
  must(project_->apply(importEdit({sampleScan(9)})));
  must(project_->apply(result()));
  must(project_->undo());

  const std::vector<std::pair<std::string, ProjectEdit>> changes = {
      {"pose", posesEdit(Stage::Odometry, {{id(1), samplePose(70)}})},
      {"links", linkStateEdit(project_->snapshot()->links()[0].id, LinkState::Disabled)},
      {"deleted", deleteEdit(*project_->snapshot(), {id(1)})},
      {"geometry",
       [&] {
         ScannerGeometry geometry = project_->snapshot()->scans()[0].geometry;
         geometry.range_offset_m = 0.01;
         return single(SetGeometry{id(0), geometry});
       }()},
  };
  const ProjectEdit late = result();
  for (const auto& [what, change] : changes) {
    SCOPED_TRACE(what);
    must(project_->apply(change));
    const std::string before = state();
    const auto refused = project_->apply(late);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("no longer fits"));
    EXPECT_THAT(refused.error().what, HasSubstr(what));
    EXPECT_EQ(state(), before);
    must(project_->undo());
  }
  must(project_->apply(late));  // changed and undone is not changed

  const auto other = must(Project::create(folder_ / "other.tiltmap"));
  EXPECT_THAT(other->apply(late).error().what, HasSubstr("another project"));
}

TEST_F(ProjectLifeTest, CopyAndSaveAsKeepHistory) {
  must(project_->undo());
  must(project_->saveCopy(folder_ / "copy.tiltmap"));
  const auto copy = must(Project::open(folder_ / "copy.tiltmap", Access::ReadWrite));
  EXPECT_EQ(visibleState(*copy->snapshot()), state());
  must(copy->redo());
  EXPECT_EQ(copy->snapshot()->scans()[0].photographs.size(), 1U);
  EXPECT_TRUE(copy->verify());
  EXPECT_TRUE(project_->snapshot()->scans()[0].photographs.empty());

  const auto refused = project_->saveCopy(folder_ / "copy.tiltmap");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("already"));
  EXPECT_FALSE(project_->saveCopy(path_));
  const auto moved = must(project_->saveAs(folder_ / "moved.tiltmap"));
  must(moved->apply(renameEdit(id(0), "elsewhere")));
  EXPECT_EQ(project_->snapshot()->scans()[0].name, "stop 1");
}

TEST_F(ProjectLifeTest, CompactGivesSpaceBackAndKeepsWhatIsVisible) {
  std::vector<Scan> large;
  for (std::uint64_t i = 0; i < 6; ++i) large.push_back(sampleScan(30 + i, {101, 361, true, true, false}));
  must(project_->apply(importEdit(std::move(large))));
  const auto old = project_->snapshot();
  std::vector<ScanId> all = scanIds(*old);
  must(project_->apply(deleteEdit(*old, {all.begin() + 3, all.end()})));
  must(project_->apply(renameEdit(id(0), "undone")));
  must(project_->undo());
  const std::string before = state();
  const auto report = must(project_->compact());
  EXPECT_EQ(report.matrices_dropped, 6);
  EXPECT_LT(report.bytes_after * 2, report.bytes_before);
  EXPECT_EQ(state(), before);
  EXPECT_FALSE(project_->snapshot()->canUndo());
  EXPECT_FALSE(project_->snapshot()->canRedo());
  EXPECT_FALSE(project_->undo());
  EXPECT_EQ(project_->history().size(), 5U) << "titles stay";
  const auto gone = old->scans()[5].image();
  ASSERT_FALSE(gone);
  EXPECT_THAT(gone.error().remedy, HasSubstr("compacted"));
  must(project_->apply(renameEdit(id(0), "again")));
  must(project_->undo());
  EXPECT_EQ(state(), before);
  reopen();
  EXPECT_EQ(state(), before);
  EXPECT_TRUE(project_->verify());
}

TEST_F(ProjectLifeTest, MergeBringsEverythingAndIsUndone) {
  const auto other = must(Project::create(folder_ / "other.tiltmap"));
  must(other->apply(importEdit({sampleScan(21), sampleScan(22, {4, 6, true, false, true})})));
  must(other->apply(sampleRegister(other->snapshot(), 80)));
  must(other->apply(surveyEdit({"other site", "someone", "", ""})));
  ProjectEdit photograph{
      "p",
      {AddPhotograph{other->snapshot()->scans()[1].id, NewPhotograph{"c", "image/png", "", {7, 8}, {}}}},
      nullptr,
      {},
      {}};
  JobRecord job;
  job.operation = "register";
  job.values["max-distance"] = 0.5;
  job.state = JobState::Accepted;
  photograph.jobs.push_back(job);
  must(other->apply(photograph));
  must(project_->apply(surveyEdit({"our site", "", "", ""})));

  const std::string before = state();
  const Pose shift = Pose::planar(100, 0, 0.5);
  must(project_->apply(mergeEdit(*project_->snapshot(), *other->snapshot(), shift)));
  const auto merged = project_->snapshot();
  ASSERT_EQ(merged->scans().size(), 5U);
  EXPECT_EQ(merged->links().size(), 3U);
  EXPECT_EQ(merged->links().back().fixed, merged->scans()[3].id);
  EXPECT_EQ(merged->survey().site, "our site");
  EXPECT_EQ(merged->survey().operator_name, "someone");
  ASSERT_EQ(merged->jobs().size(), 1U);
  EXPECT_EQ(std::get<double>(merged->jobs()[0].values.at("max-distance")), 0.5);
  for (std::size_t i = 0; i < 2; ++i) {
    const ScanEntry& from = other->snapshot()->scans()[i];
    const ScanEntry& to = merged->scans()[3 + i];
    EXPECT_EQ(must(to.image())->data().range_m, must(from.image())->data().range_m);
    EXPECT_EQ(text(*to.pose(Stage::Pairwise)), text(shift * *from.pose(Stage::Pairwise)));
    EXPECT_EQ(text(to.odometry()), text(shift * from.odometry()));
  }
  const ScanEntry& last = merged->scans()[4];
  EXPECT_EQ(must(last.photographBytes(last.photographs.at(0).id)), (std::vector<unsigned char>{7, 8}));
  must(project_->undo());
  EXPECT_EQ(state(), before);
}

// A point of the other world keeps its place on the site, whoever tells where that is.
TEST_F(ProjectLifeTest, MergeKnowsWhereTheOtherStandsIfBothTellTheirSite) {
  const auto other = must(Project::create(folder_ / "other.tiltmap"));
  const auto empty = must(Project::create(folder_ / "empty.tiltmap"));
  must(other->apply(importEdit({sampleScan(21)})));
  EXPECT_FALSE(mergePlacement(*project_->snapshot(), *other->snapshot()));
  const Pose ours = Pose::planar(500, 20, 0.3), theirs = Pose::planar(510, 25, -0.9);
  SurveyInfo survey;
  survey.site_from_world = theirs;
  must(other->apply(surveyEdit(survey)));
  EXPECT_FALSE(mergePlacement(*project_->snapshot(), *other->snapshot()));
  EXPECT_TRUE(mergePlacement(*empty->snapshot(), *other->snapshot()));

  // Placed by a person, the other tells this project its site.
  const Pose shift = Pose::planar(3, 4, 0.5);
  must(project_->apply(mergeEdit(*project_->snapshot(), *other->snapshot(), shift)));
  const auto merged = project_->snapshot();
  ASSERT_TRUE(merged->survey().site_from_world);
  const Pose site_from_scan = theirs * other->snapshot()->scans()[0].odometry();
  const auto away =
      difference(*merged->survey().site_from_world * merged->scans().back().odometry(), site_from_scan);
  EXPECT_LT(away.translation_m, 1e-9);
  EXPECT_LT(away.rotation_rad, 1e-7);
  must(project_->undo());

  survey.site_from_world = ours;
  must(project_->apply(surveyEdit(survey)));
  const auto placement = mergePlacement(*project_->snapshot(), *other->snapshot());
  ASSERT_TRUE(placement);
  EXPECT_LT(difference(ours * *placement, theirs).translation_m, 1e-9);
}

TEST_F(ProjectLifeTest, AnAcceptedLinkIsAPersonsOwn) {
  must(project_->apply(sampleRegister(project_->snapshot())));
  const Link found = project_->snapshot()->links()[0];
  const std::size_t count = project_->snapshot()->links().size();
  const std::string before = state();
  must(project_->apply(acceptLinkEdit(found)));
  ASSERT_EQ(project_->snapshot()->links().size(), count);
  const Link accepted = project_->snapshot()->links().back();
  EXPECT_EQ(accepted.origin, LinkOrigin::ByHand);
  EXPECT_EQ(accepted.fixed, found.fixed);
  EXPECT_EQ(text(accepted.fixed_from_moving), text(found.fixed_from_moving));
  must(project_->apply(sampleRegister(project_->snapshot(), 9)));
  EXPECT_TRUE(project_->snapshot()->findLink(accepted.id)) << "registering again leaves it alone";
  must(project_->undo());
  must(project_->undo());
  EXPECT_EQ(state(), before);
  Link failed = found;
  failed.succeeded = false;
  EXPECT_THROW(acceptLinkEdit(failed), std::invalid_argument);
}

TEST_F(ProjectLifeTest, CaptureStoresLineByLine) {
  Scan start = sampleScan(50);
  start.image = nullptr;
  const Change change = must(project_->apply(single(AddScan{start, {}, {}, {}, {}})));
  const ScanId scan = change.scans_added.at(0);
  const auto entry = [&] { return *project_->snapshot()->find(scan); };
  EXPECT_EQ(entry().lines, 0);
  EXPECT_EQ(must(entry().image())->scannedLines(), 0);

  const auto line = [](float range, bool intensity) {
    ScanLine l;
    l.tilt_rad = -0.25;
    l.time_s = 1.5e9;
    l.range_m = {range, 2, 3, 4, 5, 6, 99};
    l.code = {0, 0, 0, 0, 0, 0, cell_code::kLmsOverflow};
    if (intensity) l.intensity.assign(7, 0.5F);
    return l;
  };
  must(project_->appendLine(scan, 3, line(1.0F, true)));
  const auto partial = project_->snapshot();
  must(project_->appendLine(scan, 1, line(1.5F, true)));
  EXPECT_EQ(entry().lines, 2);
  EXPECT_EQ(entry().valid_cells, 12U);

  const std::string before = state();
  EXPECT_FALSE(project_->appendLine(scan, 1, line(9.0F, true))) << "never overwritten";
  EXPECT_FALSE(project_->appendLine(scan, 5, line(1.0F, true)));
  EXPECT_FALSE(project_->appendLine(scan, -1, line(1.0F, true)));
  EXPECT_FALSE(project_->appendLine(scan, 2, line(1.0F, false))) << "intensities for all or none";
  EXPECT_FALSE(project_->appendLine(scan, 2, line(-1.0F, true)));
  EXPECT_FALSE(project_->appendLine(99, 2, line(1.0F, true)));
  ScanLine narrow = line(1.0F, true);
  narrow.code.pop_back();
  EXPECT_FALSE(project_->appendLine(scan, 2, narrow));
  EXPECT_EQ(state(), before);

  reopen();
  EXPECT_EQ(state(), before);
  const auto image = must(entry().image());
  EXPECT_EQ(image->scannedLines(), 2);
  EXPECT_EQ(image->range(3, 0), 1.0F);
  EXPECT_EQ(image->range(1, 0), 1.5F);
  EXPECT_EQ(image->code(3, 6), cell_code::kLmsOverflow);
  EXPECT_EQ(image->range(3, 6), 0.0F);
  EXPECT_EQ(image->intensity(image->index(1, 2)), 0.5F);
  EXPECT_EQ(image->lineTilt(3), -0.25);
  EXPECT_EQ(image->code(0, 0), cell_code::kNotScanned);
  EXPECT_EQ(image->lineTilt(0), start.geometry.tiltOfRow(0)) << "lines not taken stand at the nominal tilt";
  // A snapshot does not grow.
  EXPECT_EQ(must(partial->find(scan)->image())->scannedLines(), 1);
  // The scan is an edit like any other, its lines belong to it.
  must(project_->undo());
  EXPECT_EQ(project_->snapshot()->find(scan), nullptr);
  EXPECT_FALSE(project_->appendLine(scan, 2, line(1.0F, true)));
  must(project_->redo());
  EXPECT_EQ(state(), before);
}

}  // namespace
}  // namespace tiltmap
