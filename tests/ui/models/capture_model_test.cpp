#include "ui/models/capture_model.h"

#include <algorithm>
#include <cstdio>

#include "tests/ui/models/model_samples.h"

namespace tiltmap::test {
namespace {

using ui::CaptureModel;

class CaptureModelTest : public WorkspaceTest {
 protected:
  CaptureModelTest() : model(ui::captureModel(workspace)) { model.parameters().setValue("lines", 8LL); }

  static CaptureSettings emulated(double speed = 0.0) {
    CaptureSettings source;
    source.emulate = CaptureDrive::Exp1;
    source.speed = speed;
    return source;
  }
  ::testing::AssertionResult comes(StationState state) {
    if (waitUntil([&] { return model.state() == state; })) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << model.title().toStdString() << ": " << model.sentence().toStdString();
  }
  void connected(double speed = 0.0) {
    model.connectTo(emulated(speed));
    ASSERT_TRUE(comes(StationState::Ready));
  }
  void captured() {
    model.start({});
    ASSERT_TRUE(waitUntil([&] { return !model.isSweeping(); }));
    ASSERT_TRUE(comes(StationState::Verdict));
    ASSERT_TRUE(waitUntil([&] { return model.verdict().judgement().has_value(); }));
  }

  CaptureModel& model;
};

TEST_F(CaptureModelTest, ThereIsOneOfAWindow) {
  EXPECT_EQ(&model, &ui::captureModel(workspace));
  EXPECT_EQ(model.state(), StationState::Idle);
  EXPECT_EQ(model.title(), "Not connected");
  EXPECT_NE(model.sentence(), "");
}

TEST_F(CaptureModelTest, EveryStateHasWordsOfItsOwn) {
  QStringList titles;
  for (int state = 0; state <= static_cast<int>(StationState::Verdict); ++state)
    titles << ui::stationStateTitle(static_cast<StationState>(state));
  EXPECT_EQ(titles.size(), 8);
  EXPECT_EQ(titles.removeDuplicates(), 0);
  EXPECT_FALSE(titles.contains(""));
  EXPECT_EQ(ui::errorSentence({"it broke", "here", "mend it"}), "It broke (here). What to do: mend it.");
  EXPECT_EQ(ui::errorSentence({"it broke", "", ""}), "It broke.");
}

TEST_F(CaptureModelTest, WhatKeepsASweepFromBeginningIsSaid) {
  EXPECT_NE(model.whyNotStart().indexOf("project"), -1);
  makeProject(0);
  EXPECT_NE(model.whyNotStart().indexOf("connected"), -1) << model.whyNotStart().toStdString();
  connected();
  EXPECT_EQ(model.whyNotStart(), "");
  model.parameters().setValueText("lines", "many");
  EXPECT_NE(model.whyNotStart(), "");
  EXPECT_FALSE(model.canResume());
}

TEST_F(CaptureModelTest, TwoStopsGoIntoTheProjectAndAreJudged) {
  makeProject(0);
  connected();
  int began = 0, rows = 0;
  QObject::connect(&model, &CaptureModel::sweepBegan, [&] { ++began; });
  QObject::connect(&model, &CaptureModel::rowTaken, [&](const StationLinePtr& line) {
    EXPECT_GE(line->row, 0);
    ++rows;
  });
  model.parameters().setValue("lines", 101LL);
  captured();
  EXPECT_EQ(began, 1);
  EXPECT_EQ(rows, 101);
  EXPECT_EQ(model.rows().size(), 101U);
  EXPECT_EQ(snapshot().scans().size(), 1U);
  EXPECT_EQ(snapshot().scans()[0].lines, 101);
  EXPECT_EQ(model.verdict().judgement()->light, ui::CaptureLight::MoveOn)
      << model.verdict().judgement()->reason.toStdString();
  EXPECT_EQ(model.title(), "Move on");
  EXPECT_EQ(model.linesText(), "101 of 101");
  EXPECT_NE(model.deadText(), "");
  EXPECT_EQ(model.retriesText(), "0");
  EXPECT_NE(model.tiltErrorText(), "");
  EXPECT_NE(model.diskText().indexOf("sweeps"), -1);
  captured();
  EXPECT_EQ(began, 2);
  EXPECT_EQ(rows, 202);
  ASSERT_EQ(snapshot().scans().size(), 2U);
  const auto& judgement = *model.verdict().judgement();
  std::printf("verdict: %s: %s, %.0f ms after the last line\n",
              ui::captureLightName(judgement.light).toUtf8().constData(),
              judgement.reason.toUtf8().constData(), 1000.0 * judgement.after_last_line_s);
  ASSERT_TRUE(judgement.placed) << judgement.reason.toStdString();
  // It stands where it belongs, not where odometry had it, and that can be taken back.
  const ScanEntry& second = snapshot().scans()[1];
  const Pose truth = snapshot().scans()[0].poses.at(Stage::Truth).inverse() * second.poses.at(Stage::Truth);
  const Pose odometry = snapshot().scans()[0].odometry().inverse() * second.odometry();
  const Pose stored =
      snapshot().scans()[0].poses.at(Stage::Pairwise).inverse() * second.poses.at(Stage::Pairwise);
  EXPECT_LT(difference(truth, stored).translation_m, 0.05);
  EXPECT_GT(difference(truth, odometry).translation_m, 2.0 * difference(truth, stored).translation_m);
  EXPECT_EQ(workspace.session().undoTitle(), "place stop 1 by its registration");
  EXPECT_FALSE(workspace.display().isProposal());
}

TEST_F(CaptureModelTest, StoppedAndGoneOnWith) {
  makeProject(0);
  connected(1.0);  // as slow as real instruments: in memory a sweep may be whole before it is stopped
  model.parameters().setValue("lines", 31LL);
  model.start({});
  ASSERT_TRUE(waitUntil([&] { return model.now().sweep.rows_taken >= 4; }));
  EXPECT_TRUE(model.isSweeping());
  EXPECT_NE(model.whyNotStart(), "");
  model.stop();
  ASSERT_TRUE(waitUntil([&] { return !model.isSweeping(); }));
  ASSERT_TRUE(comes(StationState::Ready));
  const int kept = snapshot().scans()[0].lines;
  EXPECT_GE(kept, 4);
  EXPECT_LT(kept, 31);
  EXPECT_FALSE(model.verdict().judgement());
  ASSERT_TRUE(model.canResume());
  model.resume();
  ASSERT_TRUE(waitUntil([&] { return !model.isSweeping(); }));
  EXPECT_EQ(snapshot().scans().size(), 1U);
  EXPECT_EQ(snapshot().scans()[0].lines, 31) << model.sentence().toStdString();
  EXPECT_FALSE(model.canResume());
}

TEST_F(CaptureModelTest, ClosingTheProjectInASweepKeepsItsLines) {
  makeProject(0);
  connected();
  model.parameters().setValue("lines", 101LL);
  model.start({});
  ASSERT_TRUE(waitUntil([&] { return model.now().sweep.rows_taken >= 4; }));
  const QString path = workspace.session().path();
  const int lines = snapshot().scans()[0].lines;
  workspace.session().close();
  EXPECT_FALSE(model.isSweeping());
  must(workspace.session().open(path));
  EXPECT_GE(snapshot().scans()[0].lines, lines);
}

TEST_F(CaptureModelTest, WhatIsRefusedIsSaidUntilSomethingElseIsDone) {
  connected();
  model.jogTo(3.0);
  ASSERT_TRUE(waitUntil([&] { return model.now().error.has_value(); }));
  EXPECT_NE(model.sentence().indexOf("What to do"), -1) << model.sentence().toStdString();
  EXPECT_EQ(model.state(), StationState::Ready);
  model.jogTo(0.2);
  ASSERT_TRUE(waitUntil([&] { return model.tiltText() == "+11.46°"; })) << model.tiltText().toStdString();
  EXPECT_FALSE(model.now().error);
  model.order("no such fault");
  EXPECT_NE(model.sentence().indexOf("no such fault"), -1);
  EXPECT_FALSE(model.faults().isEmpty());
}

// The window's loop goes on while a device says nothing: sought, lost, sought again. The bound is against a
// hang; what was measured is printed.
TEST_F(CaptureModelTest, TheEventLoopGoesOnWhileADeviceIsSilent) {
  double worst_ms = 0.0;
  const auto watch = [&](const std::function<bool()>& until, int for_ms) {
    QElapsedTimer clock, turn;
    clock.start();
    while (!until() && clock.elapsed() < for_ms) {
      turn.start();
      QCoreApplication::processEvents(QEventLoop::AllEvents, 5);
      worst_ms = std::max(worst_ms, 1e-6 * static_cast<double>(turn.nsecsElapsed()) - 5.0);
    }
  };
  const auto never = [] { return false; };
  model.connectTo(emulated(1.0));
  watch([&] { return model.state() == StationState::Ready; }, 90000);
  ASSERT_EQ(model.state(), StationState::Ready) << model.sentence().toStdString();
  const double connecting_ms = std::exchange(worst_ms, 0.0);
  model.order("silent");
  watch([&] { return model.state() == StationState::Reconnecting; }, 90000);
  ASSERT_EQ(model.state(), StationState::Reconnecting);
  watch(never, 3000);
  const double silent_ms = std::exchange(worst_ms, 0.0);
  model.stop();
  watch([&] { return model.state() == StationState::Fault; }, 90000);
  ASSERT_EQ(model.state(), StationState::Fault);
  EXPECT_NE(model.sentence().indexOf("stopped sending"), -1) << model.sentence().toStdString();
  std::printf("longest turn of the event loop: %.1f ms while connecting, %.1f ms while a device is silent\n",
              connecting_ms, silent_ms);
  EXPECT_LT(connecting_ms, 200.0);
  EXPECT_LT(silent_ms, 200.0);
}

}  // namespace
}  // namespace tiltmap::test
