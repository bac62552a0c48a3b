// The 3D view's tools, driven by mouse and keyboard, at every scale of the screen.
#include <QApplication>
#include <QCheckBox>
#include <QClipboard>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QMouseEvent>
#include <QOpenGLContext>
#include <QProcess>
#include <QPushButton>
#include <QSpinBox>
#include <QToolButton>

#include <gtest/gtest.h>

#include "core/products/scan_colours.h"
#include "tests/support/png_pixels.h"
#include "tests/ui/scene/wall_scenes.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/project_words.h"
#include "ui/panels/view3d_panel.h"

namespace tiltmap::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ui::CellPlace;

class View3dToolsTest : public WindowTest {
 protected:
  void SetUp() override {
    QOpenGLContext context;
    if (!context.create()) GTEST_SKIP() << "no OpenGL";
    fill(window);
    space = viewOf(window);
    ASSERT_NE(space, nullptr);
    view = space->view();
    prepare(*space);
  }
  // Two walls side by side, seen along +y; registered they have changed places.
  void fill(ui::MainWindow* into, const std::string& name = "walls.tiltmap") {
    ui::Workspace& there = into->workspace();
    must(there.session().create(ui::qt(folder / name)));
    WallGrid coarse;
    coarse.rows = 21, coarse.columns = 31;
    must(there.session().apply(
        importEdit({wallOf(Pose(), "left", coarse), wallOf(Pose::planar(8, 0, 0), "right", coarse)})));
    const auto ids = scanIds(*there.snapshot());
    must(there.session().apply(posesEdit(Stage::Truth, {{ids[0], Pose::planar(8, 0, 0)}, {ids[1], Pose()}})));
    settle();
  }
  static ui::View3dPanel* viewOf(ui::MainWindow* of) {
    of->setPerspective(ui::Perspective::Inspect);
    QCoreApplication::processEvents();
    return qobject_cast<ui::View3dPanel*>(of->docks().panel("view3d"));
  }
  void prepare(ui::View3dPanel& panel) {
    for (const char* name : {"view3d-grid", "view3d-path"})
      panel.findChild<QToolButton*>(name)->setChecked(false);
    panel.findChild<QToolButton*>("view3d-shaded")->setChecked(false);
    panel.findChild<QComboBox*>("view3d-colouring")->setCurrentIndex(0);
    panel.findChild<QDoubleSpinBox*>("view3d-point-size")->setValue(8.0);
    if (!panel.scene().isOrthographic()) QTest::keyClick(panel.view(), Qt::Key_O);
    QTest::keyClick(panel.view(), Qt::Key_5);
    settle();
    (void)panel.picture();
  }
  QPointF placeOf(const Vector2d& pixel) {
    const double ratio = view->devicePixelRatioF();
    return {pixel.x() / ratio, view->height() - pixel.y() / ratio};
  }
  QPointF placeOf(const Vector3d& world) { return placeOf(space->scene().pixelOf(world)); }
  QColor colourAt(const QImage& picture, const Vector3d& world) {
    const Vector2d pixel = space->scene().pixelOf(world);
    return picture.pixelColor(
        std::clamp(static_cast<int>(pixel.x()), 0, picture.width() - 1),
        std::clamp(picture.height() - 1 - static_cast<int>(pixel.y()), 0, picture.height() - 1));
  }
  // As the theme shows it: on a light ground a little darker.
  bool isScan(const QColor& colour, std::size_t scan) {
    Rgb wanted = scanColour(scan);
    if (!theme.isDark()) wanted = mixed(wanted, {0, 0, 0}, 0.25);
    return std::abs(colour.red() - wanted.r) < 6 && std::abs(colour.green() - wanted.g) < 6 &&
           std::abs(colour.blue() - wanted.b) < 6;
  }
  // A point of the wall that is drawn there: cells are further apart than points are large.
  Vector3d pointOf(std::size_t scan, int row = 10, int column = 15) {
    return *space->scene().worldPoint({id(scan), row, column});
  }
  void send(QEvent::Type type, const QPointF& place, Qt::MouseButton which, Qt::MouseButtons held) {
    QMouseEvent event(type, place, view->mapToGlobal(place.toPoint()), which, held, Qt::NoModifier);
    QApplication::sendEvent(view, &event);
  }
  void drag(const QPointF& from, const QPointF& to) {
    send(QEvent::MouseButtonPress, from, Qt::LeftButton, Qt::LeftButton);
    for (int k = 1; k <= 6; ++k)
      send(QEvent::MouseMove, from + k / 6.0 * (to - from), Qt::NoButton, Qt::LeftButton);
    send(QEvent::MouseButtonRelease, to, Qt::LeftButton, Qt::NoButton);
    settle();
  }
  void clickAt(const QPointF& place) {
    send(QEvent::MouseButtonPress, place, Qt::LeftButton, Qt::LeftButton);
    send(QEvent::MouseButtonRelease, place, Qt::LeftButton, Qt::NoButton);
    settle();
  }

