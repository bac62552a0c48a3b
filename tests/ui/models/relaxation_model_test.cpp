// Relaxations of a window: watched, paused, cancelled, decided; without a widget.
#include "ui/models/relaxation_model.h"

#include "core/project/operations/relax_operation.h"
#include "tests/ui/models/model_samples.h"
#include "ui/models/job_list_model.h"
#include "ui/models/relaxation_table_model.h"

namespace tiltmap::test {

using namespace ui;

class RelaxationModelTest : public WorkspaceTest {
 protected:
  void SetUp() override {
    must(workspace.session().create(qt(folder / "survey.tiltmap")));
    runNow("simulate", {{"experiment", std::string("exp1")}, {"stops", 4LL}});
    runNow("register", {});
  }
  void runNow(const std::string& operation, const ParameterValues& values) {
    JobRequest request;
    request.operation = operations().find(operation);
    request.values = values;
    const int job = *workspace.start(request);
    ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->over(); }));
    ASSERT_EQ(workspace.jobs().find(job)->phase, JobPhase::Accepted);
  }
  int relax(const QString& preset = "default", bool ask = true) {
    JobRequest request;
    request.operation = operations().find("relax");
    request.preset = preset;
    request.ask = ask;
    return workspace.start(request).value_or(-1);
  }
  bool proposed() {
    return waitUntil([&] { return model().isProposal(); });
  }
  // Paused and at rest, with everything told that came before.
  bool held() {
    const bool came = waitUntil([&] { return model().isHolding() || model().isProposal(); });
    QCoreApplication::processEvents();
    return came && model().isHolding();
  }
  RelaxationModel& model() { return workspace.relaxation(); }
  JobPhase phase(int job) { return workspace.jobs().find(job)->phase; }
  // As `tiltmap relax` computes them.
  std::vector<Pose> plainly(const std::string& preset) {
    const Operation& operation = *operations().find("relax");
    const auto values = must(operation.completed(preset, {}));
    const auto result = must(operation.run(workspace.snapshot(), values, {}));
    for (const EditStep& step : result.edit.steps)
      if (const auto* set = std::get_if<SetPoses>(&step)) {
        std::vector<Pose> poses;
        for (const auto& [scan, pose] : set->poses) poses.push_back(pose);
        return poses;
      }
    return {};
  }
};

TEST_F(RelaxationModelTest, TheResultIsAProposalUntilItIsAccepted) {
  for (const char* preset : {"default", "thesis"}) {
    const auto plain = plainly(preset);
    const auto revision = snapshot().revision();
    const int job = relax(preset);
    ASSERT_TRUE(proposed());
    EXPECT_EQ(snapshot().revision(), revision) << "nothing is stored yet";
    EXPECT_EQ(model().scans().size(), 4U);
    EXPECT_GT(model().step(), 0);
    EXPECT_FALSE(model().log().isEmpty());
    EXPECT_EQ(model().poses(), plain) << preset << ": the same bits as the command";
    ASSERT_TRUE(workspace.display().isProposal());
    EXPECT_EQ(workspace.display().placedStage(), Stage::Relaxed);
    EXPECT_EQ(workspace.display().placed()->filledPoses(Stage::Relaxed), plain);
    model().showBefore(true);
    EXPECT_EQ(workspace.display().placed()->filledPoses(Stage::Relaxed), model().startPoses());
    model().accept();
    EXPECT_EQ(phase(job), JobPhase::Accepted);
    EXPECT_EQ(snapshot().filledPoses(Stage::Relaxed), plain);
    EXPECT_FALSE(workspace.display().isProposal());
    EXPECT_EQ(snapshot().jobs().back().operation, "relax");
    must(workspace.session().undo());
    EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
  }
}

TEST_F(RelaxationModelTest, DiscardLeavesNoTrace) {
  const std::string before = visibleState(snapshot());
  const auto revision = snapshot().revision();
  const int job = relax();
  ASSERT_TRUE(proposed());
  model().discard();
  EXPECT_EQ(phase(job), JobPhase::Discarded);
  EXPECT_EQ(snapshot().revision(), revision);
  EXPECT_EQ(visibleState(snapshot()), before);
  EXPECT_FALSE(workspace.display().isProposal());
  EXPECT_FALSE(workspace.display().hasRoles());
}

TEST_F(RelaxationModelTest, PausedItHoldsAndGoesOnToTheSameResult) {
  const auto plain = plainly("thesis");
  relax("thesis");
  model().pause();
  EXPECT_TRUE(model().isPaused());
  ASSERT_TRUE(waitUntil([&] { return model().isHolding(); }));
  const int step = model().step();
  QElapsedTimer clock;
  clock.start();
  waitUntil([&] { return clock.elapsed() > 150; });
  EXPECT_TRUE(model().isHolding());
  EXPECT_LE(model().step(), step + 1);
  model().resume();
  ASSERT_TRUE(proposed());
  EXPECT_EQ(model().poses(), plain);
}

