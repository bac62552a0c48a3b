// Every edit, its undo and redo, also after reopening; what is refused and leaves things as they were.
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/project/project.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;
using ::testing::HasSubstr;

class EditTest : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = must(Project::create(path_));
    must(project_->apply(importEdit(sampleScans(3))));
    must(project_->apply(sampleRegister(project_->snapshot())));
    NewPhotograph photograph;
    photograph.caption = "view north";
    photograph.media_type = "image/jpeg";
    photograph.bytes = {1, 2, 3, 0, 255};
    ProjectEdit edit{"photograph", {AddPhotograph{id(0), photograph}}, nullptr, {}, {}};
    must(project_->apply(edit));
  }
  ScanId id(std::size_t index) const { return project_->snapshot()->scans().at(index).id; }
  std::string state() const { return visibleState(*project_->snapshot()); }
  void reopen() {
    project_.reset();
    project_ = must(Project::open(path_, Access::ReadWrite));
  }
  static ProjectEdit single(EditStep step) { return ProjectEdit{"test", {std::move(step)}, nullptr, {}, {}}; }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "p.tiltmap";
  std::unique_ptr<Project> project_;
};

struct NamedEdit {
  std::string name;
  std::function<ProjectEdit(const Project&)> make;
};

std::vector<NamedEdit> everyEdit() {
  const auto id = [](const Project& p, std::size_t i) { return p.snapshot()->scans().at(i).id; };
  const auto single = [](EditStep step) { return ProjectEdit{"test", {std::move(step)}, nullptr, {}, {}}; };
  return {
      {"import",
       [](const Project&) {
         return importEdit({sampleScan(9), sampleScan(10)});
       }},
      {"delete",
       [=](const Project& p) {
         return deleteEdit(*p.snapshot(), {id(p, 1), id(p, 0)});
       }},
      {"rename", [=](const Project& p) { return renameEdit(id(p, 1), "Nordtor \xc3\xa9"); }},
      {"reorder",
       [=](const Project& p) {
         return single(ReorderScans{{id(p, 2), id(p, 0), id(p, 1)}});
       }},
      {"note", [=](const Project& p) { return noteEdit(id(p, 2), "rain\nand wind"); }},
      {"colour",
       [=](const Project& p) {
         return colourEdit(*p.snapshot(), {id(p, 0), id(p, 2)}, 0xff8800U);
       }},
      {"photograph",
       [=](const Project& p) {
         return single(
             AddPhotograph{id(p, 2), NewPhotograph{"south", "image/png", "pictures/1.png", {}, {}}});
       }},
      {"remove photograph",
       [=](const Project& p) {
         return single(RemovePhotograph{p.snapshot()->scans()[0].photographs.at(0).id});
       }},
      {"register", [](const Project& p) { return sampleRegister(p.snapshot(), 77); }},
      {"add a link by hand",
       [=](const Project& p) {
         Link link = sampleLink(id(p, 0), id(p, 2), 5);
         link.origin = LinkOrigin::ByHand;
         link.information.reset();
         return single(AddLinks{{link}, true});
       }},
      {"disable a link",
       [](const Project& p) { return linkStateEdit(p.snapshot()->links().at(0).id, LinkState::Disabled); }},
      {"delete a link",
       [=](const Project& p) { return single(DeleteLinks{{p.snapshot()->links().at(1).id}}); }},
      {"relax", [](const Project& p) { return sampleRelax(p.snapshot(), 3); }},
      {"truth",
       [=](const Project& p) {
         return posesEdit(Stage::Truth, {{id(p, 0), samplePose(4)}});
       }},
      {"clear pairwise", [=](const Project&) { return single(ClearPoses{Stage::Pairwise}); }},
      {"calibrate",
       [=](const Project& p) {
         ScannerGeometry geometry = p.snapshot()->scans()[1].geometry;
         geometry.lever_arm_m.x() = 0.5;
         return single(SetGeometry{id(p, 1), geometry});
       }},
      {"re-base", [=](const Project& p) { return must(rebaseEdit(p.snapshot(), id(p, 1), Pose())); }},
      {"survey",
       [](const Project&) {
         return surveyEdit({"car park", "A. Nother", "LMS-291", "2031-04-05"});
       }},
  };
}