  ui::View3dPanel* space = nullptr;
  QWidget* view = nullptr;
};

TEST_F(View3dToolsTest, TheDividerOfAComparisonIsDragged) {
  workspace().display().setStage(Stage::Odometry);
  settle();
  const Vector3d left = pointOf(0), right = pointOf(1);
  click("view3d-compare");
  EXPECT_TRUE(find("view3d-compare-bar")->isVisible());
  EXPECT_EQ(find<QComboBox>("compare-before")->currentText(), ui::stageTitle(Stage::Truth));
  (void)space->picture();
  // The bar took some height: the walls have moved in the picture.
  EXPECT_TRUE(isScan(colourAt(space->picture(), left), 1));
  EXPECT_TRUE(isScan(colourAt(space->picture(), right), 1));
  const QPointF grip(0.5 * view->width(), 0.3 * view->height());
  const Vector3d before_turn(space->scene().pixelOf(left).x(), space->scene().pixelOf(left).y(), 0);
  drag(grip, QPointF(view->width() - 2.0, grip.y()));
  EXPECT_GT(space->scene().divider(), 0.98);
  EXPECT_TRUE(isScan(colourAt(space->picture(), right), 0));
  EXPECT_NEAR(space->scene().pixelOf(left).x(), before_turn.x(), 0.01);  // the map did not turn
  click("view3d-compare");
  EXPECT_FALSE(find("view3d-compare-bar")->isVisible());
  EXPECT_TRUE(isScan(colourAt(space->picture(), left), 0));
}

TEST_F(View3dToolsTest, BlinkingGoesOnByItself) {
  workspace().display().setStage(Stage::Odometry);
  click("view3d-compare");
  find<QComboBox>("compare-how")->setCurrentIndex(1);
  find<QDoubleSpinBox>("compare-period")->setValue(0.2);
  settle();
  const Vector3d left = pointOf(0);
  EXPECT_TRUE(waitUntil([&] { return space->scene().showsBefore(); }));
  EXPECT_TRUE(isScan(colourAt(space->picture(), left), space->scene().showsBefore() ? 1 : 0));
  EXPECT_TRUE(waitUntil([&] { return !space->scene().showsBefore(); }));
  click("view3d-compare");
  EXPECT_EQ(space->scene().compare(), ui::SceneCompare::Off);
}

TEST_F(View3dToolsTest, WithOneStageThereIsNothingToCompareAndThatIsSaid) {
  must(workspace().session().undo());  // the second stage goes
  settle();
  click("view3d-compare");
  EXPECT_FALSE(find<QComboBox>("compare-before")->isEnabled());
  EXPECT_NE(find<QLabel>("compare-hint")->text().indexOf("register"), -1);
  EXPECT_EQ(space->scene().compare(), ui::SceneCompare::Off);
}

TEST_F(View3dToolsTest, TheSliceBoxFollowsNumbersPresetsAndTheMouse) {
  workspace().display().setStage(Stage::Odometry);
  settle();
  click("view3d-slice");
  ASSERT_TRUE(space->scene().slice());
  const Vector3d left = pointOf(0), low = pointOf(0, 1, 15);
  EXPECT_TRUE(isScan(colourAt(space->picture(), left), 0));  // everything is inside
  find<QDoubleSpinBox>("slice-x-low")->setValue(4.0);
  settle();
  EXPECT_EQ(space->scene().slice()->low.x(), 4.0);
  EXPECT_FALSE(isScan(colourAt(space->picture(), left), 0));
  EXPECT_TRUE(isScan(colourAt(space->picture(), pointOf(1)), 1));
  click("slice-whole");
  EXPECT_TRUE(isScan(colourAt(space->picture(), low), 0));
  click("slice-level");
  EXPECT_NEAR(space->scene().slice()->high.z() - space->scene().slice()->low.z(), 0.2, 1e-9);
  EXPECT_TRUE(isScan(colourAt(space->picture(), left), 0));
  EXPECT_FALSE(isScan(colourAt(space->picture(), low), 0));
  click("slice-whole");
  (void)space->picture();
  const auto handle = space->scene().pixelOf(ui::SliceHandle{0, false});
  ASSERT_TRUE(handle);
  const double before = find<QDoubleSpinBox>("slice-x-low")->value();
  drag(placeOf(*handle), placeOf(*handle) + QPointF(40, 0));
  EXPECT_GT(find<QDoubleSpinBox>("slice-x-low")->value(), before + 0.1);
  EXPECT_NEAR(find<QDoubleSpinBox>("slice-x-low")->value(), space->scene().slice()->low.x(), 0.006);
  click("view3d-slice");
  EXPECT_FALSE(space->scene().slice());
  EXPECT_TRUE(isScan(colourAt(space->picture(), left), 0));
}

