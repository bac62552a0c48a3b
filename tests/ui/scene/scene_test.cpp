// The 3D scene without widgets and without a display.
#include "ui/scene/scene.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/products/scan_colours.h"
#include "tests/support/project_samples.h"
#include "tests/support/range_images.h"
#include "tests/support/temporary_folder.h"
#include "ui/scene/offscreen_window.h"
#include "ui/scene/scene_camera.h"
#include "ui/scene/screenshots.h"

namespace tiltmap::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ui::CellPlace;
using ui::Scene;
using ui::SceneCamera;
using ui::SceneColouring;
using ui::SceneColours;
using ui::SceneSettings;
using ui::SceneView;

constexpr int kWidth = 480, kHeight = 360;

// A dense patch of a wall 4 m ahead of the scanner: fills its part of the picture.
Scan wallScan(const Pose& odometry, const std::string& name) {
  Scan scan;
  scan.geometry.rows = 81;
  scan.geometry.columns = 161;
  scan.geometry.azimuth_start_rad = 70.0 * kDegree;
  scan.geometry.azimuth_step_rad = 0.25 * kDegree;
  scan.geometry.tilt_start_rad = -20.0 * kDegree;
  scan.geometry.tilt_step_rad = 0.5 * kDegree;
  scan.image = testing_support::imageOfScene(scan.geometry, [](const Vector3d& d) { return 4.0 / d.y(); });
  scan.odometry = odometry;
  scan.name = name;
  scan.source = "a wall";
  return scan;
}

