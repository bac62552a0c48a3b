// Work in the window: progress, cancel, close in the middle, errors where they are seen.
#include <QClipboard>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QToolButton>

#include "tests/ui/support/held_operation.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/window/message_bar.h"

namespace tiltmap::test {

using namespace ui;

class JobsTest : public WindowTest {
 protected:
  int begin(const Operation& operation, bool ask = false) {
    JobRequest request;
    request.operation = &operation;
    request.ask = ask;
    const auto id = workspace().start(request);
    EXPECT_TRUE(id);
    settle();
    return id.value_or(-1);
  }
};

TEST_F(JobsTest, TheBarShowsProgressAndCancels) {
  makeProject(1);
  HeldOperation work;
  const auto revision = snapshot().revision();
  EXPECT_FALSE(find("job-cancel")->isVisible());
  begin(work);
  auto* progress = find<QProgressBar>("job-progress");
  ASSERT_TRUE(waitUntil([&] { return progress->value() == 500; }));
  EXPECT_EQ(find<QLabel>("job-title")->text(), "Held work");
  EXPECT_TRUE(find<QLabel>("job-message")->text().contains("half way"));
  EXPECT_FALSE(isEnabled("edit.undo")) << "the project must not change under the work";
  click("job-cancel");
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(snapshot().revision(), revision);
  EXPECT_FALSE(find("job-cancel")->isVisible());
}

TEST_F(JobsTest, CancelsByShortcut) {
  makeProject(1);
  HeldOperation work;
  begin(work);
  press(QKeySequence("Ctrl+."));
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(nameOf(0), "stop 1");
}

TEST_F(JobsTest, AResultThatWaitsIsAcceptedOrDiscarded) {
  makeProject(1);
  HeldOperation work;
  work.released = true;
  begin(work, true);
  auto* accept = find<QPushButton>("job-accept");
  ASSERT_TRUE(waitUntil([&] { return accept->isVisible(); }));
  EXPECT_EQ(nameOf(0), "stop 1");
  click("job-cancel");  // Discard
  EXPECT_EQ(nameOf(0), "stop 1");
  begin(work, true);
  ASSERT_TRUE(waitUntil([&] { return accept->isVisible(); }));
  click("job-accept");
  EXPECT_EQ(nameOf(0), "renamed");
}

TEST_F(JobsTest, ClosingInTheMiddleAsksAndLosesNothing) {
  makeProject(1);
  HeldOperation work;
  begin(work);
  window->close();
  settle();
  ASSERT_TRUE(window && window->isVisible());
  EXPECT_TRUE(window->messageBar().isVisible());
  EXPECT_TRUE(workspace().jobs().busy()) << "nothing is cancelled before it is meant";
  click("message-action");
  QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  EXPECT_FALSE(window);
  const auto project = must(Project::open(folder / "survey.tiltmap", Access::ReadWrite));
  EXPECT_EQ(project->snapshot()->scans()[0].name, "stop 1");
}

TEST_F(JobsTest, ClosingTwiceIsMeant) {
  makeProject(1);
  HeldOperation work;
  begin(work);
  window->close();
  settle();
  window->close();
  QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  EXPECT_FALSE(window);
}

TEST_F(JobsTest, AFailureIsToldInTheWindowWithDetails) {
  makeProject(1);
  HeldOperation work;
  work.broken = work.released = true;
  begin(work);
  ASSERT_TRUE(waitForJobs());
  EXPECT_TRUE(find<QLabel>("message-text")->text().contains("The work failed."));
  EXPECT_TRUE(find<QLabel>("message-text")->text().contains("Try another way."));
  auto* details = find<QPlainTextEdit>("message-details-text");
  EXPECT_FALSE(details->isVisible());
  click("message-details");
  EXPECT_TRUE(details->isVisible());
  EXPECT_EQ(details->toPlainText(), "Where: here");
  click("message-copy");
  EXPECT_TRUE(QApplication::clipboard()->text().contains("Try another way."));
  workspace().messages().note("something small");
  EXPECT_TRUE(find<QLabel>("message-text")->text().contains("The work failed."))
      << "errors stay until closed";
  click("message-close");
  EXPECT_FALSE(window->messageBar().isVisible());
}

TEST_F(JobsTest, ManyCancelsAtDifferentMomentsLeaveTheProjectAsItWas) {
  makeProject(0);
  const auto revision = snapshot().revision();
  for (int moment = 0; moment < 12; ++moment) {
    JobRequest request;
    request.operation = operations().find("simulate");
    request.values = {{"experiment", std::string("exp1")}};
    const auto job = workspace().start(request);
    ASSERT_TRUE(job);
    QTest::qWait(moment * 7);
    workspace().jobs().cancel(*job);
    ASSERT_TRUE(waitForJobs());
    const JobPhase phase = workspace().jobs().find(*job)->phase;
    if (phase == JobPhase::Accepted) must(workspace().session().undo());  // it was faster
    EXPECT_TRUE(snapshot().scans().empty());
  }
  EXPECT_GE(snapshot().revision(), revision);
  must(workspace().session().verify());
}

}  // namespace tiltmap::test