TEST_F(View3dToolsTest, DistancesAreMeasuredCopiedAndCleared) {
  workspace().display().setStage(Stage::Odometry);
  settle();
  QTest::keyClick(view, Qt::Key_M);
  EXPECT_TRUE(find<QToolButton>("view3d-measure")->isChecked());
  settle();
  (void)space->picture();
  const Vector3d from = pointOf(0), to = pointOf(1);
  clickAt(placeOf(from));
  EXPECT_EQ(space->scene().measured().size(), 1U);
  EXPECT_FALSE(find("measure-copy")->isEnabled());
  clickAt(placeOf(to));
  ASSERT_EQ(space->scene().measured().size(), 2U);
  const double length = (to - from).norm();
  EXPECT_NEAR((space->scene().measured()[1] - space->scene().measured()[0]).norm(), length, 1e-3);
  EXPECT_NE(find<QLabel>("measure-reading")->text().indexOf(ui::lengthText(length, ui::LengthUnit::Metre)),
            -1);
  click("measure-copy");
  EXPECT_EQ(QApplication::clipboard()->text(), find<QLabel>("measure-reading")->text());
  EXPECT_FALSE(workspace().selection().picked());  // measuring picks nothing else
  const QImage with_line = space->picture();
  QTest::keyClick(view, Qt::Key_Escape);
  EXPECT_TRUE(space->scene().measured().empty());
  EXPECT_NE(space->picture(), with_line);
  EXPECT_TRUE(find<QToolButton>("view3d-measure")->isChecked());
  QTest::keyClick(view, Qt::Key_Escape);
  EXPECT_FALSE(find<QToolButton>("view3d-measure")->isChecked());
}

TEST_F(View3dToolsTest, ShadingAndResidualsChangeThePicture) {
  const QImage plain = space->picture();
  click("view3d-shaded");
  EXPECT_TRUE(space->scene().settings().shaded);
  EXPECT_EQ(preferences.text("view3d/shaded"), "1");
  click("view3d-shaded");
  EXPECT_FALSE(space->scene().settings().shaded);
  EXPECT_EQ(space->picture(), plain);
  auto* colouring = find<QComboBox>("view3d-colouring");
  colouring->setCurrentIndex(colouring->findData("residual"));
  settle();
  EXPECT_TRUE(waitUntil([&] {
    return !workspace().residuals().isComputing() && find<QLabel>("view3d-computing")->isHidden();
  }));
  EXPECT_EQ(workspace().residuals().ofAll(workspace().display().stage()).size(), 2U);
  EXPECT_NE(space->picture(), plain);
}

TEST_F(View3dToolsTest, PicturesAreSavedAtAnySize) {
  workspace().display().setStage(Stage::Odometry);
  settle();
  click("view3d-save");
  find<QSpinBox>("picture-width")->setValue(1600);
  find<QSpinBox>("picture-height")->setValue(1000);
  find<QCheckBox>("picture-white")->setChecked(true);
  const QImage shown = space->picture();
  click("picture-save");
  auto* dialog = space->findChild<QFileDialog*>();
  if (!dialog) dialog = window->findChild<QFileDialog*>();
  ASSERT_NE(dialog, nullptr);
  dialog->close();
  const std::filesystem::path file = folder / "view.png";
  must(space->writePicture(ui::qt(file), {1600, 1000}, true));
  const RgbImage saved = pngPixels(file);
  ASSERT_EQ(saved.width, 1600);
  ASSERT_EQ(saved.height, 1000);
  EXPECT_EQ(saved.at(3, 3), (Rgb{255, 255, 255}));
  int coloured = 0;
  const Rgb wanted = mixed(scanColour(0), {0, 0, 0}, 0.25);
  for (const Rgb c : saved.pixels)
    coloured += std::abs(c.r - wanted.r) + std::abs(c.g - wanted.g) + std::abs(c.b - wanted.b) < 9;
  EXPECT_GT(coloured, 500);
  EXPECT_EQ(space->picture(), shown);  // the view is as it was
  EXPECT_FALSE(space->writePicture(ui::qt(file), {8, 8}, false));
}