int differenceOf(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

class SceneTest : public ::testing::Test {
 protected:
  SceneTest() : project(must(Project::create(folder / "walls.tiltmap"))) {
    // Two walls side by side, 8 m apart, seen along +y.
    must(project->apply(importEdit({wallScan(Pose(), "left"), wallScan(Pose::planar(8, 0, 0), "right")})));
  }
  void SetUp() override {
    auto made = ui::OffscreenWindow::make(kWidth, kHeight);
    if (!made) GTEST_SKIP() << made.error().what << " (" << made.error().remedy << ")";
    window = std::move(*made);
    scene = std::make_unique<Scene>();
    scene->attach(window->window());
    SceneSettings settings;
    settings.point_px = 6.0;
    settings.path = settings.grid = settings.axes = false;
    scene->setSettings(settings);
    scene->setOrthographic(true);
    scene->setView(SceneView::Front);
  }
  void TearDown() override {
    if (scene) scene->detach();
  }
  SnapshotPtr snapshot() const { return project->snapshot(); }
  ScanId id(std::size_t index) const { return snapshot()->scans()[index].id; }
  RgbImage drawn() {
    scene->render();
    return window->picture();
  }
  Rgb at(const RgbImage& picture, const Vector3d& world) {
    const Vector2d pixel = scene->pixelOf(world);
    return picture.at(static_cast<int>(pixel.x()), picture.height - 1 - static_cast<int>(pixel.y()));
  }
  void change(const std::function<void(SceneSettings&)>& how) {
    SceneSettings settings = scene->settings();
    how(settings);
    EXPECT_TRUE(scene->setSettings(settings).empty());
  }
  int litPixels(const RgbImage& picture) {
    int count = 0;
    for (const Rgb c : picture.pixels) count += std::max({c.r, c.g, c.b}) > 100;
    return count;
  }

  TemporaryFolder folder;
  std::unique_ptr<Project> project;
  std::unique_ptr<ui::OffscreenWindow> window;
  std::unique_ptr<Scene> scene;
};

// As while it is captured: lines are added to the same matrix.
TEST_F(SceneTest, AScanThatGrowsIsSeenGrowing) {
  Scan begun = wallScan(Pose::planar(16, 0, 0), "next");
  const RangeImagePtr whole = std::exchange(begun.image, nullptr);
  const Change change = must(project->apply({"begin", {AddScan{begun, {}, {}, {}, {}}}, nullptr, {}, {}}));
  const auto drawnPoints = [&] {
    scene->show(snapshot(), Stage::Odometry);
    drawn();
    return scene->pointsDrawn();
  };
  std::size_t before = drawnPoints();
  for (int row = 38; row < 42; ++row) {
    ScanLine line;
    line.tilt_rad = begun.geometry.tiltOfRow(row);
    for (int column = 0; column < whole->columns(); ++column) {
      line.range_m.push_back(whole->range(row, column));
      line.code.push_back(whole->code(row, column));
    }
    must(project->appendLine(change.scans_added.at(0), row, line));
    const std::size_t now = drawnPoints();
    EXPECT_EQ(now, before + static_cast<std::size_t>(whole->columns())) << row;
    before = now;
  }
}

TEST_F(SceneTest, ScansStandInTheirPlacesInTheirColours) {
  EXPECT_TRUE(scene->show(snapshot(), Stage::Odometry).empty());
  const RgbImage picture = drawn();
  EXPECT_LE(differenceOf(at(picture, {0, 4, 0}), scanColour(0)), 3);
  EXPECT_LE(differenceOf(at(picture, {8, 4, 0}), scanColour(1)), 3);
  // Between the walls there is ground only.
  EXPECT_LT(std::max({at(picture, {4, 4, 0}).r, at(picture, {4, 4, 0}).g, at(picture, {4, 4, 0}).b}), 80);
}

TEST_F(SceneTest, AScanHasTheColourThatWasChosen) {
  scene->show(snapshot(), Stage::Odometry);
  must(project->apply(colourEdit(*snapshot(), {id(1)}, 0x10c820U)));
  scene->show(snapshot(), Stage::Odometry);
  const RgbImage picture = drawn();
  EXPECT_LE(differenceOf(at(picture, {8, 4, 0}), Rgb{0x10, 0xc8, 0x20}), 3);
  EXPECT_LE(differenceOf(at(picture, {0, 4, 0}), scanColour(0)), 3);
}

TEST_F(SceneTest, AnEmptySceneIsTheBackgroundAlone) {
  EXPECT_EQ(litPixels(drawn()), 0);
  scene->show(snapshot(), Stage::Odometry);
  EXPECT_GT(litPixels(drawn()), 5000);
  scene->show(nullptr, Stage::Odometry);
  EXPECT_EQ(litPixels(drawn()), 0);
}

TEST_F(SceneTest, HiddenScansAreNotDrawn) {
  scene->show(snapshot(), Stage::Odometry);
  const int both = litPixels(drawn());
  scene->setVisible([this](ScanId scan) { return scan == id(1); });
  const RgbImage picture = drawn();
  EXPECT_LT(differenceOf(at(picture, {8, 4, 0}), scanColour(1)), 4);
  EXPECT_GT(differenceOf(at(picture, {0, 4, 0}), scanColour(0)), 40);
  EXPECT_LT(litPixels(picture), both);
}

TEST_F(SceneTest, StagesMoveTheScans) {
  must(project->apply(posesEdit(Stage::Truth, {{id(0), Pose()}, {id(1), Pose::planar(8, 0, 1.5)}})));
  scene->show(snapshot(), Stage::Odometry);
  const RgbImage before = drawn();
  scene->show(snapshot(), Stage::Truth);
  const RgbImage after = drawn();
  EXPECT_NE(before.pixels, after.pixels);
  // The wall ahead of the second stop has turned to its left.
  EXPECT_GT(differenceOf(at(after, {8, 4, 0}), scanColour(1)), 40);
}

TEST_F(SceneTest, ColouredByHeightAndRange) {
  scene->show(snapshot(), Stage::Odometry);
  change([](SceneSettings& s) { s.colouring = SceneColouring::Height; });
  const RgbImage height = drawn();
  const auto luma = [](Rgb c) { return 3 * c.r + 6 * c.g + c.b; };
  EXPECT_GT(luma(at(height, {0, 4, 1.3})), luma(at(height, {0, 4, 0})) + 100);
  EXPECT_GT(luma(at(height, {0, 4, 0})), luma(at(height, {0, 4, -1.3})) + 100);
  EXPECT_LE(differenceOf(at(height, {0, 4, 0.4}), at(height, {8, 4, 0.4})), 6);  // not by scan
  change([](SceneSettings& s) { s.colouring = SceneColouring::Range; });
  const RgbImage range = drawn();
  EXPECT_GT(luma(at(range, {1.3, 4, 0})), luma(at(range, {0, 4, 0})) + 100);  // further from the scanner
  change([](SceneSettings& s) { s.colouring = SceneColouring::Intensity; });
  EXPECT_LE(differenceOf(at(drawn(), {0, 4, 0}), SceneColours::dark().no_data), 3);  // there is none
  change([](SceneSettings& s) { s.colouring = SceneColouring::Age; });
  const RgbImage age = drawn();
  EXPECT_GT(luma(at(age, {8, 4, 0})), luma(at(age, {0, 4, 0})) + 500);
  change([](SceneSettings& s) { s.colouring = SceneColouring::Normal; });
  const Rgb towards = at(drawn(), {0, 4, 0});  // (0, -1, 0)
  EXPECT_NEAR(towards.g, 0, 8);
  EXPECT_NEAR(towards.r, 128, 8);
}

TEST_F(SceneTest, ViewsLookFromWhereTheySay) {
  scene->show(snapshot(), Stage::Odometry);
  // From above x goes right and y up; from the front x right, z up; from the right y goes right.
  const auto moves = [&](const Vector3d& by) -> Vector2d {
    return scene->pixelOf(Vector3d(4, 2, 0) + by) - scene->pixelOf(Vector3d(4, 2, 0));
  };
  const auto expect = [&](SceneView view, const Vector3d& right, const Vector3d& up) {
    scene->setView(view);
    EXPECT_GT(moves(right).x(), 1.0);
    EXPECT_NEAR(moves(right).y(), 0.0, 1e-6);
    EXPECT_GT(moves(up).y(), 1.0);
    EXPECT_NEAR(moves(up).x(), 0.0, 1e-6);
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  expect(SceneView::Top, x, y);
  expect(SceneView::Front, x, z);
  expect(SceneView::Back, -x, z);
  expect(SceneView::Right, y, z);
  expect(SceneView::Left, -y, z);
  expect(SceneView::Bottom, -x, y);
}

TEST_F(SceneTest, EveryViewShowsEverything) {
  scene->show(snapshot(), Stage::Odometry);
  for (const bool orthographic : {true, false})
    for (const SceneView view : {SceneView::Top, SceneView::Front, SceneView::Left, SceneView::Iso}) {
      scene->setOrthographic(orthographic);
      scene->setView(view);
      for (const Vector3d& corner : {Vector3d(-1, 4, 1), Vector3d(9, 4, -1)}) {
        const Vector2d pixel = scene->pixelOf(corner);
        EXPECT_GT(pixel.minCoeff(), 0.0);
        EXPECT_LT(pixel.x(), kWidth);
        EXPECT_LT(pixel.y(), kHeight);
      }
    }
}

TEST_F(SceneTest, FramingLooksAtTheSelectionOnly) {
  scene->show(snapshot(), Stage::Odometry);
  const double all = scene->metresPerPixel();
  scene->frame({id(1)});
  EXPECT_LT(scene->metresPerPixel(), all);
  EXPECT_NEAR(scene->pixelOf({8, 2, 0}).x(), kWidth / 2.0, kWidth / 8.0);
}

TEST_F(SceneTest, PickingFindsTheBeamOnTop) {
  scene->show(snapshot(), Stage::Odometry);
  for (const double ratio : {1.0, 1.25, 2.0}) {
    scene->setPixelRatio(ratio);
    drawn();
    for (const CellPlace wanted :
         {CellPlace{id(0), 40, 80}, CellPlace{id(1), 10, 30}, CellPlace{id(1), 70, 150}}) {
      const auto point = scene->worldPoint(wanted);
      ASSERT_TRUE(point);
      const auto picked = scene->pick(scene->pixelOf(*point), 5.0);
      ASSERT_TRUE(picked);
      EXPECT_EQ(*picked, wanted);
    }
    EXPECT_FALSE(scene->pick(scene->pixelOf({4, 4, 0}), 5.0));
  }
  // Hidden points cannot be picked.
  scene->setVisible([this](ScanId scan) { return scan == id(1); });
  EXPECT_FALSE(scene->pick(scene->pixelOf({0, 4, 0}), 5.0));
}

TEST_F(SceneTest, PickingInPerspectiveTakesTheNearer) {
  scene->show(snapshot(), Stage::Odometry);
  scene->setOrthographic(false);
  scene->setView(SceneView::Left);  // along +x: the walls edge on, the first in front
  const auto near_point = scene->worldPoint({id(0), 40, 80});
  const auto picked = scene->pick(scene->pixelOf(*near_point), 8.0);
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->scan, id(0));
  scene->setView(SceneView::Right);
  const auto other = scene->pick(scene->pixelOf(*scene->worldPoint({id(1), 40, 80})), 8.0);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->scan, id(1));
}

