// Depth image and 3D view, driven by mouse and keyboard.
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QToolButton>

#include <gtest/gtest.h>

#include "core/products/scan_colours.h"
#include "tests/support/png_pixels.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/project_words.h"
#include "ui/panels/depth_image_panel.h"
#include "ui/panels/view3d_panel.h"

namespace tiltmap::test {
namespace {

using ui::CellPlace;
using ui::MatrixCell;

class ViewPanelsTest : public WindowTest {
 protected:
  void SetUp() override {
    makeProject(3);
    window->setPerspective(ui::Perspective::Inspect);
    settle();
    depth = qobject_cast<ui::DepthImagePanel*>(window->docks().panel("depth-image"));
    space = qobject_cast<ui::View3dPanel*>(window->docks().panel("view3d"));
    ASSERT_NE(depth, nullptr);
    ASSERT_NE(space, nullptr);
    workspace().selection().setCurrentScan(id(0));
    settle();
  }
  bool canDraw() {
    QOpenGLContext context;
    return context.create() && !space->picture().isNull();
  }
  MatrixCell firstPoint(std::size_t scan) {
    const RangeImagePtr image = must(snapshot().scans()[scan].image());
    for (int row = 1; row < image->rows(); ++row)
      for (int column = 1; column < image->columns(); ++column)
        if (image->hasPoint(row, column)) return {row, column};
    throw std::logic_error("no point");
  }
  void moveTo(QWidget* widget, const QPointF& place) {
    QMouseEvent event(QEvent::MouseMove, place, widget->mapToGlobal(place.toPoint()), Qt::NoButton,
                      Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(widget, &event);
    settle();
  }
  void drag(QWidget* widget, const QPointF& from, const QPointF& to,
            Qt::MouseButton button = Qt::LeftButton) {
    const auto send = [&](QEvent::Type type, const QPointF& place, Qt::MouseButton which,
                          Qt::MouseButtons held) {
      QMouseEvent event(type, place, widget->mapToGlobal(place.toPoint()), which, held, Qt::NoModifier);
      QApplication::sendEvent(widget, &event);
    };
    send(QEvent::MouseButtonPress, from, button, button);
    for (int k = 1; k <= 5; ++k) send(QEvent::MouseMove, from + k / 5.0 * (to - from), Qt::NoButton, button);
    send(QEvent::MouseButtonRelease, to, button, Qt::NoButton);
    settle();
  }
  void choose(const QString& combo, const QString& data) {
    auto* box = find<QComboBox>(combo);
    const int index = box->findData(data);
    ASSERT_GE(index, 0) << data.toStdString();
    box->setCurrentIndex(index);
    settle();
  }

  ui::DepthImagePanel* depth = nullptr;
  ui::View3dPanel* space = nullptr;
};

TEST_F(ViewPanelsTest, PointingAtACellReadsItAndMarksTheBeam) {
  const MatrixCell cell = firstPoint(0);
  ui::DepthView& view = depth->view(0);
  ASSERT_NE(view.image(), nullptr);
  EXPECT_EQ(view.cellAt(view.placeOf(cell)), cell);
  moveTo(&view, view.placeOf(cell));
  EXPECT_EQ(workspace().selection().hovered(), (CellPlace{id(0), cell.row, cell.column}));
  const RangeImagePtr image = must(snapshot().scans()[0].image());
  EXPECT_NE(depth->readout().indexOf(QString("Row %1, column %2").arg(cell.row).arg(cell.column)), -1);
  EXPECT_NE(
      depth->readout().indexOf(ui::lengthText(image->range(cell.row, cell.column), ui::LengthUnit::Metre)),
      -1)
      << depth->readout().toStdString();
  moveTo(&view, QPointF(1, 1));
  EXPECT_FALSE(workspace().selection().hovered());
}

TEST_F(ViewPanelsTest, ClickingACellPicksItAndArrowsMoveIt) {
  ui::DepthView& view = depth->view(0);
  QTest::mouseClick(&view, Qt::LeftButton, {}, view.placeOf({2, 3}).toPoint());
  EXPECT_EQ(workspace().selection().picked(), (CellPlace{id(0), 2, 3}));
  QTest::keyClick(&view, Qt::Key_Up);
  EXPECT_EQ(workspace().selection().picked(), (CellPlace{id(0), 3, 3}));  // higher tilt
  QTest::keyClick(&view, Qt::Key_Left);
  EXPECT_EQ(workspace().selection().picked(), (CellPlace{id(0), 3, 4}));  // larger azimuth
}

TEST_F(ViewPanelsTest, EveryQuantityIsShown) {
  for (const DepthQuantity quantity : kDepthQuantities) {
    choose("depth-quantity-0", ui::qt(depthQuantityName(quantity)));
    // Residuals are computed in the background.
    ASSERT_TRUE(waitUntil([&] { return depth->view(0).image() != nullptr; })) << depthQuantityName(quantity);
    ASSERT_NE(depth->view(0).image(), nullptr);
    EXPECT_EQ(depth->view(0).image()->quantity, quantity);
  }
}

TEST_F(ViewPanelsTest, ResidualsAreComputedAsideAndFollowTheStage) {
  choose("depth-quantity-0", "residual");
  ASSERT_TRUE(waitUntil([&] { return depth->view(0).image() != nullptr; }));
  EXPECT_EQ(find<QDoubleSpinBox>("depth-low")->value(), -find<QDoubleSpinBox>("depth-high")->value());
  const auto* label = find<QLabel>("depth-changed");
  EXPECT_NE(label->text().indexOf("Residual, " + ui::stageTitle(Stage::Odometry)), -1);
  // Poses on top of one another: everything overlaps.
  must(workspace().session().apply(
      posesEdit(Stage::Truth, {{id(0), Pose()}, {id(1), Pose()}, {id(2), Pose()}})));
  workspace().display().setStage(Stage::Truth);
  ASSERT_TRUE(waitUntil([&] {
    return depth->view(0).image() && label->text().indexOf("Residual, " + ui::stageTitle(Stage::Truth)) != -1;
  })) << label->text().toStdString();
  EXPECT_FALSE(workspace().residuals().isComputing() && workspace().residuals().wanted() == 0);
}

TEST_F(ViewPanelsTest, TwoImagesShareZoomAndShift) {
  EXPECT_FALSE(depth->view(1).isVisible());
  click("depth-two");
  EXPECT_TRUE(depth->view(1).isVisible());
  choose("depth-quantity-1", "median");
  EXPECT_EQ(depth->view(1).image()->quantity, DepthQuantity::Median);
  ui::DepthView& view = depth->view(0);
  const QPointF middle = view.rect().center();
  for (int i = 0; i < 6; ++i) QTest::keyClick(&view, Qt::Key_Plus);
  EXPECT_GT(view.seen().zoom, 2.0);
  EXPECT_EQ(depth->view(1).seen(), view.seen());
  const auto before = view.seen();
  drag(&view, middle, middle + QPointF(25, 0));
  EXPECT_LT(view.seen().centre.x(), before.centre.x());
  EXPECT_EQ(depth->view(1).seen(), view.seen());
  click("depth-fit");
  EXPECT_EQ(view.seen().zoom, 1.0);
}

TEST_F(ViewPanelsTest, ALockedRangeStaysFromScanToScan) {
  const auto own = depth->view(0).range();
  find<QDoubleSpinBox>("depth-low")->setValue(3.0);
  find<QDoubleSpinBox>("depth-high")->setValue(17.5);
  EXPECT_TRUE(find<QToolButton>("depth-lock")->isChecked());
  EXPECT_EQ(depth->view(0).range(), std::pair(3.0, 17.5));
  workspace().selection().setCurrentScan(id(1));
  EXPECT_EQ(depth->view(0).range(), std::pair(3.0, 17.5));
  workspace().selection().setCurrentScan(id(0));
  click("depth-lock");
  EXPECT_EQ(depth->view(0).range(), own);
}

TEST_F(ViewPanelsTest, DepthImageIsWrittenAsPng) {
  const std::filesystem::path file = folder / "depth.png";
  must(depth->writePicture(ui::qt(file)));
  const int one = pngPixels(file).width;
  click("depth-two");
  must(depth->writePicture(ui::qt(file)));
  EXPECT_EQ(pngPixels(file).width, 2 * one);
}

TEST_F(ViewPanelsTest, SpaceShowsTheScansInTheirColours) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  click("view3d-grid");
  click("view3d-path");
  find<QDoubleSpinBox>("view3d-point-size")->setValue(12.0);
  settle();
  const auto showsColour = [&](std::size_t scan) {
    const QImage picture = space->picture();
    const Rgb colour = scanColour(scan);
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x)
        if (picture.pixelColor(x, y) == QColor(colour.r, colour.g, colour.b)) return true;
    return false;
  };
  if (theme.isDark()) {
    EXPECT_TRUE(showsColour(0));
    EXPECT_TRUE(showsColour(2));
    workspace().display().setVisible({id(2)}, false);
    EXPECT_FALSE(showsColour(2));
  }
  const QImage before = space->picture();
  choose("view3d-colouring", "height");
  EXPECT_NE(space->picture(), before);
}

TEST_F(ViewPanelsTest, APointPickedInSpaceIsMarkedInTheDepthImage) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  space->scene().frame({id(1)});
  (void)space->picture();
  const MatrixCell cell = firstPoint(1);
  const auto world = space->scene().worldPoint({id(1), cell.row, cell.column});
  ASSERT_TRUE(world);
  const Eigen::Vector2d pixel = space->scene().pixelOf(*world);
  const double ratio = space->view()->devicePixelRatioF();
  const QPoint place(static_cast<int>(pixel.x() / ratio),
                     static_cast<int>(space->view()->height() - pixel.y() / ratio));
  ASSERT_TRUE(space->view()->rect().contains(place));
  QTest::mouseClick(space->view(), Qt::LeftButton, {}, place);
  settle();
  ASSERT_TRUE(workspace().selection().picked());
  const CellPlace picked = *workspace().selection().picked();
  // Another point may lie in front of it; the scan that was picked is the current one.
  EXPECT_EQ(workspace().selection().currentScan(), picked.scan);
  EXPECT_NE(depth->readout().indexOf(QString("Row %1, column %2").arg(picked.row).arg(picked.column)), -1);
}

