// The capture panel through every state, driven by mouse and keyboard against the emulator.
#include "ui/panels/capture_panel.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QTabWidget>

#include <gtest/gtest.h>

#include "tests/ui/support/state_picture.h"
#include "tests/ui/support/widget_rules.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/capture_model.h"
#include "ui/panels/capture_banner.h"
#include "ui/panels/capture_connect_page.h"
#include "ui/panels/capture_line_panels.h"
#include "ui/panels/polar_view.h"
#include "ui/panels/sweep_matrix_view.h"

namespace tiltmap::test {
namespace {

using ui::CaptureModel;
using ui::CapturePanel;

class CapturePanelTest : public WindowTest {
 protected:
  void SetUp() override {
    makeProject(0);
    ASSERT_TRUE(trigger("capture.open"));
    panel = qobject_cast<CapturePanel*>(window->docks().panel("capture"));
    ASSERT_NE(panel, nullptr);
    find<QComboBox>("capture-source")
        ->setCurrentIndex(static_cast<int>(ui::CaptureConnectPage::Source::Emulator));
    model().parameters().setValue("lines", 24LL);
    settle();
  }
  CaptureModel& model() { return panel->model(); }
  QString title() { return panel->banner().title(); }
  QString sentence() { return panel->banner().sentence(); }
  ::testing::AssertionResult comes(StationState state) {
    // At the instruments' own speed it takes 15 s to find rates and home.
    for (int patience = 0; patience < 3; ++patience) {
      if (!waitUntil([&] { return model().state() == state; })) continue;
      settle();
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << title().toStdString() << ": " << sentence().toStdString();
  }
  // 0: in memory, as fast as the machine can.
  void connectByMouse(double speed = 0.0) {
    find<QDoubleSpinBox>("capture-speed")->setValue(speed);
    click("capture-connect");
  }
  void connected(double speed = 0.0) {
    connectByMouse(speed);
    ASSERT_TRUE(comes(StationState::Ready));
  }
  void show(int page) {
    find<QTabWidget>("capture-tabs")->setCurrentIndex(page);
    settle();
  }
  bool isEnabled(const QString& name) { return find(name)->isEnabled(); }
  void take(const char* name) {
    takePictures(*window, preferences, name, [this] { settle(); });
  }
  void expectStopIsThere() {
    auto* stop = find<QPushButton>("capture-stop");
    EXPECT_TRUE(stop->isVisible() && stop->isEnabled());
    EXPECT_GE(stop->height(), 44);
    const QColor ground = stop->grab().toImage().pixelColor(12, 12);
    EXPECT_GT(ground.red(), 2 * (ground.green() + ground.blue())) << ground.name().toStdString();
    EXPECT_FALSE(title().isEmpty());
    EXPECT_FALSE(sentence().isEmpty()) << title().toStdString();
  }

  CapturePanel* panel = nullptr;
};

TEST_F(CapturePanelTest, GoesThroughEveryStateAndStopIsAlwaysThere) {
  take("idle");
  EXPECT_EQ(title(), "Not connected");
  EXPECT_FALSE(isEnabled("capture-start"));
  EXPECT_NE(find("capture-start")->toolTip().indexOf("connected"), -1);
  expectStopIsThere();
  click("capture-stop");
  EXPECT_EQ(title(), "Not connected");

  connectByMouse(1.0);
  ASSERT_TRUE(comes(StationState::Connecting));
  EXPECT_EQ(title(), "Connecting");
  take("connecting");
  expectStopIsThere();
  click("capture-stop");
  ASSERT_TRUE(comes(StationState::Idle));

  connected();
  EXPECT_EQ(title(), "Ready");
  take("ready");
  EXPECT_TRUE(isEnabled("capture-start"));
  EXPECT_NE(find<QLabel>("capture-instruments")->text().indexOf("LMS291"), -1);
  expectStopIsThere();

  click("capture-start");
  ASSERT_TRUE(waitUntil([&] { return model().now().sweep.number == 1; }));
  expectStopIsThere();
  ASSERT_TRUE(comes(StationState::Verdict));
  ASSERT_TRUE(waitUntil([&] { return model().verdict().judgement().has_value(); }));
  settle();
  take("verdict");
  EXPECT_TRUE(title() == "Move on" || title() == "Rescan" || title() == "Closer") << title().toStdString();
  expectStopIsThere();
  EXPECT_EQ(find<QProgressBar>("capture-progress")->text(), "24 of 24");
}

TEST_F(CapturePanelTest, AFaultSaysWhatToDoAndConnectingAgainHelps) {
  connected(1.0);
  model().order("silent");
  ASSERT_TRUE(comes(StationState::Reconnecting));
  EXPECT_EQ(title(), "Instrument lost");
  take("reconnecting");
  EXPECT_NE(sentence().indexOf("What to do"), -1);
  expectStopIsThere();
  press(QKeySequence(Qt::Key_F12));
  ASSERT_TRUE(comes(StationState::Fault));
  EXPECT_EQ(title(), "Fault");
  take("fault");
  EXPECT_NE(sentence().indexOf("What to do"), -1) << sentence().toStdString();
  EXPECT_FALSE(isEnabled("capture-start"));
  expectStopIsThere();
  EXPECT_EQ(find<QPushButton>("capture-connect")->text(), "Connect again");
  connected();
  click("capture-connect");
  ASSERT_TRUE(comes(StationState::Idle));
}

TEST_F(CapturePanelTest, TwoStopsInARowByKeyboard) {
  connected();
  for (int stop = 1; stop <= 2; ++stop) {
    find("capture-start")->setFocus();
    QTest::keyClick(find("capture-start"), Qt::Key_Space);
    ASSERT_TRUE(waitUntil([&] { return model().now().sweep.number == stop && !model().isSweeping(); }));
    ASSERT_TRUE(comes(StationState::Verdict));
    ASSERT_TRUE(waitUntil([&] { return model().verdict().judgement().has_value(); }));
    EXPECT_EQ(snapshot().scans().size(), static_cast<std::size_t>(stop));
    EXPECT_EQ(snapshot().scans().back().lines, 24);
  }
}

TEST_F(CapturePanelTest, StopInASweepKeepsTheLinesAndGoOnTakesTheRest) {
  model().parameters().setValue("lines", 31LL);
  connected(1.0);  // as slow as real instruments: in memory a sweep may be whole before it is stopped
  EXPECT_FALSE(find("capture-resume")->isVisible());
  click("capture-start");
  ASSERT_TRUE(waitUntil([&] { return model().now().sweep.rows_taken >= 5; }));
  QTest::mouseClick(find("capture-stop"), Qt::LeftButton);
  ASSERT_TRUE(comes(StationState::Ready));
  const int kept = snapshot().scans()[0].lines;
  EXPECT_GE(kept, 5);
  EXPECT_LT(kept, 31);
  ASSERT_TRUE(waitUntil([&] { return find("capture-resume")->isVisible(); }));
  click("capture-resume");
  ASSERT_TRUE(waitUntil([&] { return snapshot().scans()[0].lines == 31; }))
      << model().sentence().toStdString();
  ASSERT_TRUE(comes(StationState::Verdict));
  settle();
  EXPECT_FALSE(find("capture-resume")->isVisible());
}

TEST_F(CapturePanelTest, ADirtyWindowIsToldWhileItIsDirty) {
  connected();
  const auto health = [&] { return find<QLabel>("capture-instruments")->text(); };
  ASSERT_TRUE(waitUntil([&] { return health().contains("window: clean"); })) << health().toStdString();
  EXPECT_TRUE(health().contains("no defect reported"));
  const int at = find<QComboBox>("capture-fault")->findText("dirty-window");
  ASSERT_GE(at, 0);
  find<QComboBox>("capture-fault")->setCurrentIndex(at);
  click("capture-order-fault");
  ASSERT_TRUE(waitUntil([&] { return health().contains("! window: dirty, wipe it"); }))
      << health().toStdString();
  EXPECT_NE(sentence().indexOf("dirty, wipe it"), -1) << "at arm's length, too";
  take("dirty");
}

// At arm's length the ground and the words' colour say it first.
TEST_F(CapturePanelTest, TheBannerHasTheColoursOfItsStateInEveryLook) {
  const auto isSeen = [&](const QColor& colour) {
    const QImage image = panel->banner().grab().toImage();
    int seen = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) seen += image.pixelColor(x, y) == colour ? 1 : 0;
    return seen;
  };
  const auto expectColours = [&](QColor ui::ThemeColours::*mark,
                                 std::optional<QColor ui::ThemeColours::*> ground) {
    for (const auto& [choice, look] : {std::pair{ui::ThemeChoice::Light, ui::Look::Light},
                                       {ui::ThemeChoice::Dark, ui::Look::Dark},
                                       {ui::ThemeChoice::HighContrast, ui::Look::HighContrast},
                                       {ui::ThemeChoice::Light, ui::Look::Light}}) {
      preferences.setTheme(choice);
      settle();
      const ui::ThemeColours colours = ui::Theme::coloursOf(look);
      const QPalette palette = ui::Theme::palette(look);
      const QColor behind = ground ? colours.*(*ground) : palette.color(QPalette::AlternateBase);
      const QString where = title() + " in look " + QString::number(static_cast<int>(look));
      EXPECT_EQ(panel->banner().grab().toImage().pixelColor(3, 3), behind) << where.toStdString();
      EXPECT_GT(isSeen(colours.*mark), 20) << where.toStdString();
      EXPECT_GT(isSeen(palette.color(QPalette::WindowText)), 20) << where.toStdString();
    }
  };
  expectColours(&ui::ThemeColours::muted, std::nullopt);
  connected();
  expectColours(&ui::ThemeColours::good, &ui::ThemeColours::note_ground);
  click("capture-start");
  ASSERT_TRUE(comes(StationState::Verdict));
  ASSERT_TRUE(waitUntil([&] { return model().verdict().judgement().has_value(); }));
  settle();
  ASSERT_EQ(title(), "Move on");
  expectColours(&ui::ThemeColours::good, &ui::ThemeColours::note_ground);
  // Nothing is seen any more: not to be called good.
  ASSERT_TRUE(waitUntil([&] { return model().faults().contains("dazzled"); }));
  model().order("dazzled");
  click("capture-start");
  ASSERT_TRUE(waitUntil([&] { return model().now().sweep.number == 2; }));
  ASSERT_TRUE(comes(StationState::Verdict));
  ASSERT_TRUE(waitUntil([&] { return model().verdict().judgement().has_value(); }));
  settle();
  take("rescan");
  EXPECT_EQ(title(), "Rescan");
  expectColours(&ui::ThemeColours::error, &ui::ThemeColours::error_ground);
}

// Who is connected and how they are is read without scrolling; how to reach them is settled.
TEST_F(CapturePanelTest, IdentityAndHealthAreSeenOnceConnected) {
  EXPECT_TRUE(find("capture-source")->isVisible());
  EXPECT_FALSE(find("capture-order-fault")->isVisible()) << "there is nothing to go wrong yet";
  connected();
  EXPECT_FALSE(find("capture-source")->isVisible());
  EXPECT_FALSE(find("capture-speed")->isVisible());
  const auto* facts = find<QLabel>("capture-instruments");
  EXPECT_FALSE(facts->visibleRegion().isEmpty());
  EXPECT_GT(facts->visibleRegion().boundingRect().height(), 5 * facts->fontMetrics().height());
  click("capture-connect");
  ASSERT_TRUE(comes(StationState::Idle));
  EXPECT_TRUE(find("capture-source")->isVisible());
}

TEST_F(CapturePanelTest, WhatTheNextStopTakesOverIsSaidAndCanBeLeftAway) {
  connected();
  show(2);
  EXPECT_FALSE(find("capture-known-rig")->isVisible()) << "nothing is known yet";
  click("capture-start");
  ASSERT_TRUE(comes(StationState::Verdict));
  ProjectEdit edit;
  edit.title = "the body";
  edit.steps.emplace_back(SetBodyMask{id(0), CellMask{24, 361, {{0, 100, 139}}}});
  must(workspace().session().apply(edit));
  settle();
  const auto says = [&](const char* words) {
    return waitUntil([&] {
      const auto* label = find<QLabel>("capture-known-rig");
      return label->isVisible() && label->text().startsWith(words) && label->text().contains("40 cells");
    });
  };
  EXPECT_TRUE(says("Takes over")) << find<QLabel>("capture-known-rig")->text().toStdString();
  take("takes-over");
  model().parameters().setValue("known-rig", false);
  EXPECT_TRUE(says("Leaves away"));
  model().parameters().setValue("known-rig", true);
  click("capture-start");
  ASSERT_TRUE(waitUntil([&] { return model().now().sweep.number == 2; }));
  ASSERT_TRUE(comes(StationState::Verdict));
  EXPECT_EQ(must(snapshot().scans()[1].image())->code(0, 120), cell_code::kMasked);
}

// As slow as real instruments are: what a sweep looks like on its way.
TEST_F(CapturePanelTest, ASweepUnderWayIsSeenAndStopped) {
  connected(1.0);
  model().parameters().setValue("lines", 101LL);
  click("capture-start");
  ASSERT_TRUE(waitUntil([&] { return model().now().sweep.rows_taken >= 12; }));
  EXPECT_EQ(title(), "Scanning");
  EXPECT_NE(find<QLabel>("capture-figure-0")->text(), "–");
  EXPECT_FALSE(isEnabled("capture-start"));
  take("scanning");
  expectStopIsThere();
  press(QKeySequence(Qt::Key_F12));
  ASSERT_TRUE(comes(StationState::Ready));
  EXPECT_GE(snapshot().scans()[0].lines, 12);
  show(1);
  // Stop leaves it where it is, which has to be read first.
  ASSERT_TRUE(waitUntil([&] { return model().now().tilt_rad.has_value(); }));
  click("capture-jog-up-far");
  ASSERT_TRUE(comes(StationState::Moving));
  EXPECT_EQ(title(), "The tilt moves");
  take("moving");
  click("capture-stop");
  ASSERT_TRUE(comes(StationState::Ready));
  show(2);
  take("next-stop");
}

TEST_F(CapturePanelTest, TheTiltIsMovedByItsButtons) {
  connected();
  show(1);
  const auto angle = [&] { return find<QLabel>("capture-tilt-angle")->text(); };
  find<QDoubleSpinBox>("capture-tilt-target")->setValue(10.0);
  click("capture-tilt-go");
  ASSERT_TRUE(waitUntil([&] { return angle() == "+10.00°"; })) << angle().toStdString();
  click("capture-jog-up-far");
  ASSERT_TRUE(waitUntil([&] { return angle() == "+15.00°"; })) << angle().toStdString();
  click("capture-jog-down-near");
  ASSERT_TRUE(waitUntil([&] { return angle() == "+14.20°"; })) << angle().toStdString();
  click("capture-park");
  ASSERT_TRUE(waitUntil([&] { return angle() == "+0.00°" || angle() == "-0.00°"; })) << angle().toStdString();
  ASSERT_TRUE(comes(StationState::Ready));
  click("capture-home");
  ASSERT_TRUE(waitUntil([&] { return model().now().tilt_rad && std::abs(*model().now().tilt_rad) > 0.1; }));
  ASSERT_TRUE(comes(StationState::Ready));
}

TEST_F(CapturePanelTest, WhatTheScannerSeesIsShown) {
  connected();
  auto* line = qobject_cast<ui::CaptureLinePanel*>(window->docks().panel("capture-line"));
  auto* matrix = qobject_cast<ui::CaptureMatrixPanel*>(window->docks().panel("capture-matrix"));
  ASSERT_TRUE(line && matrix);
  ASSERT_TRUE(waitUntil([&] { return !line->view().isEmpty(); }));
  click("capture-start");
  ASSERT_TRUE(comes(StationState::Verdict));
  EXPECT_EQ(matrix->view().rows(), 24);
  EXPECT_EQ(matrix->view().taken(), 24);
  show(0);
  click("capture-connect");
  ASSERT_TRUE(comes(StationState::Idle));
  EXPECT_TRUE(line->view().isEmpty());
}

TEST_F(CapturePanelTest, ClosingTheWindowInASweepKeepsEveryLine) {
  model().parameters().setValue("lines", 101LL);
  connected();
  click("capture-start");
  ASSERT_TRUE(waitUntil([&] { return model().now().sweep.rows_taken >= 5; }));
  const int lines = snapshot().scans()[0].lines;
  const QString path = workspace().session().path();
  window->closeNow();
  delete window.data();
  const auto project = Project::open(ui::pathOf(path), Access::ReadOnly);
  ASSERT_TRUE(project);
  EXPECT_GE((*project)->snapshot()->scans()[0].lines, lines);
  EXPECT_TRUE((*project)->verify());
}

TEST_F(CapturePanelTest, EverythingThatIsPressedIsTallAndNothingIsCutOff) {
  const auto expectRoom = [&] {
    for (const ui::ThemeChoice look : {ui::ThemeChoice::Light, ui::ThemeChoice::HighContrast}) {
      preferences.setTheme(look);
      window->resize(1366, 768);
      for (int page = 0; page < 3; ++page) {
        show(page);
        int tall = 0;
        for (const auto* button : panel->findChildren<QAbstractButton*>()) {
          if (!button->isVisible() || isForeign(*button)) continue;
          EXPECT_GE(button->height(), CapturePanel::kTarget_px) << placeOf(*button);
          ++tall;
        }
        EXPECT_GE(tall, 2);
        for (const std::string& text : cutOff(*panel)) ADD_FAILURE() << page << " cut off: " << text;
        EXPECT_TRUE(window->rect().contains(QRect(panel->mapTo(window, QPoint()), panel->size())));
        auto* scroll = qobject_cast<QScrollArea*>(find<QTabWidget>("capture-tabs")->currentWidget());
        EXPECT_NE(scroll, nullptr);
        EXPECT_GT(scroll->height(), 150) << "room for the page";
        EXPECT_LE(scroll->widget()->width(), scroll->viewport()->width()) << "cut off at its side";
      }
      show(0);
    }
  };
  expectRoom();
  preferences.setTheme(ui::ThemeChoice::Light);
  connected();
  expectRoom();
  preferences.setTheme(ui::ThemeChoice::Light);
}

TEST_F(CapturePanelTest, AWrongRecordingIsToldWhereItWasChosen) {
  find<QComboBox>("capture-source")
      ->setCurrentIndex(static_cast<int>(ui::CaptureConnectPage::Source::Recording));
  settle();
  click("capture-connect");
  ASSERT_TRUE(workspace().messages().latest());
  EXPECT_NE(workspace().messages().latest()->text.indexOf("recording"), -1);
  EXPECT_EQ(model().state(), StationState::Idle);
}

}  // namespace
}  // namespace tiltmap::test