TEST_F(SceneTest, MarksAreSeenThroughThePoints) {
  scene->show(snapshot(), Stage::Odometry);
  const RgbImage before = drawn();
  scene->markHovered(CellPlace{id(0), 40, 80});
  const RgbImage hovered = drawn();
  const Rgb mark = at(hovered, {0, 4, 0});
  EXPECT_GT(mark.r, 200);
  EXPECT_LT(mark.b, 120);
  scene->markHovered({});
  EXPECT_EQ(drawn().pixels, before.pixels);
  scene->markPicked(CellPlace{id(1), 40, 80});
  EXPECT_NE(drawn().pixels, before.pixels);
  // Cells that are not there mark nothing.
  scene->markPicked(CellPlace{id(1), 400, 80});
  EXPECT_EQ(drawn().pixels, before.pixels);
  scene->markPicked(CellPlace{999999, 0, 0});
  EXPECT_EQ(drawn().pixels, before.pixels);
}

TEST_F(SceneTest, ReducedPointsAreFewer) {
  scene->show(snapshot(), Stage::Odometry);
  const std::size_t all = scene->pointsDrawn();
  EXPECT_EQ(all, 2U * 81U * 161U);
  change([](SceneSettings& s) { s.reduced = true; });
  EXPECT_LT(scene->pointsDrawn(), all / 2);
  EXPECT_GT(scene->pointsDrawn(), 100U);
  change([](SceneSettings& s) { s.reduced = false; });
  EXPECT_EQ(scene->pointsDrawn(), all);
}

