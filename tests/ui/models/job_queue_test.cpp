#include "tests/ui/models/model_samples.h"
#include "tests/ui/support/held_operation.h"

namespace tiltmap::test {

using namespace ui;

class JobQueueTest : public WorkspaceTest {
 protected:
  JobRequest request(const Operation& operation, bool ask = false) {
    JobRequest r;
    r.operation = &operation;
    r.ask = ask;
    return r;
  }
  bool over(int job) {
    return waitUntil([&] { return workspace.jobs().find(job)->over(); });
  }
  JobPhase phase(int job) { return workspace.jobs().find(job)->phase; }
};

TEST_F(JobQueueTest, StoresTheResultAndShowsProgressOnTheWay) {
  makeProject(1);
  HeldOperation work;
  const int job = *workspace.start(request(work));
  ASSERT_TRUE(waitUntil([&] { return workspace.jobs().current()->fraction == 0.5; }));
  EXPECT_EQ(workspace.jobs().current()->message, "half way");
  EXPECT_TRUE(workspace.jobs().busy());
  work.released = true;
  ASSERT_TRUE(over(job));
  EXPECT_EQ(phase(job), JobPhase::Accepted);
  EXPECT_EQ(nameOf(0), "renamed");
  EXPECT_FALSE(workspace.jobs().busy());
  EXPECT_EQ(snapshot().jobs().size(), 1U);
  must(workspace.session().undo());
  EXPECT_EQ(nameOf(0), "stop 1");
}

TEST_F(JobQueueTest, TellsTheTimeLeft) {
  makeProject(1);
  HeldOperation work;
  workspace.start(request(work));
  // Half is done: as much is left as was used, once there was enough to measure.
  QElapsedTimer clock;
  clock.start();
  ASSERT_TRUE(waitUntil([&] { return clock.elapsed() > 700; }));
  work.released = true;
  std::optional<double> left;
  QObject::connect(&workspace.jobs(), &JobQueue::changed, [&](int id) {
    if (workspace.jobs().find(id)->left_s) left = workspace.jobs().find(id)->left_s;
  });
  workspace.jobs().waitForAll();
  EXPECT_FALSE(left) << "nothing is left of what has ended";
}

TEST_F(JobQueueTest, CancellingLeavesTheProjectAsItWas) {
  makeProject(1);
  HeldOperation work;
  const auto revision = snapshot().revision();
  const int job = *workspace.start(request(work));
  workspace.jobs().cancel(job);
  ASSERT_TRUE(over(job));
  EXPECT_EQ(phase(job), JobPhase::Cancelled);
  EXPECT_EQ(snapshot().revision(), revision);
}

TEST_F(JobQueueTest, AResultThatComesAfterCancellingIsNotStored) {
  makeProject(1);
  HeldOperation work;
  work.deaf = true;
  const auto revision = snapshot().revision();
  const int job = *workspace.start(request(work));
  workspace.jobs().cancel(job);
  work.released = true;
  ASSERT_TRUE(over(job));
  EXPECT_EQ(phase(job), JobPhase::Cancelled);
  EXPECT_EQ(snapshot().revision(), revision);
}

TEST_F(JobQueueTest, RunsOneAfterTheOther) {
  makeProject(1);
  HeldOperation first("first"), second("second");
  const int a = *workspace.start(request(first));
  const int b = *workspace.start(request(second));
  ASSERT_TRUE(waitUntil([&] { return first.runs == 1; }));
  EXPECT_EQ(second.runs, 0);
  EXPECT_EQ(workspace.jobs().queued(), 1);
  first.released = second.released = true;
  ASSERT_TRUE(over(a) && over(b));
  EXPECT_EQ(nameOf(0), "second");
  EXPECT_EQ(phase(b), JobPhase::Accepted) << "the second job saw what the first had stored";
}

TEST_F(JobQueueTest, ACancelledJobOfABatchTakesThoseBehindItAlong) {
  makeProject(1);
  HeldOperation first, second;
  const int a = *workspace.startAll({request(first), request(second)});
  workspace.jobs().cancel(a);
  ASSERT_TRUE(over(a) && over(a + 1));
  EXPECT_EQ(phase(a + 1), JobPhase::Cancelled);
  EXPECT_EQ(second.runs, 0);
}

TEST_F(JobQueueTest, WaitsForADecisionWhenAsked) {
  makeProject(1);
  HeldOperation work;
  work.released = true;
  const auto revision = snapshot().revision();
  const int job = *workspace.start(request(work, true));
  ASSERT_TRUE(waitUntil([&] { return phase(job) == JobPhase::Waiting; }));
  EXPECT_EQ(snapshot().revision(), revision);
  ASSERT_NE(workspace.jobs().waitingResult(job), nullptr);
  workspace.jobs().discard(job);
  EXPECT_EQ(phase(job), JobPhase::Discarded);
  EXPECT_EQ(snapshot().revision(), revision);
  const int again = *workspace.start(request(work, true));
  ASSERT_TRUE(waitUntil([&] { return phase(again) == JobPhase::Waiting; }));
  workspace.jobs().accept(again);
  EXPECT_EQ(nameOf(0), "renamed");
}

TEST_F(JobQueueTest, SaysWhyAJobFailed) {
  makeProject(1);
  HeldOperation work;
  work.broken = work.released = true;
  const int job = *workspace.start(request(work));
  ASSERT_TRUE(over(job));
  EXPECT_EQ(phase(job), JobPhase::Failed);
  ASSERT_FALSE(shown.empty());
  EXPECT_TRUE(shown.back().text.contains("The work failed"));
  EXPECT_TRUE(shown.back().remedy.contains("Try another way"));
}

TEST_F(JobQueueTest, ShowsWarningsOfWhatSucceeded) {
  makeProject(1);
  HeldOperation work;
  work.released = true;
  work.warnings = {"scan 0 is thin", "scan 1 is thin"};
  ASSERT_TRUE(over(*workspace.start(request(work))));
  EXPECT_EQ(shown.back().kind, MessageKind::Warning);
  EXPECT_TRUE(shown.back().details.contains("scan 1 is thin"));
}

TEST_F(JobQueueTest, WhatTheCheckRefusesIsNotQueued) {
  makeProject(0);
  HeldOperation work;
  EXPECT_FALSE(workspace.start(request(work)));
  EXPECT_FALSE(workspace.jobs().busy());
  EXPECT_TRUE(workspace.jobs().jobs().empty());
  EXPECT_EQ(shown.back().kind, MessageKind::Error);
}

TEST_F(JobQueueTest, ClosingTheProjectInTheMiddleStopsTheWork) {
  makeProject(1);
  HeldOperation first, second;
  const int a = *workspace.start(request(first));
  const int b = *workspace.start(request(second));
  ASSERT_TRUE(waitUntil([&] { return first.runs == 1; }));
  workspace.session().close();
  EXPECT_EQ(phase(a), JobPhase::Cancelled);
  EXPECT_EQ(phase(b), JobPhase::Cancelled);
  EXPECT_FALSE(workspace.jobs().busy());
  must(workspace.session().open(qt(folder / "survey.tiltmap")));
  EXPECT_EQ(nameOf(0), "stop 1");
}

TEST_F(JobQueueTest, TakesTheThreadsThatTheUserPrefers) {
  makeProject(2);
  preferences.setThreads(1);
  JobRequest r = request(*operations().find("register"));
  const int job = *workspace.start(r);
  ASSERT_TRUE(over(job));
  if (phase(job) == JobPhase::Accepted) {
    EXPECT_EQ(std::get<long long>(snapshot().jobs().back().values.at("threads")), 1);
  }
}

}  // namespace tiltmap::test