TEST_F(RelaxationModelTest, StepByStepItComesToTheSameResult) {
  const auto plain = plainly("thesis");
  model().holdNextAt(1);
  relax("thesis");
  ASSERT_TRUE(held());
  int pauses = 0;
  for (;; ++pauses) {
    ASSERT_LT(pauses, 200);
    const int before = model().step();
    model().stepOn();
    if (!held()) break;
    EXPECT_EQ(model().step(), before + 1) << "one step more, no less and no further";
  }
  ASSERT_TRUE(proposed());
  EXPECT_GE(pauses, 3);
  EXPECT_EQ(model().poses(), plain);
}

TEST_F(RelaxationModelTest, HeldWithinAStepItShowsTheScanThatIsAligned) {
  std::vector<Pose> first;
  for (int turn = 0; turn < 2; ++turn) {
    model().holdNextAt(2);
    const int job = relax("thesis");
    ASSERT_TRUE(held());
    EXPECT_EQ(model().step(), 1);
    EXPECT_GE(model().state().aligning, 0);
    EXPECT_GT(model().state().iteration, 0);
    EXPECT_EQ(model().role(model().state().aligning), RelaxationRole::Aligning);
    if (turn == 0) first = model().poses();
    EXPECT_EQ(model().poses(), first) << "at the same place every time";
    workspace.jobs().cancel(job);
    ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->over(); }));
  }
}

TEST_F(RelaxationModelTest, AProposalIsComparedWithWhatItBeganFrom) {
  ScanDisplay& display = workspace.display();
  model().compareInView(ProposalCompare::Wipe);
  EXPECT_EQ(display.proposalCompare(), ProposalCompare::Off) << "there is nothing to compare";
  relax();
  ASSERT_TRUE(proposed());
  model().showBefore(true);
  model().compareInView(ProposalCompare::Wipe);
  EXPECT_EQ(display.proposalCompare(), ProposalCompare::Wipe);
  EXPECT_FALSE(model().showsBefore());
  EXPECT_EQ(display.placed()->filledPoses(Stage::Pairwise), model().startPoses());
  EXPECT_EQ(display.placed()->filledPoses(Stage::Relaxed), model().poses());
  model().showBefore(true);
  EXPECT_EQ(display.proposalCompare(), ProposalCompare::Off);
  model().compareInView(ProposalCompare::Blink);
  model().discard();
  EXPECT_EQ(display.proposalCompare(), ProposalCompare::Off);
}

TEST_F(RelaxationModelTest, CancelEndsAPauseAndLeavesTheProjectAsItWas) {
  const auto revision = snapshot().revision();
  const int job = relax("thesis");
  model().pause();
  ASSERT_TRUE(waitUntil([&] { return model().isHolding(); }));
  model().cancel();
  ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->over(); }));
  EXPECT_EQ(phase(job), JobPhase::Cancelled);
  EXPECT_EQ(snapshot().revision(), revision);
  EXPECT_FALSE(model().isRunning());
  EXPECT_FALSE(workspace.display().isProposal());
}

TEST_F(RelaxationModelTest, CancelledAtFiftyMomentsTheProjectIsAsItWas) {
  const std::string before = visibleState(snapshot());
  const auto revision = snapshot().revision();
  int cancelled = 0;
  for (int moment = 0; moment < 50; ++moment) {
    const int job = relax(moment % 2 == 0 ? "thesis" : "default");
    QElapsedTimer clock;
    clock.start();
    // A moment is so many rounds of the event loop and a little time: from before the first step to the end.
    waitUntil([&] { return clock.elapsed() >= 3 * moment || model().isProposal(); });
    if (moment % 5 == 0) model().pause();
    workspace.jobs().cancel(job);
    ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->over(); }));
    cancelled += phase(job) == JobPhase::Cancelled;
    EXPECT_NE(phase(job), JobPhase::Accepted);
    ASSERT_EQ(snapshot().revision(), revision) << moment;
    EXPECT_FALSE(workspace.display().isProposal()) << moment;
    EXPECT_FALSE(workspace.display().hasRoles()) << moment;
  }
  EXPECT_GT(cancelled, 0);
  EXPECT_EQ(visibleState(snapshot()), before);
  must(workspace.session().verify());
}