TEST_F(SceneTest, PathGridTriadAndScaleBarCanBeShown) {
  scene->show(snapshot(), Stage::Odometry);
  scene->setView(SceneView::Top);
  const RgbImage bare = drawn();  // with the scale bar of an orthographic view
  for (const auto& turn_on :
       {+[](SceneSettings& s) { s.path = true; }, +[](SceneSettings& s) { s.grid = true; },
        +[](SceneSettings& s) { s.axes = true; }}) {
    const SceneSettings before = scene->settings();
    change(turn_on);
    EXPECT_NE(drawn().pixels, bare.pixels);
    scene->setSettings(before);
    EXPECT_EQ(drawn().pixels, bare.pixels);
  }
  const auto lit_corner = [](const RgbImage& picture) {
    int count = 0;
    for (int y = kHeight - 40; y < kHeight; ++y)
      for (int x = kWidth - 160; x < kWidth; ++x) count += picture.at(x, y).r > 150;
    return count;
  };
  EXPECT_GT(lit_corner(bare), 100);
  scene->setOrthographic(false);
  EXPECT_EQ(lit_corner(drawn()), 0);
}

TEST_F(SceneTest, PointSizeAndBackgroundFollow) {
  scene->show(snapshot(), Stage::Odometry);
  const int large = litPixels(drawn());
  change([](SceneSettings& s) { s.point_px = 1.0; });
  EXPECT_LT(litPixels(drawn()), large);
  scene->setColours(SceneColours::white());
  EXPECT_EQ(drawn().at(2, 2), (Rgb{255, 255, 255}));
}

