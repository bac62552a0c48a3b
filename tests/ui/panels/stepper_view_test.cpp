// Both scans of the stepper in 3D: picked, dragged, looked into.
#include <QCheckBox>
#include <QPushButton>
#include <QTableWidget>
#include <QToolButton>

#include <gtest/gtest.h>

#include "tests/ui/support/stepper_window.h"
#include "ui/models/study_model.h"

namespace tiltmap::test {
namespace {

using StepperViewTest = StepperWindowTest;

TEST_F(StepperViewTest, APairIsPickedAndExplainedAndItsTreeShown) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  stepByMouse();
  (void)view->picture();
  EXPECT_EQ(view->layer().linesDrawn(),
            stepper().current()->pairs.size() -
                stepper().current()->report.rejected[static_cast<std::size_t>(RejectReason::NoPartner)]);
  // The middle of a kept pair as it is drawn.
  std::optional<QPointF> place;
  for (const TracedPair& pair : stepper().pairs()) {
    if (!pair.pair.kept()) continue;
    const Eigen::Vector3d middle = 0.5 * (stepper().pose() * pair.moving_point + pair.fixed_point);
    place = placeOf(view->scene().pixelOf(middle));
    if (view->view()->rect().adjusted(20, 20, -20, -20).contains(place->toPoint())) break;
  }
  ASSERT_TRUE(place);
  QTest::mouseClick(view->view(), Qt::LeftButton, {}, place->toPoint());
  settle();
  ASSERT_TRUE(stepper().picked());
  EXPECT_EQ(text("stepper-picked"), stepper().pickedSentence());
  click("stepper-show-tree");
  ui::StudyModel& study = ui::StudyModel::of(stepper());
  ASSERT_TRUE(study.visit());
  EXPECT_TRUE(text("stepper-picked").contains("compared"));
  EXPECT_TRUE(text("stepper-picked").contains("by direction"));  // the default preset searches no tree
  const QImage with = view->picture();
  click("stepper-show-tree");
  EXPECT_NE(view->picture(), with);
  // A fate that is not shown is not drawn.
  const std::size_t drawn = view->layer().linesDrawn();
  QTest::mouseClick(find<QCheckBox>("stepper-fate-0"), Qt::LeftButton, {}, QPoint(8, 8));
  settle();
  EXPECT_EQ(view->layer().linesDrawn() + stepper().current()->report.pairs, drawn);
}

TEST_F(StepperViewTest, TheGizmoAndTheKeysMoveTheStart) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  click("stepper-adjust");
  (void)view->picture();
  const Pose before = stepper().start().start();
  const QPointF handle = placeOf(view->layer().handlePixel(ui::GizmoHandle::X));
  const QPointF far = handle + (handle - placeOf(view->scene().pixelOf(before.translation())));
  send(view->view(), QEvent::MouseButtonPress, handle, Qt::LeftButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseMove, handle + 0.15 * (far - handle), Qt::NoButton, Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] {
    const auto& ghost = stepper().start().ghost();
    return ghost && ghost->succeeded();
  })) << "where it would end is shown while the button is still down";
  const QImage with = view->picture();
  view->layer().setGhost({});
  EXPECT_NE(view->picture(), with);
  EXPECT_TRUE(find<QCheckBox>("stepper-ghost")->isChecked());
  send(view->view(), QEvent::MouseMove, far, Qt::NoButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseButtonRelease, far, Qt::LeftButton, Qt::NoButton);
  const Eigen::Vector3d shift = stepper().start().start().translation() - before.translation();
  EXPECT_GT(shift.x(), 0.1);
  EXPECT_NEAR(shift.y(), 0.0, 1e-9);
  EXPECT_NEAR(shift.z(), 0.0, 1e-9);
  (void)view->picture();
  const QPointF ring = placeOf(view->layer().handlePixel(ui::GizmoHandle::Turn));
  send(view->view(), QEvent::MouseButtonPress, ring, Qt::LeftButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseMove, ring + QPointF(14, 4), Qt::NoButton, Qt::LeftButton);
  send(view->view(), QEvent::MouseButtonRelease, ring + QPointF(14, 4), Qt::LeftButton, Qt::NoButton);
  EXPECT_GT(difference(stepper().start().start(), before).rotation_rad, 1.0 * kDegree);

  const Pose here = stepper().start().start();
  const auto moved = [&] {
    return Eigen::Vector3d(stepper().start().start().translation() - here.translation());
  };
  QTest::keyClick(view->view(), Qt::Key_Right);
  EXPECT_NEAR(moved().x(), 0.1, 1e-9);
  QTest::keyClick(view->view(), Qt::Key_Up, Qt::ShiftModifier);
  EXPECT_NEAR(moved().y(), 0.01, 1e-9);
  QTest::keyClick(view->view(), Qt::Key_PageDown);
  EXPECT_NEAR(moved().z(), -0.1, 1e-9);
  QTest::keyClick(view->view(), Qt::Key_Comma);
  EXPECT_NEAR(difference(stepper().start().start(), here).rotation_rad, 1.0 * kDegree, 1e-9);
  click("stepper-adjust");
  const Pose after = stepper().start().start();
  QTest::keyClick(view->view(), Qt::Key_Right);  // turns the view again
  EXPECT_EQ(stepper().start().start(), after);
}

