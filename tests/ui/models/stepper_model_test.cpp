// The stepper without widgets: choice, stepping, running, acceptance, starts by hand.
#include "ui/models/stepper_model.h"

#include <fstream>

#include <nlohmann/json.hpp>

#include "core/project/judgement_json.h"
#include "core/project/link_judgement.h"
#include "core/project/operations/pair_links.h"
#include "core/world/experiment.h"
#include "tests/ui/models/model_samples.h"
#include "ui/models/step_table_model.h"

namespace tiltmap::test {
namespace {

// Simulated once: three stops of the second experiment.
const std::vector<SimulatedStop>& stops() {
  static const std::vector<SimulatedStop> made = must(simulateExperiment(ExperimentId::Exp2Fixed, 1, 3, 2));
  return made;
}

class StepperModelTest : public WorkspaceTest {
 protected:
  void SetUp() override {
    must(workspace.session().create(ui::qt(folder / "s.tiltmap")));
    std::vector<Scan> scans;
    for (const SimulatedStop& stop : stops()) scans.push_back(stop.scan);
    must(workspace.session().apply(importEdit(std::move(scans))));
    stepper().setPace(0);
  }
  ui::StepperModel& stepper() { return workspace.stepper(); }
  void runToEnd() {
    stepper().run();
    ASSERT_TRUE(waitUntil([this] { return stepper().isEnded(); }));
  }
  void stepOnce() {
    const int before = stepper().position();
    stepper().step();
    ASSERT_TRUE(waitUntil([&] { return stepper().position() == before + 1; }));
  }
  PairResult byCore(const Pose& start) {
    const RegistrationSettings settings = stepper().scans()->settings();
    return must(registerPair(must(snapshot().scans()[0].scan()), must(snapshot().scans()[1].scan()), start,
                             settings));
  }
  std::string bytes() {
    std::ifstream in(folder / "s.tiltmap", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(StepperModelTest, TheFirstTwoScansAreChosenAndTheRolesAreNamed) {
  EXPECT_EQ(stepper().fixed(), id(0));
  EXPECT_EQ(stepper().moving(), id(1));
  EXPECT_TRUE(stepper().isReady());
  EXPECT_TRUE(stepper().scanName(true).startsWith("scan 0"));
  stepper().swapScans();
  EXPECT_EQ(stepper().fixed(), id(1));
  EXPECT_TRUE(stepper().scanName(false).startsWith("scan 0"));
}

TEST_F(StepperModelTest, SteppingAndRunningGiveTheBitsOfRegisterPair) {
  const PairResult whole = byCore(stepper().start().start());
  for (int k = 0; k < 3; ++k) stepOnce();
  EXPECT_EQ(stepper().pose(), whole.steps[2].fixed_from_moving);
  runToEnd();
  EXPECT_EQ(stepper().count(), static_cast<int>(whole.steps.size()));
  EXPECT_EQ(stepper().result()->fixed_from_moving, whole.fixed_from_moving);
  EXPECT_EQ(stepper().result()->information, whole.information);
  for (int k = 1; k <= stepper().count(); ++k) {
    stepper().goTo(k);
    EXPECT_EQ(stepper().pose(), whole.steps[static_cast<std::size_t>(k - 1)].fixed_from_moving);
  }
}

TEST_F(StepperModelTest, BackIsExactAndForwardAgainComputesNothing) {
  for (int k = 0; k < 4; ++k) stepOnce();
  const Pose last = stepper().pose();
  const std::size_t pairs = stepper().pairs().size();
  const auto kept = stepper().steps();
  stepper().back();
  stepper().back();
  EXPECT_EQ(stepper().position(), 2);
  EXPECT_EQ(stepper().pose(), kept[1]->report.fixed_from_moving);
  EXPECT_EQ(stepper().poseBefore(), kept[0]->report.fixed_from_moving);
  EXPECT_EQ(stepper().pairs().size(), kept[1]->pairs.size());
  stepper().step();
  stepper().step();
  EXPECT_FALSE(stepper().isWorking());
  EXPECT_EQ(stepper().pose(), last);
  EXPECT_EQ(stepper().pairs().size(), pairs);
  EXPECT_EQ(stepper().steps(), kept);
  for (int k = 0; k < 9; ++k) stepper().back();
  EXPECT_EQ(stepper().position(), 0);
  EXPECT_EQ(stepper().current(), nullptr);
  EXPECT_EQ(stepper().pose(), stepper().start().start());
}

TEST_F(StepperModelTest, RunPausesAndGoesOn) {
  stepper().setPace(5);
  stepper().run();
  ASSERT_TRUE(waitUntil([this] { return stepper().count() >= 2; }));
  stepper().pause();
  EXPECT_FALSE(stepper().isRunning());
  ASSERT_TRUE(waitUntil([this] { return !stepper().isWorking(); }));
  const int paused = stepper().count();
  QElapsedTimer clock;
  clock.start();
  while (clock.elapsed() < 60) QCoreApplication::processEvents();
  EXPECT_EQ(stepper().count(), paused);
  EXPECT_FALSE(stepper().isEnded());
  EXPECT_TRUE(stepper().stateSentence().startsWith("Paused"));
  runToEnd();
  EXPECT_EQ(stepper().result()->fixed_from_moving, byCore(stepper().start().start()).fixed_from_moving);
  EXPECT_FALSE(stepper().canStep());
  EXPECT_FALSE(stepper().isRunning());
}

TEST_F(StepperModelTest, StepsAskedForFasterThanTheyAreComputedAllCome) {
  for (int k = 0; k < 5; ++k) stepper().step();
  ASSERT_TRUE(waitUntil([this] { return stepper().count() == 5 && !stepper().isWorking(); }));
  EXPECT_EQ(stepper().position(), 5);
}

TEST_F(StepperModelTest, AnotherPairPresetOrStartStartsOver) {
  const auto begun = [this] {
    stepOnce();
    return stepper().count() == 1;
  };
  ASSERT_TRUE(begun());
  stepper().parameters().setPreset("thesis");
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_EQ(stepper().scans()->settings().motion, MotionMethod::Svd);
  ASSERT_TRUE(begun());
  stepper().parameters().setValueText("max-iterations", "3");
  EXPECT_EQ(stepper().count(), 0);
  runToEnd();
  EXPECT_EQ(stepper().count(), 3);
  stepper().start().nudge({0.1, 0.0, 0.0}, 0.0);
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_FALSE(stepper().isEnded());
  ASSERT_TRUE(begun());
  stepper().choose(id(1), id(2));
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_FALSE(stepper().start().byHand());
}

TEST_F(StepperModelTest, WrongChoicesAreToldAndDoNothing) {
  stepper().choose(id(1), id(1));
  EXPECT_FALSE(stepper().isReady());
  EXPECT_TRUE(stepper().problem().contains("itself"));
  stepper().step();
  stepper().run();
  stepper().back();
  stepper().goTo(7);
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_FALSE(stepper().isWorking());
  EXPECT_FALSE(stepper().accept());
  stepper().choose(id(0), id(1));
  EXPECT_TRUE(stepper().isReady());
  stepper().parameters().setValueText("max-iterations", "many");
  EXPECT_TRUE(stepper().problem().contains("parameters"));
  stepper().parameters().resetAll();
  // The preset's patches with a closed form make no sense; said in words before a step is tried.
  stepper().parameters().setValueText("motion", "svd");
  EXPECT_FALSE(stepper().isReady());
  EXPECT_TRUE(stepper().problem().contains("closed form"));
}

TEST_F(StepperModelTest, AcceptStoresOneUndoableLink) {
  stepOnce();
  EXPECT_FALSE(stepper().canAccept());
  EXPECT_FALSE(stepper().judgement()) << "not before the end";
  runToEnd();
  stepper().goTo(1);  // whichever iteration is shown
  ASSERT_TRUE(stepper().canAccept());
  must(stepper().accept());
  ASSERT_EQ(snapshot().links().size(), 1U);
  EXPECT_EQ(snapshot().links()[0].fixed_from_moving, stepper().result()->fixed_from_moving);
  // Judged, and with the very figures that judging the project's links gives.
  ASSERT_TRUE(snapshot().links()[0].judgement && stepper().judgement());
  EXPECT_EQ(stepper().judgement()->verdict, Verdict::Good) << stepper().judgement()->reason;
  EXPECT_TRUE(sameJudgement(snapshot().links()[0].judgement.get(), stepper().judgement().get()));
  EXPECT_EQ(judgementJson(must(judgeLinkScans(snapshot()))[0].judgement),
            judgementJson(*stepper().judgement()));
  EXPECT_EQ(snapshot().links()[0].origin, LinkOrigin::Automatic);
  EXPECT_TRUE(snapshot().hasStage(Stage::Pairwise));
  EXPECT_TRUE(stepper().isStored());
  EXPECT_FALSE(stepper().canAccept());
  EXPECT_EQ(stepper().position(), 1);  // the iterations stay to be looked at
  must(workspace.session().undo());
  EXPECT_TRUE(snapshot().links().empty());
  EXPECT_TRUE(stepper().canAccept());
}

TEST_F(StepperModelTest, DiscardAndCancelInTheMiddleLeaveNoTraceInTheFile) {
  const std::string before = bytes();
  for (int moment = 0; moment < 50; ++moment) {
    stepper().run();
    for (int k = 0; k < moment; ++k) QCoreApplication::processEvents(QEventLoop::AllEvents, 1);
    stepper().discard();
    EXPECT_EQ(stepper().count(), 0);
    EXPECT_EQ(stepper().position(), 0);
    EXPECT_FALSE(stepper().isRunning());
  }
  QCoreApplication::processEvents();
  EXPECT_EQ(stepper().count(), 0);
  runToEnd();
  stepper().discard();
  EXPECT_FALSE(stepper().isEnded());
  EXPECT_EQ(bytes(), before);
}

TEST_F(StepperModelTest, ADeletedScanEndsTheSession) {
  stepOnce();
  must(workspace.session().apply(deleteEdit(snapshot(), {id(1)})));
  EXPECT_EQ(stepper().count(), 0);
  EXPECT_FALSE(stepper().isReady());
  must(workspace.session().undo());
  workspace.session().close();
  EXPECT_FALSE(stepper().isReady());
  EXPECT_EQ(stepper().scans(), nullptr);
  EXPECT_TRUE(stepper().problem().contains("No project"));
}

TEST_F(StepperModelTest, ARenameKeepsTheIterations) {
  for (int k = 0; k < 2; ++k) stepOnce();
  must(workspace.session().apply(renameEdit(id(1), "by the wall")));
  EXPECT_EQ(stepper().count(), 2);
  EXPECT_TRUE(stepper().scanName(false).contains("by the wall"));
}

TEST_F(StepperModelTest, APickedPairIsExplainedUntilThePositionChanges) {
  stepOnce();
  EXPECT_TRUE(stepper().pickedSentence().isEmpty());
  stepper().pick(0);
  EXPECT_TRUE(stepper().pickedSentence().endsWith("."));
  stepper().pick(stepper().pairs().size());
  EXPECT_FALSE(stepper().picked());
  stepper().pick(0);
  stepOnce();
  EXPECT_FALSE(stepper().picked());
}

TEST_F(StepperModelTest, TheTableHasARowAnIteration) {
  ui::StepTableModel table(stepper());
  runToEnd();
  ASSERT_EQ(table.rowCount(), stepper().count());
  const auto cell = [&](int row, int column) {
    return table.data(table.index(row, column), Qt::DisplayRole).toString();
  };
  EXPECT_EQ(cell(0, ui::StepTableModel::Iteration), "1");
  EXPECT_EQ(cell(0, ui::StepTableModel::Scale), "2000.0");
  const StepReport& second = stepper().steps()[1]->report;
  EXPECT_EQ(cell(1, ui::StepTableModel::Rms), QString::number(1e3 * second.rms_m, 'f', 2));
  EXPECT_EQ(cell(1, ui::StepTableModel::Kept), QString::number(second.pairs));
  for (int column = 0; column < table.columnCount(); ++column)
    EXPECT_FALSE(table.headerData(column, Qt::Horizontal, Qt::DisplayRole).toString().isEmpty());
  stepper().discard();
  EXPECT_EQ(table.rowCount(), 0);
}

TEST_F(StepperModelTest, NothingIsAcceptedWhileTheProjectIsAtWork) {
  runToEnd();
  ASSERT_TRUE(stepper().canAccept());
  ui::JobRequest request;
  request.operation = operations().find("relax");
  request.ask = true;
  const int job = *workspace.start(request);
  EXPECT_FALSE(stepper().canAccept());
  EXPECT_TRUE(stepper().acceptHint().contains("Other work"));
  EXPECT_FALSE(stepper().accept());
  ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->phase == ui::JobPhase::Waiting; }));
  EXPECT_FALSE(stepper().canAccept()) << "the proposal was made from the poses as they are";
  workspace.jobs().discard(job);
  EXPECT_TRUE(stepper().canAccept());
  must(stepper().accept());
}

class StartModelTest : public StepperModelTest {
 protected:
  ui::StartModel& start() { return stepper().start(); }
};

TEST_F(StartModelTest, NudgesShiftAndTurnAndResetGoesBack) {
  const Pose odometry = start().start();
  EXPECT_EQ(odometry, odometryStart(snapshot().scans()[0], snapshot().scans()[1]));
  start().nudge({0.1, -0.2, 0.3}, 0.0);
  EXPECT_TRUE(start().byHand());
  EXPECT_LT((start().start().translation() - odometry.translation() - Eigen::Vector3d(0.1, -0.2, 0.3)).norm(),
            1e-12);
  start().nudge(Eigen::Vector3d::Zero(), 0.1);
  EXPECT_NEAR(difference(start().start(), odometry).rotation_rad, 0.1, 1e-12);
  EXPECT_LT(difference(start().start(), turnedStart(odometry, 0.1)).rotation_rad, 1e-12);
  start().reset();
  EXPECT_EQ(start().start(), odometry);
  EXPECT_FALSE(start().byHand());
}

TEST_F(StartModelTest, TheGhostIsTheResultOfTheLatestStart) {
  start().setGhostWanted(true);
  for (int k = 0; k < 20; ++k) start().nudge({0.01, 0.0, 0.0}, 0.002);
  ASSERT_TRUE(waitUntil([this] { return start().ghost().has_value() && !start().ghostBusy(); }));
  EXPECT_EQ(start().ghost()->fixed_from_moving, byCore(start().start()).fixed_from_moving);
  EXPECT_EQ(start().ghost()->steps.front().motion.translation().allFinite(), true);
  start().setGhostWanted(false);
  EXPECT_FALSE(start().ghost());
}

TEST_F(StartModelTest, TheGhostFollowsWhileTheStartIsStillMoved) {
  start().setGhostWanted(true);
  int ghosts = 0, moves = 0;
  Pose before;
  // Without a pause between two moves, as a drag has none.
  ASSERT_TRUE(waitUntil([&] {
    start().nudge({0.002, 0.0, 0.0}, 0.0);
    ++moves;
    if (start().ghost() && !(start().ghost()->fixed_from_moving == before)) {
      before = start().ghost()->fixed_from_moving;
      ++ghosts;
    }
    return ghosts == 3;
  }));
  EXPECT_GT(moves, 3);
  ASSERT_TRUE(waitUntil([this] { return !start().ghostBusy(); }));
  EXPECT_EQ(start().ghost()->fixed_from_moving, byCore(start().start()).fixed_from_moving)
      << "and ends at that of the last";
  stepper().choose(id(0), id(2));
  EXPECT_FALSE(start().ghost()) << "that was another pair";
}

TEST_F(StartModelTest, PointPairsInAnyOrderGiveAStart) {
  const Pose truth = stops()[0].truth.inverse() * stops()[1].truth;
  const Eigen::Vector3d points[] = {{1, 4, 0}, {-2, 5, 1}, {3, 8, -1}};
  EXPECT_TRUE(start().nextIsFixed());
  EXPECT_FALSE(start().usePointPairs());
  for (const Eigen::Vector3d& p : points) {
    // The moving side first, and once more: the second click of one side takes the place of the first.
    start().addPoint(false, p + Eigen::Vector3d(9, 9, 9));
    EXPECT_TRUE(start().nextIsFixed());
    start().addPoint(false, p);
    EXPECT_FALSE(start().pointPairFit());
    start().addPoint(true, truth * p);
  }
  ASSERT_EQ(start().pointPairs().size(), 3U);
  ASSERT_TRUE(start().pointPairFit());
  EXPECT_LT(start().pointPairFit()->rms_m, 1e-9);
  EXPECT_TRUE(start().usePointPairs());
  EXPECT_LT(difference(start().start(), truth).translation_m, 1e-9);
  EXPECT_TRUE(start().byHand());
  start().removePointPair(7);
  start().removePointPair(0);
  EXPECT_EQ(start().pointPairs().size(), 2U);
  EXPECT_FALSE(start().usePointPairs());
  runToEnd();
  must(stepper().accept());
  EXPECT_EQ(snapshot().links()[0].origin, LinkOrigin::ByHand);
}

TEST_F(StartModelTest, TheSweepFindsATurnedStart) {
  const Pose odometry = start().start();
  EXPECT_FALSE(start().useBestHeading());
  start().nudge(Eigen::Vector3d::Zero(), 75.0 * kDegree);
  start().sweepHeadings();
  ASSERT_TRUE(waitUntil([this] { return start().sweep().has_value(); }));
  EXPECT_TRUE(start().useBestHeading());
  EXPECT_LT(difference(start().start(), odometry).rotation_rad, 10.0 * kDegree);
  runToEnd();
  const Pose truth = stops()[0].truth.inverse() * stops()[1].truth;
  EXPECT_LT(difference(stepper().result()->fixed_from_moving, truth).translation_m, 0.02);
}

TEST(BackgroundWorker, OnlyTheLatestCounts) {
  ui::BackgroundWorker worker;
  std::vector<int> told;
  for (int k = 0; k < 200; ++k)
    worker.start([k, &told](const std::stop_token&) -> ui::BackgroundWorker::Done {
      return [k, &told] { told.push_back(k); };
    });
  ASSERT_TRUE(waitUntil([&] { return !worker.busy(); }));
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back(), 199);
  const std::size_t before = told.size();
  worker.start([&told](const std::stop_token&) -> ui::BackgroundWorker::Done {
    return [&told] { told.push_back(-1); };
  });
  worker.cancel();
  EXPECT_FALSE(worker.busy());
  QElapsedTimer clock;
  clock.start();
  while (clock.elapsed() < 30) QCoreApplication::processEvents();
  EXPECT_EQ(told.size(), before);
}

}  // namespace
}  // namespace tiltmap::test