TEST_F(EditTest, EveryEditIsUndoneAndRedoneAlsoAfterReopening) {
  for (const NamedEdit& named : everyEdit()) {
    SCOPED_TRACE(named.name);
    const std::string before = state();
    const Change change = must(project_->apply(named.make(*project_)));
    EXPECT_EQ(change.revision, project_->snapshot()->revision());
    const std::string after = state();
    EXPECT_NE(before, after) << "the edit did nothing";

    must(project_->undo());
    EXPECT_EQ(state(), before);
    must(project_->redo());
    EXPECT_EQ(state(), after);

    reopen();
    EXPECT_EQ(state(), after);
    must(project_->undo());
    EXPECT_EQ(state(), before);
    reopen();
    EXPECT_EQ(state(), before);
    ASSERT_TRUE(project_->snapshot()->canRedo());
    must(project_->redo());
    EXPECT_EQ(state(), after);
    must(project_->undo());
  }
  EXPECT_TRUE(project_->verify());
}

TEST_F(EditTest, AllTheWayBackAndForth) {
  std::vector<std::string> states = {state()};
  for (const NamedEdit& named : everyEdit()) {
    if (named.name == "delete" || named.name == "reorder") continue;  // made for three scans
    must(project_->apply(named.make(*project_)));
    states.push_back(state());
  }
  reopen();
  for (std::size_t i = states.size() - 1; i-- > 0;) {
    must(project_->undo());
    ASSERT_EQ(state(), states[i]) << i;
  }
  for (std::size_t i = 1; i < states.size(); ++i) {
    must(project_->redo());
    ASSERT_EQ(state(), states[i]) << i;
  }
  const auto nothing = project_->redo();
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().what, HasSubstr("nothing to redo"));
}

TEST_F(EditTest, UndoBeyondTheFirstEditIsRefused) {
  for (int i = 0; i < 3; ++i) must(project_->undo());
  EXPECT_TRUE(project_->snapshot()->scans().empty());
  const auto nothing = project_->undo();
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().what, HasSubstr("nothing to undo"));
  must(project_->redo());
  EXPECT_TRUE(must(project_->snapshot()->scans()[2].image()));
}

TEST_F(EditTest, ANewEditEndsTheRedoBranch) {
  must(project_->apply(renameEdit(id(0), "one")));
  must(project_->undo());
  EXPECT_TRUE(project_->snapshot()->canRedo());
  must(project_->apply(renameEdit(id(0), "two")));
  EXPECT_FALSE(project_->snapshot()->canRedo());
  EXPECT_FALSE(project_->redo());
  EXPECT_EQ(project_->history().back().title, "rename to two");
  EXPECT_EQ(project_->history().size(), 4U);
}

TEST_F(EditTest, HistoryTellsTitlesTimesAndWhatIsUndone) {
  const auto history = project_->history();
  ASSERT_EQ(history.size(), 3U);
  EXPECT_EQ(history[0].title, "import 3 scans");
  EXPECT_EQ(history[1].title, "register 2 pairs");
  EXPECT_THAT(history[0].time, ::testing::MatchesRegex("....-..-..T..:..:......Z"));
  EXPECT_FALSE(history[0].program_version.empty());
  must(project_->undo());
  EXPECT_TRUE(project_->history()[2].undone);
  EXPECT_FALSE(project_->history()[1].undone);
}

TEST_F(EditTest, AnEditWithoutEffectLeavesNoTrace) {
  const auto revision = project_->snapshot()->revision();
  must(project_->apply(renameEdit(id(0), "stop 1")));
  must(project_->apply(ProjectEdit{}));
  EXPECT_EQ(project_->snapshot()->revision(), revision);
  EXPECT_EQ(project_->history().size(), 3U);
}

TEST_F(EditTest, IdsAreNeverUsedAgain) {
  must(project_->apply(importEdit({sampleScan(9)})));
  const ScanId undone = id(3);
  must(project_->undo());
  must(project_->apply(importEdit({sampleScan(10)})));
  EXPECT_NE(id(3), undone);
}

