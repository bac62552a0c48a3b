#include "ui/panels/odometry_form.h"

#include <QSignalSpy>

#include "hardware/capture/capture_operation.h"
#include "tests/ui/support/odometry_form_fixture.h"
#include "tests/ui/support/pixels.h"
#include "tests/ui/support/widget_rules.h"
#include "ui/panels/odometry_sources.h"
#include "ui/panels/step_sketch.h"

namespace tiltmap::test {
namespace {

using ui::OdometryForm;

TEST_F(OdometryFormTest, TypedAsDistanceAndTurn) {
  EXPECT_TRUE(misses("distance is missing"));
  QSignalSpy changed(form.get(), &OdometryForm::changed);
  type("odometry-forward", "2");
  EXPECT_GT(changed.count(), 0);
  EXPECT_TRUE(misses("turn is missing"));
  type("odometry-turn", "15");
  EXPECT_TRUE(tells(Pose::planar(0.0, 2.0, 15.0 * kDegree)));
  EXPECT_EQ(sentence(), "2.00 m forward, turned 15° to the left");
  EXPECT_EQ(form->sentence(), sentence());
  EXPECT_TRUE(form->missing().isEmpty());
  // The parameter of a capture says the same.
  const auto parsed = parseStep(ui::utf8(form->stepText()));
  ASSERT_TRUE(parsed);
  EXPECT_TRUE(tells(*parsed));
  type("odometry-turn", "-7.5");
  EXPECT_EQ(sentence(), "2.00 m forward, turned 7.5° to the right");
  type("odometry-forward", "-0.5");
  EXPECT_EQ(sentence(), "0.50 m back, turned 7.5° to the right");
  type("odometry-forward", "0");
  type("odometry-turn", "0");
  EXPECT_EQ(sentence(), "did not move");
  EXPECT_TRUE(tells(Pose()));
}

TEST_F(OdometryFormTest, TypedAsRightForwardAndTurn) {
  choose("odometry-typed-as", 1);
  EXPECT_TRUE(misses("right is missing"));
  type("odometry-right", "0.1");
  type("odometry-forward", "5.2");
  type("odometry-turn", "-3");
  EXPECT_TRUE(tells(Pose::planar(0.1, 5.2, -3.0 * kDegree)));
  EXPECT_EQ(sentence(), "5.20 m forward, 0.10 m to the right, turned 3° to the right");
  choose("odometry-typed-as", 0);
  EXPECT_TRUE(tells(Pose::planar(0.0, 5.2, -3.0 * kDegree))) << "what is not seen does not count";
}

TEST_F(OdometryFormTest, TypedNumbersFollowTheRulesOfTheParameter) {
  type("odometry-turn", "0");
  for (const char* wrong : {"abc", "1,5", "2 m", "0x10", "--1"}) {
    type("odometry-forward", wrong);
    EXPECT_TRUE(misses("distance is no number")) << wrong;
  }
  for (const char* wrong : {"nan", "inf", "1e7"}) {
    type("odometry-forward", wrong);
    EXPECT_FALSE(parseStep("0," + std::string(wrong) + ",0"));
    EXPECT_TRUE(misses("no odometry")) << wrong;
  }
  type("odometry-forward", " 1e-1 ");
  EXPECT_TRUE(tells(Pose::planar(0.0, 0.1, 0.0)));
}

TEST_F(OdometryFormTest, NudgedByMouseAndKeyboard) {
  click("odometry-nudged");
  EXPECT_EQ(form->mode(), OdometryForm::Mode::Nudged);
  EXPECT_TRUE(misses("not been moved"));
  EXPECT_FALSE(find("nudge-reset")->isEnabled());
  click("nudge-forward-1");
  click("nudge-forward-0.1");
  EXPECT_TRUE(tells(Pose::planar(0.0, 1.1, 0.0)));
  click("nudge-left-45");
  click("nudge-left-45");
  EXPECT_TRUE(tells(Pose::planar(0.0, 1.1, 90.0 * kDegree)));
  // Forward is where the vehicle looks by then.
  find("nudge-forward-1")->setFocus();
  QTest::keyClick(find("nudge-forward-1"), Qt::Key_Space);
  EXPECT_TRUE(tells(Pose::planar(-1.0, 1.1, 90.0 * kDegree)));
  click("nudge-back-1");
  click("nudge-right-10");
  click("nudge-right-1");
  click("nudge-left-1");
  click("nudge-back-0.1");
  EXPECT_TRUE(tells(Pose::planar(0.0, 1.1, 80.0 * kDegree) * Pose::planar(0.0, -0.1, 0.0)));
  click("nudge-reset");
  EXPECT_TRUE(misses("not been moved"));
  // Back where it was is a step, too.
  click("nudge-right-45");
  click("nudge-left-45");
  click("nudge-left-10");
  click("nudge-right-10");
  EXPECT_TRUE(tells(Pose()));
}

TEST_F(OdometryFormTest, GlovesHitEveryButton) {
  const auto large = [&](QToolButton* button) {
    EXPECT_GE(button->height(), 44) << button->objectName().toStdString();
    EXPECT_GE(button->width(), 44) << button->objectName().toStdString();
  };
  int seen = 0;
  for (const char* mode : {"odometry-typed", "odometry-nudged", "odometry-file", "odometry-feed"}) {
    click(mode);
    for (QToolButton* button : form->findChildren<QToolButton*>())
      if (button->isVisible()) ++seen, large(button);
  }
  EXPECT_GE(seen, 30);
}

constexpr const char* kDrive =
    "0 0 0 0 0 0 0 1\n"
    "10 2 0 0 0 0 0.1305262 0.9914449\n"  // 2 m ahead, 15 deg left
    "20 4 1 0 0 0 0.1305262 0.9914449\n";

TEST_F(OdometryFormTest, FromAFile) {
  const auto file = folder.write("drive.tum", kDrive);
  click("odometry-file");
  EXPECT_TRUE(misses("no file has been read") || misses("No file has been read"));
  type("odometry-file-path", ui::qt(file));
  QTest::keyClick(find<QLineEdit>("odometry-file-path"), Qt::Key_Return);
  EXPECT_TRUE(tells(Pose::planar(0.0, 2.0, 15.0 * kDegree))) << "the first two poses";
  EXPECT_EQ(sentence(), "2.00 m forward, turned 15° to the left");
  EXPECT_NE(find<QLabel>("odometry-file-found")->text().indexOf("3 poses, stamps 0 to 20"), -1);
  // The other axes: the same numbers mean something else.
  choose("odometry-file-axes", 1);
  EXPECT_TRUE(tells(Pose::planar(2.0, 0.0, 15.0 * kDegree)));
  choose("odometry-file-axes", 0);
  click("odometry-stamp-later");
  EXPECT_EQ(find<QLineEdit>("odometry-stamp-next")->text(), "20");
  EXPECT_TRUE(tells(Pose::planar(-1.0, 4.0, 15.0 * kDegree)));
  EXPECT_FALSE(find("odometry-stamp-later")->isEnabled());
  click("odometry-stamp-earlier");
  // Typed stamps stand for the nearest pose.
  type("odometry-stamp-next", "19.7");
  EXPECT_TRUE(tells(Pose::planar(-1.0, 4.0, 15.0 * kDegree)));
  type("odometry-stamp-next", "15");
  EXPECT_TRUE(misses("no pose within 0.5 of stamp 15"));
  type("odometry-stamp-next", "now");
  EXPECT_TRUE(misses("is no stamp"));
  type("odometry-stamp-next", "0.1");
  EXPECT_TRUE(misses("same pose"));
  type("odometry-stamp-next", "");
  EXPECT_TRUE(misses("stamp of the new stop is missing"));
  type("odometry-stamp-next", "10");
  // The stop is captured: on to the next pose.
  form->stopCaptured();
  EXPECT_EQ(find<QLineEdit>("odometry-stamp-last")->text(), "10");
  EXPECT_EQ(find<QLineEdit>("odometry-stamp-next")->text(), "20");
  ASSERT_TRUE(form->lastFromNext());
  const double c = std::cos(15.0 * kDegree), s = std::sin(15.0 * kDegree);
  // (2, 1) of its world, seen from a vehicle that looks 15 deg to the left of x.
  EXPECT_TRUE(tells(Pose::planar(-(-2.0 * s + 1.0 * c), 2.0 * c + 1.0 * s, 0.0)));
  form->stopCaptured();
  EXPECT_TRUE(misses("stamp of the new stop is missing")) << "the file has no more";
  // It grows.
  folder.write("drive.tum", std::string(kDrive) + "30 5 1 0 0 0 0 1\n");
  click("odometry-file-again");
  EXPECT_TRUE(form->lastFromNext());
  EXPECT_EQ(find<QLineEdit>("odometry-stamp-last")->text(), "20");
}

TEST_F(OdometryFormTest, ABadFileSaysWhereAndWhat) {
  click("odometry-file");
  auto* page = form->findChild<ui::FileOdometryPage*>();
  ASSERT_NE(page, nullptr);
  page->open(ui::qt(folder.write("bad.tum", "0 0 0 0 0 0 0 1\n1 0 nan 0 0 0 0 1\n")));
  EXPECT_TRUE(misses("bad.tum:2: y: \"nan\" is not a finite number"));
  page->open(ui::qt(folder / "none.tum"));
  EXPECT_TRUE(misses("none.tum"));
  page->open(ui::qt(folder.write("one.tum", "0 0 0 0 0 0 0 1\n")));
  EXPECT_TRUE(misses("stamp of the last stop is missing"));
}

TEST_F(OdometryFormTest, TheFirstStopNeedsNone) {
  type("odometry-forward", "2");
  type("odometry-turn", "0");
  form->setFirstStop(true);
  EXPECT_TRUE(form->isFirstStop());
  EXPECT_NE(sentence().indexOf("first stop"), -1);
  EXPECT_TRUE(form->missing().isEmpty());
  EXPECT_FALSE(form->lastFromNext());
  EXPECT_TRUE(form->stepText().isEmpty());
  EXPECT_FALSE(find("odometry-forward")->isEnabled());
  click("odometry-nudged");
  EXPECT_FALSE(find("nudge-forward-1")->isEnabled());
  click("odometry-typed");
  form->setFirstStop(false);
  EXPECT_TRUE(tells(Pose::planar(0.0, 2.0, 0.0)));
}

TEST_F(OdometryFormTest, ACapturedStopBeginsTheNextStep) {
  type("odometry-forward", "2");
  type("odometry-turn", "0");
  form->stopCaptured();
  EXPECT_TRUE(misses("distance is missing"));
  click("odometry-nudged");
  click("nudge-forward-1");
  form->stopCaptured();
  EXPECT_TRUE(misses("not been moved"));
}

TEST_F(OdometryFormTest, TheSketchShowsBothStops) {
  auto* sketch = find<ui::StepSketch>("step-sketch");
  EXPECT_EQ(countNear(pictureOf(*sketch), sketch->rect().center(), 200, theme.colours().accent), 0);
  type("odometry-forward", "2");
  type("odometry-turn", "90");
  const QPointF last = sketch->placeOf({0.0, 0.0}), next = sketch->placeOf({0.0, 2.0});
  EXPECT_LT(next.y(), last.y() - 20.0) << "forward is up";
  EXPECT_TRUE(sketch->rect().contains(last.toPoint()) && sketch->rect().contains(next.toPoint()));
  const QImage picture = pictureOf(*sketch);
  EXPECT_GT(countNear(picture, next, 6, theme.colours().accent), 60);
  EXPECT_GT(countNear(picture, next + QPointF(-17, 0), 4, theme.colours().accent), 8)
      << "it looks to the left";
  EXPECT_EQ(countNear(picture, next + QPointF(0, -17), 4, theme.colours().accent), 0);
  EXPECT_GT(countNear(picture, last + QPointF(0, -17), 4, sketch->palette().color(QPalette::Text)), 8);
  // The grid fits from centimetres to hundreds of metres.
  for (const auto& [typed, metres] : {std::pair("0.1", 0.1), std::pair("30", 30.0), std::pair("900", 900.0),
                                      std::pair("-90000", -90000.0)}) {
    type("odometry-forward", typed);
    EXPECT_TRUE(sketch->rect().contains(sketch->placeOf({0.0, metres}).toPoint())) << typed;
    EXPECT_TRUE(sketch->rect().contains(sketch->placeOf({0.0, 0.0}).toPoint())) << typed;
    EXPECT_GE(sketch->grid(), 0.5);
    EXPECT_FALSE(pictureOf(*sketch).isNull());
  }
}

TEST_F(OdometryFormTest, RemembersHowItWasTold) {
  click("odometry-nudged");
  form.reset();
  form = std::make_unique<OdometryForm>(theme, preferences);
  show();
  EXPECT_EQ(form->mode(), OdometryForm::Mode::Nudged);
  EXPECT_TRUE(find<QToolButton>("odometry-nudged")->isChecked());
  EXPECT_TRUE(find("nudge-forward-1")->isVisible());
  form->setMode(OdometryForm::Mode::File);
  EXPECT_TRUE(find<QToolButton>("odometry-file")->isChecked());
  EXPECT_FALSE(find<QToolButton>("odometry-nudged")->isChecked());
  EXPECT_FALSE(find("nudge-forward-1")->isVisible());
}

TEST_F(OdometryFormTest, EverythingIsNamedReachedByKeyboardAndFits) {
  for (const auto choice : {ui::ThemeChoice::Light, ui::ThemeChoice::HighContrast}) {
    preferences.setTheme(choice);
    for (const char* mode : {"odometry-typed", "odometry-nudged", "odometry-file", "odometry-feed"}) {
      click(mode);
      form->resize(340, 560);
      QCoreApplication::processEvents();
      for (const std::string& cut : cutOff(*form)) ADD_FAILURE() << cut;
      EXPECT_LE(form->minimumSizeHint().width(), 340) << mode;
      EXPECT_LE(form->minimumSizeHint().height(), 560) << mode;
    }
  }
  preferences.setTheme(ui::ThemeChoice::Light);
  for (const QWidget* control : controlsOf(*form)) {
    EXPECT_FALSE(control->toolTip().isEmpty()) << placeOf(*control);
    EXPECT_NE(spokenName(*control), "") << placeOf(*control);
    EXPECT_TRUE(control->focusPolicy() & Qt::TabFocus) << placeOf(*control);
  }
}

}  // namespace
}  // namespace tiltmap::test