TEST_F(ViewPanelsTest, KeysChooseViews) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  const auto up = [&](const Eigen::Vector3d& by) -> Eigen::Vector2d {
    return space->scene().pixelOf(by) - space->scene().pixelOf(Eigen::Vector3d::Zero());
  };
  (void)space->picture();
  QTest::keyClick(space->view(), Qt::Key_O);
  EXPECT_TRUE(space->scene().isOrthographic());
  EXPECT_TRUE(find<QToolButton>("view3d-orthographic")->isChecked());
  QTest::keyClick(space->view(), Qt::Key_8);
  EXPECT_NEAR(up({0, 0, 1}).norm(), 0.0, 1e-6);
  EXPECT_GT(up({0, 1, 0}).y(), 0.0);
  QTest::keyClick(space->view(), Qt::Key_5);
  EXPECT_GT(up({0, 0, 1}).y(), 0.0);
  EXPECT_GT(up({1, 0, 0}).x(), 0.0);
  QTest::keyClick(space->view(), Qt::Key_0);
  EXPECT_LT(up({1, 0, 0}).x(), 0.0);
  QTest::keyClick(space->view(), Qt::Key_6);
  EXPECT_GT(up({0, 1, 0}).x(), 0.0);
  QTest::keyClick(space->view(), Qt::Key_4);
  EXPECT_LT(up({0, 1, 0}).x(), 0.0);
  QTest::keyClick(space->view(), Qt::Key_2);
  EXPECT_LT(up({1, 0, 0}).x(), 0.0);
  const double all = space->scene().metresPerPixel();
  QTest::keyClick(space->view(), Qt::Key_F);
  EXPECT_NE(space->scene().metresPerPixel(), all);
}

TEST_F(ViewPanelsTest, DraggingTurnsTheMap) {
  if (!canDraw()) GTEST_SKIP() << "no OpenGL";
  (void)space->picture();
  const Eigen::Vector2d before = space->scene().pixelOf({5, 5, 0});
  const QPointF middle = QRectF(space->view()->rect()).center();
  drag(space->view(), middle, middle + QPointF(60, 20));
  EXPECT_GT((space->scene().pixelOf({5, 5, 0}) - before).norm(), 1.0);
}

}  // namespace
}  // namespace tiltmap::test