TEST_F(EditTest, RefusedEditsLeaveEverythingAsItWas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose broken(Eigen::Quaterniond::Identity(), Eigen::Vector3d(nan, 0, 0));
  Link self = sampleLink(id(0), id(0));
  Link no_number = sampleLink(id(0), id(1));
  no_number.rms_m = nan;
  Link broken_link = sampleLink(id(0), id(1));
  broken_link.fixed_from_moving = broken;
  ScannerGeometry other_size;
  Scan bad_geometry = sampleScan(7);
  bad_geometry.geometry.tilt_step_rad = 0.0;
  AddScan fails;
  fails.scan = sampleScan(8);
  fails.scan.image = nullptr;
  fails.load_image = []() -> Result<RangeImagePtr> { return fail("unreadable", "x.pcd", "try another"); };
  const std::vector<EditStep> steps = {
      RenameScan{99, "x"},
      SetNote{-1, "x"},  // a placeholder, but the edit adds nothing
      DeleteScans{{99}},
      DeleteScans{{id(0), id(0)}},
      ReorderScans{{id(0), id(1)}},
      ReorderScans{{id(0), id(1), id(1)}},
      SetGeometry{id(0), other_size},
      AddScan{bad_geometry, {}, {}, {}, {}},
      fails,
      AddPhotograph{id(0), {}},
      AddPhotograph{99, NewPhotograph{"", "", "a.jpg", {}, {}}},
      RemovePhotograph{99},
      AddLinks{{self}, true},
      AddLinks{{no_number}, true},
      AddLinks{{broken_link}, true},
      AddLinks{{sampleLink(id(0), 99)}, true},
      DeleteLinks{{99}},
      SetLinkState{99, LinkState::Disabled},
      SetPoses{Stage::Relaxed, {{id(0), broken}}},
      SetPoses{Stage::Relaxed, {{99, Pose()}}},
      ClearPoses{Stage::Odometry},
  };
  const std::string before = state();
  const auto history = project_->history().size();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    SCOPED_TRACE("step " + std::to_string(i));
    // Something that works before it: all or nothing.
    ProjectEdit edit{"test",
                     {RenameScan{id(1), "changed"}, AddScan{sampleScan(20), {}, {}, {}, {}}, steps[i]},
                     nullptr,
                     {},
                     {}};
    if (i == 1) edit.steps = {steps[i]};
    const auto result = project_->apply(edit);
    ASSERT_FALSE(result);
    EXPECT_FALSE(result.error().what.empty());
    EXPECT_FALSE(result.error().where.empty());
    EXPECT_FALSE(result.error().remedy.empty());
    EXPECT_EQ(state(), before);
  }
  reopen();
  EXPECT_EQ(state(), before);
  EXPECT_EQ(project_->history().size(), history);
}

TEST_F(EditTest, ScansAndTheirLinksInOneEdit) {
  ProjectEdit edit{"survey", {}, nullptr, {}, {}};
  AddScan first{sampleScan(11), {}, {{Stage::Truth, samplePose(1)}}, "a note", {}};
  edit.steps = {first, AddScan{sampleScan(12), {}, {}, {}, {}},
                AddLinks{{sampleLink(addedScan(0), addedScan(1))}, true},
                SetPoses{Stage::Pairwise, {{addedScan(1), samplePose(2)}}}};
  const Change change = must(project_->apply(edit));
  ASSERT_EQ(change.scans_added.size(), 2U);
  const auto snapshot = project_->snapshot();
  EXPECT_EQ(snapshot->links().back().fixed, change.scans_added[0]);
  EXPECT_EQ(snapshot->links().back().moving, change.scans_added[1]);
  EXPECT_EQ(text(*snapshot->find(change.scans_added[1])->pose(Stage::Pairwise)), text(samplePose(2)));
  EXPECT_EQ(snapshot->find(change.scans_added[0])->note, "a note");
  EXPECT_TRUE(snapshot->find(change.scans_added[0])->pose(Stage::Truth));
}