TEST_F(RelaxationModelTest, SeveralWaitAndEachAsksForItself) {
  JobListModel jobs(workspace.jobs());
  const int before = jobs.rowCount();
  const int first = relax(), second = relax("thesis");
  EXPECT_EQ(jobs.rowCount(), before + 2);
  EXPECT_EQ(jobs.index(before + 1, JobListModel::State).data().toString(), "queued");
  ASSERT_TRUE(proposed());
  EXPECT_EQ(phase(second), JobPhase::Queued) << "it would start from poses about to change";
  model().accept();
  EXPECT_EQ(phase(first), JobPhase::Accepted);
  ASSERT_TRUE(waitUntil([&] { return phase(second) == JobPhase::Waiting; }));
  EXPECT_EQ(model().method(), "active-set");
  model().discard();
  EXPECT_FALSE(workspace.jobs().busy());
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed)) << "what was accepted before stays";
}

TEST_F(RelaxationModelTest, OneThatIsNotAskedAboutIsWatchedAllTheSame) {
  const int job = relax("default", false);
  ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->over(); }));
  EXPECT_EQ(phase(job), JobPhase::Accepted);
  EXPECT_GT(model().step(), 0);
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_FALSE(workspace.display().isProposal());
}

TEST_F(RelaxationModelTest, ClosingInTheMiddleLosesNothing) {
  const std::string before = visibleState(snapshot());
  const int running = relax("thesis"), queued = relax("default");
  ASSERT_TRUE(waitUntil([&] { return model().isRunning(); }));
  workspace.session().close();
  EXPECT_EQ(phase(running), JobPhase::Cancelled);
  EXPECT_EQ(phase(queued), JobPhase::Cancelled);
  EXPECT_TRUE(model().scans().empty());
  must(workspace.session().open(qt(folder / "survey.tiltmap")));
  EXPECT_EQ(visibleState(snapshot()), before);
}

TEST_F(RelaxationModelTest, WrongOrderDoesNothing) {
  model().pause();
  model().resume();
  model().cancel();
  model().accept();
  model().discard();
  model().showBefore(true);
  EXPECT_FALSE(workspace.display().isProposal());
  EXPECT_FALSE(workspace.jobs().busy());
  relax();
  model().accept();  // there is nothing yet
  ASSERT_TRUE(proposed());
  model().pause();  // nothing runs any more
  EXPECT_FALSE(model().isPaused());
  model().accept();
  model().accept();
  model().discard();
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_EQ(snapshot().jobs().back().operation, "relax");
}

TEST_F(RelaxationModelTest, TheTableShowsBeforeAndAfterAndPins) {
  RelaxationTableModel table(workspace);
  EXPECT_EQ(table.source(), RelaxationTableModel::Source::Nothing);
  EXPECT_EQ(table.rowCount(), 4);
  const QModelIndex pin = table.index(2, RelaxationTableModel::Pin);
  EXPECT_EQ(pin.data(Qt::CheckStateRole).toInt(), Qt::Unchecked);
  EXPECT_TRUE(table.setData(pin, Qt::Checked, Qt::CheckStateRole));
  EXPECT_TRUE(snapshot().isPinned(id(2)));
  EXPECT_FALSE(table.setData(table.index(0, RelaxationTableModel::Pin), Qt::Unchecked, Qt::CheckStateRole))
      << "scan 0 never moves";
  relax();
  EXPECT_FALSE(table.setData(pin, Qt::Unchecked, Qt::CheckStateRole)) << "not while it runs";
  ASSERT_TRUE(proposed());
  EXPECT_EQ(table.source(), RelaxationTableModel::Source::Proposal);
  EXPECT_EQ(table.moved_m(2), 0.0);
  EXPECT_GT(table.moved_m(3), 0.0);
  EXPECT_TRUE(table.truthKnown()) << "that of a simulation is";
  EXPECT_FALSE(table.index(3, RelaxationTableModel::ErrorAfter).data().toString().isEmpty());
  EXPECT_TRUE(table.summary().contains("RMSE"));
  model().accept();
  EXPECT_EQ(table.source(), RelaxationTableModel::Source::Stages);
  EXPECT_GT(table.moved_m(3), 0.0);
  must(workspace.session().undo());
  EXPECT_TRUE(table.setData(table.index(2, RelaxationTableModel::Pin), Qt::Unchecked, Qt::CheckStateRole));
  EXPECT_TRUE(snapshot().pins().empty());
  must(workspace.session().undo());
  EXPECT_TRUE(snapshot().isPinned(id(2)));
}

TEST_F(RelaxationModelTest, RolesFollowTheSets) {
  relax("thesis");
  bool aligning = false, held = false;
  waitUntil([&] {
    if (model().isRunning() && !model().scans().empty()) {
      for (int i = 0; i < 4; ++i) aligning |= model().role(i) == RelaxationRole::Aligning;
      held |= model().role(0) == RelaxationRole::Held;
    }
    return model().isProposal();
  });
  EXPECT_TRUE(aligning);
  EXPECT_TRUE(held);
  EXPECT_FALSE(workspace.display().hasRoles()) << "a proposal has no sets";
}

}  // namespace tiltmap::test