TEST_F(View3dToolsTest, TwoWindowsDrawEachTheirOwnProject) {
  ui::MainWindow* second = openWindow();
  fill(second, "others.tiltmap");
  ui::View3dPanel* other = viewOf(second);
  ASSERT_NE(other, nullptr);
  prepare(*other);
  must(second->workspace().session().apply(renameEdit(second->workspace().snapshot()->scans()[0].id, "x")));
  second->workspace().display().setVisible({second->workspace().snapshot()->scans()[1].id}, false);
  settle();
  const auto colours = [&](ui::View3dPanel& panel, std::size_t scan) {
    const QImage picture = panel.picture();
    int count = 0;
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x) count += isScan(picture.pixelColor(x, y), scan);
    return count;
  };
  for (int round = 0; round < 2; ++round) {
    EXPECT_GT(colours(*space, 0), 500);
    EXPECT_GT(colours(*space, 1), 500);
    EXPECT_GT(colours(*other, 0), 500);
    EXPECT_LT(colours(*other, 1), 20);
  }
  second->workspace().jobs().cancelAll();
  delete second;
  EXPECT_GT(colours(*space, 1), 500);  // the other's end took nothing along
}

// Through the real widget: what is clicked is what is picked, and is drawn where it is clicked.
TEST_F(View3dToolsTest, PickingIsRightAtThisScaleOfTheScreen) {
  workspace().display().setStage(Stage::Odometry);
  settle();
  const QImage picture = space->picture();
  const double ratio = view->devicePixelRatioF();
  if (const QByteArray wanted = qgetenv("TILTMAP_TEST_SCALE"); !wanted.isEmpty()) {
    ASSERT_NEAR(ratio, wanted.toDouble(), 1e-6);
  }
  ASSERT_NEAR(picture.width(), view->width() * ratio, 1.01);
  for (const CellPlace wanted : {CellPlace{id(0), 10, 15}, CellPlace{id(1), 3, 4}, CellPlace{id(1), 18, 27},
                                 CellPlace{id(0), 2, 28}}) {
    const Vector3d point = pointOf(wanted.scan == id(0) ? 0 : 1, wanted.row, wanted.column);
    EXPECT_TRUE(isScan(colourAt(picture, point), wanted.scan == id(0) ? 0 : 1)) << "at " << ratio;
    const QPointF place = placeOf(point);
    ASSERT_TRUE(view->rect().contains(place.toPoint()));
    clickAt(place);
    ASSERT_TRUE(workspace().selection().picked()) << "at " << ratio;
    EXPECT_EQ(*workspace().selection().picked(), wanted) << "at " << ratio;
    send(QEvent::MouseMove, place, Qt::NoButton, Qt::NoButton);
    EXPECT_EQ(workspace().selection().hovered(), wanted) << "at " << ratio;
  }
  clickAt(QPointF(3, 3));
  EXPECT_FALSE(workspace().selection().picked());
}

// The scale is read when an application begins: each has a process of its own.
TEST(View3dScales, PickingIsRightAtEveryScale) {
  if (qEnvironmentVariableIsSet("TILTMAP_TEST_SCALE")) GTEST_SKIP() << "in one of them";
  {
    QOpenGLContext context;
    if (!context.create()) GTEST_SKIP() << "no OpenGL";
  }
  for (const char* scale : {"1", "1.25", "1.5", "2"}) {
    QProcess child;
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert("QT_SCALE_FACTOR", scale);
    environment.insert("TILTMAP_TEST_SCALE", scale);
    child.setProcessEnvironment(environment);
    child.setProcessChannelMode(QProcess::MergedChannels);
    child.start(QCoreApplication::applicationFilePath(),
                {"--gtest_filter=View3dToolsTest.PickingIsRightAtThisScaleOfTheScreen"});
    ASSERT_TRUE(child.waitForFinished(120000)) << scale;
    const QByteArray said = child.readAll();
    EXPECT_EQ(child.exitCode(), 0) << scale << "\n" << said.toStdString();
    EXPECT_TRUE(said.contains("[  PASSED  ] 1 test")) << scale << "\n" << said.toStdString();
  }
}

}  // namespace
}  // namespace tiltmap::test