TEST_F(StepperViewTest, PointsArePickedInBothScansAndMakeAStart) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  open("stepper-start");
  click("stepper-pick-points");
  (void)view->picture();
  EXPECT_TRUE(text("stepper-picked").contains("fixed (grey)"));
  const QRect inside = view->view()->rect();
  for (int k = 0; k < 6; ++k) {
    const bool of_fixed = k % 2 == 0;
    // Three different places, each as near to a point as the view has one.
    const QPointF wish(inside.width() * (0.35 + 0.12 * (k / 2)), inside.height() * (k / 2 == 1 ? 0.45 : 0.6));
    const double ratio = view->view()->devicePixelRatioF();
    const Eigen::Vector2d pixel(wish.x() * ratio, (view->view()->height() - wish.y()) * ratio);
    const auto point = view->layer().pickPoint(of_fixed, pixel, 1e5);
    ASSERT_TRUE(point);
    const Pose pose = of_fixed ? Pose() : stepper().pose();
    QTest::mouseClick(view->view(), Qt::LeftButton, {},
                      placeOf(view->scene().pixelOf(pose * *point)).toPoint());
    settle();
  }
  EXPECT_EQ(stepper().start().pointPairs().size(), 3U);
  EXPECT_EQ(find<QTableWidget>("stepper-points")->rowCount(), 3);
  ASSERT_TRUE(stepper().start().pointPairFit());
  EXPECT_EQ(find<QTableWidget>("stepper-points")->item(0, 1)->text(),
            QString::number(1e3 * stepper().start().pointPairFit()->residual_m[0], 'f', 1));
  click("stepper-use-points");
  EXPECT_TRUE(stepper().start().byHand());
  click("stepper-remove-point");
  EXPECT_EQ(stepper().start().pointPairs().size(), 2U);
}

TEST_F(StepperViewTest, TheViewShowsBothScansInTheirColours) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  ASSERT_TRUE(loaded());
  EXPECT_TRUE(text("stepper-view-title").contains("orange"));
  const QImage picture = view->picture();
  const ui::RegistrationColours colours = ui::RegistrationColours::of(theme.isDark());
  const auto shows = [&](Rgb colour) {
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x)
        if (picture.pixelColor(x, y) == QColor(colour.r, colour.g, colour.b)) return true;
    return false;
  };
  EXPECT_TRUE(shows(colours.fixed));
  EXPECT_TRUE(shows(colours.moving));
}

}  // namespace
}  // namespace tiltmap::test
