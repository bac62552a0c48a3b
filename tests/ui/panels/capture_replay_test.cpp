// A recorded session of both wires, replayed in the capture panel as if the instruments were there.
#include <QComboBox>
#include <QLineEdit>
#include <QPushButton>
#include <QTabWidget>

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "hardware/capture/capture_operation.h"
#include "hardware/emulator/terminal_rig.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/capture_model.h"
#include "ui/panels/capture_banner.h"
#include "ui/panels/capture_connect_page.h"
#include "ui/panels/capture_panel.h"

namespace tiltmap::test {
namespace {

constexpr int kLines = 5;

class CaptureReplayTest : public WindowTest {
 protected:
  void SetUp() override {
    makeProject(0);
    ASSERT_TRUE(trigger("capture.open"));
    panel = qobject_cast<ui::CapturePanel*>(window->docks().panel("capture"));
    ASSERT_NE(panel, nullptr);
    panel->model().parameters().setValue("lines", static_cast<long long>(kLines));
    settle();
  }
  std::string file(int attempt, const char* of) {
    return (folder / (std::string(of) + std::to_string(attempt) + ".wire")).string();
  }
  // A sweep with emulated instruments at pseudo terminals, both wires recorded, as `tiltmap capture` does it.
  // The scan; nothing where a busy machine disturbed it, so that lines were taken again.
  RangeImagePtr record(int attempt) {
    RealClock clock;
    const auto rig = must(TerminalRig::open(clock, *Experiment::make(ExperimentId::Exp1, 7), {}));
    const RigSettings settings;
    const auto project = must(Project::create(folder / ("recorded" + std::to_string(attempt) + ".tiltmap")));
    const auto operation = makeCaptureOperation();
    const auto job = must(
        Job::start(*operation, project->snapshot(), "default",
                   {{"scanner", settings.scannerUrl(rig->scannerPort()) + "?log=" + file(attempt, "scanner")},
                    {"tilt", settings.tiltUrl(rig->tiltPort()) + "&log=" + file(attempt, "tilt")},
                    {"lines", static_cast<long long>(kLines)}}));
    while (!job->waitFor(std::chrono::milliseconds(5))) job->serve(*project);
    job->serve(*project);
    const auto result = job->result();
    if (!result || result->report_json.find("\"spoiled\":0") == std::string::npos ||
        result->report_json.find("\"recoveries\":0") == std::string::npos)
      return nullptr;
    return must(project->snapshot()->scans().front().image());
  }
  void type(const QString& field, const std::string& text) {
    auto* edit = find<QLineEdit>(field);
    edit->setFocus();
    edit->selectAll();
    QTest::keyClicks(edit, ui::qt(text));
  }
  bool comes(StationState state) {
    for (int patience = 0; patience < 3; ++patience)
      if (waitUntil([&] { return panel->model().state() == state; })) return settle(), true;
    return false;
  }
  std::string told() { return (panel->banner().title() + ": " + panel->banner().sentence()).toStdString(); }

  ui::CapturePanel* panel = nullptr;
};

TEST_F(CaptureReplayTest, TheSweepIsStoredAgainLineByLine) {
  RangeImagePtr then;
  int attempt = 0;
  while (!then && attempt < 3) then = record(++attempt);
  if (!then) GTEST_SKIP() << "the machine is too busy for instruments in real time";
  find<QComboBox>("capture-source")
      ->setCurrentIndex(static_cast<int>(ui::CaptureConnectPage::Source::Recording));
  settle();
  type("capture-scanner-file", file(attempt, "scanner"));
  type("capture-tilt-file", file(attempt, "tilt"));
  click("capture-connect");
  ASSERT_TRUE(comes(StationState::Ready)) << told();
  EXPECT_TRUE(panel->model().now().replays);
  EXPECT_NE(find<QLabel>("capture-instruments")->text().indexOf("recording of lms2xx"), -1);
  EXPECT_TRUE(panel->banner().title() == "Ready") << told();
  ASSERT_TRUE(find("capture-start")->isEnabled()) << find("capture-start")->toolTip().toStdString();
  find("capture-start")->setFocus();
  QTest::keyClick(find("capture-start"), Qt::Key_Space);
  ASSERT_TRUE(comes(StationState::Verdict)) << told();
  EXPECT_EQ(panel->model().rows().size(), static_cast<std::size_t>(kLines)) << "each line was shown";

  ASSERT_EQ(snapshot().scans().size(), 1U);
  const RangeImagePtr again = must(snapshot().scans()[0].image());
  EXPECT_EQ(again->data().code, then->data().code);
  EXPECT_EQ(again->data().range_m, then->data().range_m);
  for (int row = 0; row < kLines; ++row) EXPECT_EQ(again->lineTilt(row), then->lineTilt(row)) << row;
  EXPECT_GT(then->validCells(), 500U);
}

TEST_F(CaptureReplayTest, ARecordingOfTheOtherInstrumentIsRefusedByName) {
  (void)record(9);
  find<QComboBox>("capture-source")
      ->setCurrentIndex(static_cast<int>(ui::CaptureConnectPage::Source::Recording));
  settle();
  type("capture-scanner-file", file(9, "tilt"));
  type("capture-tilt-file", file(9, "tilt"));
  click("capture-connect");
  ASSERT_TRUE(workspace().messages().latest());
  EXPECT_NE(workspace().messages().latest()->text.indexOf("no recording of a scanner"), -1)
      << workspace().messages().latest()->text.toStdString();
  EXPECT_EQ(panel->model().state(), StationState::Idle);
}

}  // namespace
}  // namespace tiltmap::test