TEST_F(EditTest, RegisteringAgainReplacesItsOwnLinksOnly) {
  Link by_hand = sampleLink(id(1), id(0), 40);
  by_hand.origin = LinkOrigin::ByHand;
  must(project_->apply(single(AddLinks{{by_hand}, true})));
  must(project_->apply(sampleRelax(project_->snapshot())));
  ASSERT_EQ(project_->snapshot()->links().size(), 3U);
  // The same pair the other way round.
  const Change change = must(project_->apply(registerEdit(
      project_->snapshot(), {sampleLink(id(1), id(0), 41)}, {{id(0), Pose()}, {id(1), samplePose(6)}})));
  EXPECT_EQ(change.links_added.size(), 1U);
  EXPECT_EQ(change.links_removed.size(), 1U);
  EXPECT_EQ(project_->snapshot()->links().size(), 3U);
  EXPECT_FALSE(project_->snapshot()->hasStage(Stage::Relaxed)) << "relaxed from links that are gone";
}

TEST_F(EditTest, ChangeNamesWhatChanged) {
  Change change = must(project_->apply(single(ReorderScans{{id(1), id(0), id(2)}})));
  EXPECT_TRUE(change.order_changed);
  EXPECT_TRUE(change.scans_changed.empty());
  change = must(project_->apply(renameEdit(id(1), "x")));
  EXPECT_FALSE(change.order_changed);
  EXPECT_EQ(change.scans_changed, std::vector{id(1)});
  EXPECT_TRUE(change.stages_changed.empty());
  change = must(project_->apply(surveyEdit({"a", "b", "c", "d"})));
  EXPECT_TRUE(change.survey_changed);
  EXPECT_EQ(project_->snapshot()->survey().operator_name, "b");
  change = must(project_->apply(linkStateEdit(project_->snapshot()->links()[0].id, LinkState::Disabled)));
  EXPECT_EQ(change.links_changed.size(), 1U);
  EXPECT_FALSE(project_->snapshot()->links()[0].usable());
  const ScanId gone = id(2);
  change = must(project_->apply(deleteEdit(*project_->snapshot(), {gone})));
  EXPECT_EQ(change.scans_removed, std::vector{gone});
  change = must(project_->undo());
  EXPECT_EQ(change.scans_added, std::vector{gone});
}

TEST_F(EditTest, RebaseMovesEachStageAsAWhole) {
  must(project_->apply(sampleRelax(project_->snapshot())));
  const auto before = project_->snapshot();
  must(project_->apply(must(rebaseEdit(before, id(1), Pose()))));
  const auto after = project_->snapshot();
  for (const Stage stage : {Stage::Odometry, Stage::Pairwise, Stage::Relaxed}) {
    const auto old = before->poses(stage), now = after->poses(stage);
    EXPECT_EQ(text(*now[1]), text(Pose()));
    for (const std::size_t i : {0U, 2U}) {
      const auto d = difference(now[1]->inverse() * *now[i], old[1]->inverse() * *old[i]);
      EXPECT_LT(d.translation_m, 1e-9);
      EXPECT_LT(d.rotation_rad, 1e-9);
    }
  }
  EXPECT_FALSE(rebaseEdit(after, 99, Pose()));
}

TEST_F(EditTest, PhotographsComeBack) {
  reopen();
  const ScanEntry scan = project_->snapshot()->scans()[0];
  ASSERT_EQ(scan.photographs.size(), 1U);
  EXPECT_EQ(scan.photographs[0].bytes, 5U);
  EXPECT_EQ(must(scan.photographBytes(scan.photographs[0].id)),
            (std::vector<unsigned char>{1, 2, 3, 0, 255}));
  EXPECT_FALSE(scan.photographBytes(99));
  EXPECT_FALSE(project_->snapshot()->scans()[1].photographBytes(scan.photographs[0].id));
}

TEST_F(EditTest, ResultsOfAnOlderStateAreRefusedOnlyWhereItMatters) {
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

TEST_F(EditTest, CopyAndSaveAsKeepHistory) {
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

TEST_F(EditTest, CompactGivesSpaceBackAndKeepsWhatIsVisible) {
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

TEST_F(EditTest, MergeBringsEverythingAndIsUndone) {
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
TEST_F(EditTest, MergeKnowsWhereTheOtherStandsIfBothTellTheirSite) {
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

TEST_F(EditTest, AnAcceptedLinkIsAPersonsOwn) {
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

TEST_F(EditTest, CaptureStoresLineByLine) {
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
