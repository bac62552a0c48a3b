// Every edit, its undo and redo, also after reopening; what is refused and leaves things as they were.
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/edited_project.h"

namespace tiltmap {
namespace {

using namespace test;
using ::testing::HasSubstr;

using EditTest = EditedProject;

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
      {"mask cells",
       [=](const Project& p) {
         const ScanEntry& scan = p.snapshot()->scans()[1];
         return single(SetBodyMask{scan.id, CellMask{scan.rows, scan.columns, {{0, 0, 1}, {1, 1, 1}}}});
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
      SetBodyMask{id(0), CellMask{1, 1, {{0, 0, 0}}}},
      SetBodyMask{id(0), CellMask{0, 0, {}}},
      SetBodyMask{99, std::nullopt},
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

}  // namespace
}  // namespace tiltmap
