// Two stops captured in the panel with instruments at ports, placed by the vehicle's own computer over TCP.
#include <QComboBox>
#include <QLineEdit>
#include <QScrollArea>
#include <QTabWidget>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "hardware/emulator/terminal_rig.h"
#include "tests/support/feed_server.h"
#include "tests/ui/support/state_picture.h"
#include "ui/models/capture_model.h"
#include "ui/panels/capture_banner.h"
#include "ui/panels/capture_connect_page.h"
#include "ui/panels/capture_panel.h"

namespace tiltmap::test {
namespace {

class CaptureFeedTest : public WindowTest {
 protected:
  void SetUp() override {
    makeProject(0);
    ASSERT_TRUE(trigger("capture.open"));
    panel = qobject_cast<ui::CapturePanel*>(window->docks().panel("capture"));
    ASSERT_NE(panel, nullptr);
    auto opened = TerminalRig::open(clock, *Experiment::make(ExperimentId::Exp1, 7), {});
    if (!opened) GTEST_SKIP() << opened.error().what;
    rig = std::move(*opened);
    panel->model().parameters().setValue("lines", 3LL);
    find<QComboBox>("capture-source")
        ->setCurrentIndex(static_cast<int>(ui::CaptureConnectPage::Source::Named));
    settle();
  }
  void type(const QString& field, const std::string& text) {
    auto* edit = find<QLineEdit>(field);
    ASSERT_TRUE(edit->isVisible() && edit->isEnabled()) << field.toStdString();
    edit->setFocus();
    edit->selectAll();
    QTest::keyClicks(edit, ui::qt(text));
    settle();
  }
  bool comes(StationState state) {
    for (int patience = 0; patience < 3; ++patience)
      if (waitUntil([&] { return panel->model().state() == state; })) return settle(), true;
    return false;
  }
  std::string told() { return (panel->banner().title() + ": " + panel->banner().sentence()).toStdString(); }
  void page(int index) {
    find<QTabWidget>("capture-tabs")->setCurrentIndex(index);
    settle();
  }
  // The vehicle stands there from now on, and the form has heard it.
  void vehicleAt(double x_m, double y_m) {
    {
      const std::lock_guard lock(mutex);
      x = x_m, y = y_m;
    }
    if (!vehicle.joinable())
      vehicle = std::jthread([this](const std::stop_token& stop) {
        for (double stamp_s = 1.0; !stop.stop_requested(); stamp_s += 0.1) {
          {
            const std::lock_guard lock(mutex);
            server.send(FeedServer::line(stamp_s, x, y));
          }
          std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
      });
    const QString there = QString("x %1").arg(x_m, 0, 'f', 2);
    ASSERT_TRUE(waitUntil([&] { return find<QLabel>("odometry-feed-pose")->text().contains(there); }))
        << find<QLabel>("odometry-feed-state")->text().toStdString();
  }
  void take(const char* name) {
    takePictures(*window, preferences, name, [this] { settle(); });
  }
  void captureStop(std::size_t number) {
    const int sweep = static_cast<int>(number);
    find("capture-start")->setFocus();
    ASSERT_TRUE(waitUntil([&] { return find("capture-start")->isEnabled(); }))
        << find("capture-start")->toolTip().toStdString();
    QTest::keyClick(find("capture-start"), Qt::Key_Space);
    ASSERT_TRUE(waitUntil([&] { return panel->model().now().sweep.number == sweep; })) << told();
    ASSERT_TRUE(comes(StationState::Verdict)) << told();
    ASSERT_EQ(snapshot().scans().size(), number);
    EXPECT_EQ(snapshot().scans().back().lines, 3);
    ASSERT_TRUE(waitUntil([&] { return panel->model().verdict().judgement().has_value(); }));
    settle();
    if (number > 1) {
      EXPECT_EQ(panel->banner().title(), "Rescan") << "three lines are no map, and it is not the first stop";
    }
  }

  RealClock clock;
  std::unique_ptr<TerminalRig> rig;
  FeedServer server;
  std::mutex mutex;
  double x = 0.0, y = 0.0;
  std::jthread vehicle;
  ui::CapturePanel* panel = nullptr;
};

TEST_F(CaptureFeedTest, FromStartToStoredStopsWithPosesOfTheFeed) {
  type("capture-scanner", RigSettings().scannerUrl(rig->scannerPort()));
  type("capture-tilt", RigSettings().tiltUrl(rig->tiltPort()));
  click("capture-connect");
  ASSERT_TRUE(comes(StationState::Ready)) << told();
  page(2);
  click("odometry-feed");
  type("odometry-feed-address", server.address().text());
  click("odometry-feed-connect");
  vehicleAt(5.0, 2.0);
  take("feed-first");
  captureStop(1);

  // The vehicle drives on, and nobody has said yet where the next stop is.
  ASSERT_TRUE(rig->moveTo(1));
  ASSERT_TRUE(waitUntil([&] { return !find("capture-start")->isEnabled(); }));
  EXPECT_NE(find("capture-start")->toolTip().indexOf("taken"), -1)
      << find("capture-start")->toolTip().toStdString();
  vehicleAt(9.5, 1.0);
  click("odometry-feed-take");
  EXPECT_NE(find<QLabel>("odometry-sentence")->text().indexOf("4.50 m forward"), -1)
      << find<QLabel>("odometry-sentence")->text().toStdString();
  take("feed-taken");
  captureStop(2);
  const Pose step = snapshot().scans()[0].odometry().inverse() * snapshot().scans()[1].odometry();
  const PoseDifference off = difference(step, Pose::planar(1.0, 4.5, 0.0));
  EXPECT_LT(off.translation_m, 1e-6) << step.translation().transpose();
  EXPECT_LT(off.rotation_rad, 1e-6);

  // Without the feed there is no step; the stops stay.
  vehicle = {};
  server.hangUp();
  ASSERT_TRUE(
      waitUntil([&] { return !find<QLabel>("odometry-feed-state")->text().startsWith("Receiving"); }));
  EXPECT_FALSE(find("capture-start")->isEnabled());
  take("feed-lost");
  for (const char* mode : {"odometry-typed", "odometry-nudged", "odometry-file"}) {
    click(mode);
    take(mode);
  }
  // In large letters no page is wider than its place.
  preferences.setTheme(ui::ThemeChoice::HighContrast);
  for (const char* mode : {"odometry-typed", "odometry-nudged", "odometry-file", "odometry-feed"}) {
    settle();
    click(mode);
    auto* scroll = find<QScrollArea>("capture-stop-scroll");
    EXPECT_LE(scroll->widget()->width(), scroll->viewport()->width()) << mode;
  }
  preferences.setTheme(ui::ThemeChoice::Light);
  EXPECT_EQ(snapshot().scans().size(), 2U);
}

}  // namespace
}  // namespace tiltmap::test