TEST_F(SceneTest, TurnedByHandTheMapStaysUprightAndComesBack) {
  scene->show(snapshot(), Stage::Odometry);
  scene->setOrthographic(false);
  scene->setView(SceneView::Front);
  drawn();
  const Vector2d there = scene->pixelOf({0, 4, 0});
  scene->setPivot(there);  // on a point: it stays where it is
  scene->turn({60, 25});
  EXPECT_LT((scene->pixelOf({0, 4, 0}) - there).norm(), 3.0);
  EXPECT_GT((scene->pixelOf({8, 4, 0}) - there).norm(), 3.0);
  scene->zoom(2.0);
  EXPECT_LT((scene->pixelOf({0, 4, 0}) - there).norm(), 3.0);
  const Vector2d upright = scene->pixelOf({0, 4, 1}) - scene->pixelOf({0, 4, -1});
  EXPECT_GT(upright.y(), 5 * std::abs(upright.x()));
  scene->pan({30, -10});
  EXPECT_NEAR((scene->pixelOf({0, 4, 0}) - there).x(), 30, 3);
  EXPECT_NEAR((scene->pixelOf({0, 4, 0}) - there).y(), -10, 3);
  scene->setView(SceneView::Front);
  EXPECT_LT((scene->pixelOf({0, 4, 0}) - there).norm(), 0.5);
}

TEST_F(SceneTest, FewPointsWhileMovingAllWhenStill) {
  scene->show(snapshot(), Stage::Odometry);
  const std::size_t all = scene->pointsDrawn();
  scene->setMoving(true);
  EXPECT_EQ(scene->pointsDrawn(), all);  // these are few already
  EXPECT_GT(litPixels(drawn()), 5000);
  scene->setMoving(false);
  EXPECT_EQ(scene->pointsDrawn(), all);
}

TEST(EvenlyStrided, SpreadsOverAllAndNeverGoesBeyond) {
  const auto chosen = ui::evenlyStrided(1000000, 60000);
  ASSERT_EQ(chosen.size(), 60000U);
  for (std::size_t k = 1; k < chosen.size(); ++k) {
    const std::uint32_t step = chosen[k] - chosen[k - 1];
    ASSERT_GE(step, 16U);
    ASSERT_LE(step, 17U);
  }
  EXPECT_LT(chosen.back(), 1000000U);
  EXPECT_EQ(ui::evenlyStrided(3, 10), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_TRUE(ui::evenlyStrided(0, 10).empty());
}

TEST(SceneCamera, ZoomingKeepsThePivotAndTurningTheDistance) {
  SceneCamera camera;
  const Vector3d pivot(1, 2, 0.5);
  const double away = (camera.position - pivot).norm();
  camera.turn(pivot, 0.7, -0.3);
  EXPECT_NEAR((camera.position - pivot).norm(), away, 1e-9);
  camera.zoom(pivot, 2.0);
  EXPECT_NEAR((camera.position - pivot).norm(), away / 2, 1e-9);
  for (int i = 0; i < 100; ++i) camera.turn(pivot, 0.0, -0.2);
  EXPECT_GT(camera.forward().z(), -1.0);
  EXPECT_GT(camera.trueUp().z(), 0.0);  // never head over heels
}

TEST_F(SceneTest, ScreenshotsSayWhatIsWrong) {
  ui::MapScreenshot map;
  map.width_px = 4;
  EXPECT_FALSE(ui::mapScreenshot(snapshot(), map));
  ui::DepthScreenshot depth;
  depth.scan = 9;
  EXPECT_FALSE(ui::depthScreenshot(snapshot(), depth));
}

}  // namespace
}  // namespace tiltmap::test
