// Comparing, cutting, measuring, shading, drawing little by little: in pictures, without widgets and display.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "core/products/png.h"
#include "core/products/scan_colours.h"
#include "tests/support/png_pixels.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/scene/wall_scenes.h"
#include "ui/scene/offscreen_window.h"
#include "ui/scene/scene.h"

namespace tiltmap::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ui::CellPlace;
using ui::PointBox;
using ui::Scene;
using ui::SceneColouring;
using ui::SceneCompare;
using ui::SceneSettings;
using ui::SceneView;
using ui::SliceHandle;

constexpr int kWidth = 480, kHeight = 360;

int differenceOf(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}
int luma(Rgb c) {
  return 3 * c.r + 6 * c.g + c.b;
}

class SceneToolsTest : public ::testing::Test {
 protected:
  SceneToolsTest() : project(must(Project::create(folder / "walls.tiltmap"))) {}
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
  void add(std::vector<Scan> scans) { must(project->apply(importEdit(std::move(scans)))); }
  // Two walls side by side, 8 m apart, seen along +y.
  void addTwoWalls() {
    add({wallOf(Pose(), "left"), wallOf(Pose::planar(8, 0, 0), "right")});
    scene->show(snapshot(), Stage::Odometry);
  }
  SnapshotPtr snapshot() const { return project->snapshot(); }
  ScanId id(std::size_t index) const { return snapshot()->scans()[index].id; }
  RgbImage drawn() {
    scene->render();
    return window->picture();
  }
  Rgb at(const RgbImage& picture, const Vector3d& world) { return at(picture, scene->pixelOf(world)); }
  Rgb at(const RgbImage& picture, const Vector2d& pixel) {
    return picture.at(std::clamp(static_cast<int>(pixel.x()), 0, picture.width - 1),
                      std::clamp(picture.height - 1 - static_cast<int>(pixel.y()), 0, picture.height - 1));
  }
  bool shows(const RgbImage& picture, const Vector3d& world, std::size_t scan) {
    return differenceOf(at(picture, world), scanColour(scan)) <= 4;
  }
  void change(const std::function<void(SceneSettings&)>& how) {
    SceneSettings settings = scene->settings();
    how(settings);
    EXPECT_TRUE(scene->setSettings(settings).empty());
  }

  TemporaryFolder folder;
  std::unique_ptr<Project> project;
  std::unique_ptr<ui::OffscreenWindow> window;
  std::unique_ptr<Scene> scene;
};

TEST_F(SceneToolsTest, WipingShowsOneStageOnEitherSideOfTheDivider) {
  addTwoWalls();
  // At the other stage the walls have changed places.
  must(project->apply(posesEdit(Stage::Truth, {{id(0), Pose::planar(8, 0, 0)}, {id(1), Pose()}})));
  scene->show(snapshot(), Stage::Odometry);
  scene->setCompare(SceneCompare::Wipe, Stage::Truth);
  scene->setDivider(0.5);  // between the walls
  const RgbImage half = drawn();
  EXPECT_TRUE(shows(half, {0, 4, 0}, 1));  // truth on the left
  EXPECT_TRUE(shows(half, {8, 4, 0}, 1));  // odometry on the right
  scene->setDivider(0.0);
  EXPECT_TRUE(shows(drawn(), {0, 4, 0}, 0));
  scene->setDivider(1.0);
  EXPECT_TRUE(shows(drawn(), {8, 4, 0}, 0));
  // What is picked is what is seen there.
  scene->setDivider(0.5);
  const auto left = scene->pick(scene->pixelOf({0, 4, 0}), 5.0);
  ASSERT_TRUE(left);
  EXPECT_EQ(left->scan, id(1));
  const auto place = scene->shownPoint(*left, scene->pixelOf({0, 4, 0}));
  ASSERT_TRUE(place);
  EXPECT_LT((*place - Vector3d(0, 4, 0)).norm(), 0.1);
  scene->setCompare(SceneCompare::Off, Stage::Truth);
  EXPECT_TRUE(shows(drawn(), {0, 4, 0}, 0));
  EXPECT_TRUE(shows(drawn(), {8, 4, 0}, 1));
}

TEST_F(SceneToolsTest, BlinkingShowsTheStagesInTurn) {
  addTwoWalls();
  must(project->apply(posesEdit(Stage::Truth, {{id(0), Pose::planar(8, 0, 0)}, {id(1), Pose()}})));
  scene->show(snapshot(), Stage::Odometry);
  scene->setCompare(SceneCompare::Blink, Stage::Truth);
  EXPECT_TRUE(shows(drawn(), {0, 4, 0}, 0));
  scene->setShowsBefore(true);
  EXPECT_TRUE(shows(drawn(), {0, 4, 0}, 1));
  scene->setShowsBefore(false);
  EXPECT_TRUE(shows(drawn(), {0, 4, 0}, 0));
}

TEST_F(SceneToolsTest, OnlyPointsInTheBoxAreDrawnAndPicked) {
  addTwoWalls();
  drawn();
  const Vector2d left = scene->pixelOf({0, 4, 0}), right = scene->pixelOf({8, 4, 0}),
                 above = scene->pixelOf({8, 4, 0.9});
  scene->setSlice(PointBox{{6, 3, -0.5}, {10, 5, 0.5}});
  const RgbImage cut = drawn();
  EXPECT_GT(differenceOf(at(cut, left), scanColour(0)), 40);
  EXPECT_LE(differenceOf(at(cut, right), scanColour(1)), 4);
  EXPECT_GT(differenceOf(at(cut, above), scanColour(1)), 40);
  EXPECT_FALSE(scene->pick(left, 5.0));
  EXPECT_FALSE(scene->pick(above, 5.0));
  EXPECT_TRUE(scene->pick(right, 5.0));
  scene->setSlice({});
  EXPECT_LE(differenceOf(at(drawn(), left), scanColour(0)), 4);
}

TEST_F(SceneToolsTest, SidesOfTheBoxFollowThePointerAndNeverCross) {
  addTwoWalls();
  drawn();
  scene->setSlice(PointBox{{-2, 3, -1}, {10, 5, 1}});
  const SliceHandle top{2, true};
  const Vector2d there = *scene->pixelOf(top);
  EXPECT_EQ(scene->sliceHandleAt(there + Vector2d(2, 1), 6.0), top);
  EXPECT_FALSE(scene->sliceHandleAt(there + Vector2d(0, 60), 6.0));
  scene->dragSlice(top, {3.0, 25.0});
  EXPECT_NEAR((*scene->pixelOf(top) - there).y(), 25.0, 0.5);
  EXPECT_GT(scene->slice()->high.z(), 1.0);
  EXPECT_EQ(scene->slice()->low.z(), -1.0);
  scene->dragSlice(top, {0.0, -5000.0});
  EXPECT_GT(scene->slice()->high.z(), scene->slice()->low.z());
  EXPECT_LT(scene->slice()->high.z(), -0.9);
  // Along the line of sight there is nothing to drag.
  EXPECT_FALSE(scene->sliceHandleAt(*scene->pixelOf(SliceHandle{1, false}), 1.0) == (SliceHandle{1, false}));
}

TEST_F(SceneToolsTest, AMeasuredLineIsDrawnWithItsLength) {
  addTwoWalls();
  const RgbImage before = drawn();
  scene->setMeasured({Vector3d(1, 4, 0), Vector3d(7, 4, 0)});
  const RgbImage after = drawn();
  EXPECT_GT(luma(at(after, Vector3d(3, 4, 0))), luma(at(before, Vector3d(3, 4, 0))) + 800);
  int written = 0;  // the numbers above the middle of the line
  const Vector2d middle = scene->pixelOf({4, 4, 0});
  for (int y = 12; y < 36; ++y)
    for (int x = -30; x < 30; ++x) {
      const Vector2d there = middle + Vector2d(x, y);
      written += luma(at(after, there)) > luma(at(before, there)) + 500;
    }
  EXPECT_GT(written, 30);
  scene->setMeasured({});
  EXPECT_EQ(drawn().pixels, before.pixels);
}

TEST_F(SceneToolsTest, ShadingDarkensWhatLiesBehindAnEdge) {
  // A wall 4 m away, and half as wide one in front of it.
  WallGrid narrow;
  narrow.wide_deg = 20.0, narrow.high_deg = 60.0;
  add({wallOf(Pose(), "behind"), wallOf(Pose(), "in front", narrow, 3.0)});
  scene->show(snapshot(), Stage::Odometry);
  for (const bool orthographic : {true, false}) {
    scene->setOrthographic(orthographic);
    scene->setView(SceneView::Front);
    change([](SceneSettings& s) { s.shaded = false; });
    const RgbImage plain = drawn();
    change([](SceneSettings& s) { s.shaded = true; });
    const RgbImage shaded = drawn();
    int darker = 0, same = 0, brighter = 0, black = 0;
    for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
      darker += luma(shaded.pixels[i]) < luma(plain.pixels[i]) - 200;
      same += shaded.pixels[i] == plain.pixels[i];
      brighter += luma(shaded.pixels[i]) > luma(plain.pixels[i]) + 20;
      black += luma(shaded.pixels[i]) < 30;
    }
    EXPECT_GT(darker, 100) << orthographic;  // along the edges
    EXPECT_GT(same, kWidth * kHeight / 2) << orthographic;
    EXPECT_EQ(brighter, 0);
    EXPECT_LT(black, kWidth * kHeight / 20);
  }
}

TEST_F(SceneToolsTest, ResidualsAreBlueAndOrangeAroundGrey) {
  addTwoWalls();
  change([](SceneSettings& s) { s.colouring = SceneColouring::Residual; });
  // None are known yet.
  EXPECT_LE(differenceOf(at(drawn(), Vector3d(0, 4, 0)), ui::SceneColours::dark().no_data), 3);
  const std::size_t cells = static_cast<std::size_t>(81) * 161;
  auto below = std::make_shared<std::vector<float>>(cells, 0.0F);
  auto above = std::make_shared<std::vector<float>>(cells, 0.0F);
  for (std::size_t cell = 0; cell < cells / 4; ++cell) {
    (*below)[cell] = -0.05F;
    (*above)[cells - 1 - cell] = 0.05F;
  }
  scene->setResiduals({{id(0), below}, {id(1), above}});
  const RgbImage picture = drawn();
  const Rgb low = at(picture, Vector3d(0, 4, -1)), zero = at(picture, Vector3d(0, 4, 0.5)),
            high = at(picture, Vector3d(8, 4, 1));
  EXPECT_GT(low.b, low.r + 60);
  EXPECT_LE(std::max({zero.r, zero.g, zero.b}) - std::min({zero.r, zero.g, zero.b}), 6);
  EXPECT_GT(high.r, high.b + 60);
}

TEST_F(SceneToolsTest, APictureFillsLittleByLittleAndMarksDoNotBeginItAnew) {
  WallGrid dense;
  dense.rows = 601, dense.columns = 901;
  add({wallOf(Pose(), "one", dense), wallOf(Pose::planar(8, 0, 0), "two", dense)});
  change([](SceneSettings& s) { s.point_px = 2.0; });
  scene->show(snapshot(), Stage::Odometry);
  const RgbImage whole = drawn();
  EXPECT_TRUE(scene->isRefined());
  scene->setView(SceneView::Top);
  scene->setGradual(true);
  drawn();
  EXPECT_FALSE(scene->isRefined());
  scene->setView(SceneView::Front);  // interrupted: what is drawn next is of this view
  int pieces = 0;
  do {
    drawn();
    ++pieces;
  } while (!scene->isRefined() && pieces < 1000);
  EXPECT_GT(pieces, 2);
  const RgbImage pieced = window->picture();
  int other = 0;
  for (std::size_t i = 0; i < whole.pixels.size(); ++i)
    other += differenceOf(whole.pixels[i], pieced.pixels[i]) > 8;
  EXPECT_LT(other, kWidth * kHeight / 200);
  scene->markHovered(CellPlace{id(0), 300, 450});
  drawn();
  EXPECT_TRUE(scene->isRefined());
  scene->setDivider(0.3);
  EXPECT_TRUE(scene->isRefined());
  change([](SceneSettings& s) { s.point_px = 3.0; });
  drawn();
  EXPECT_FALSE(scene->isRefined());  // larger points are another picture
}

// How unevenly points lie over the tiles of a wall: deviation of their numbers over the mean.
double unevenness(const std::vector<Vector3d>& points, double half_width, double half_height) {
  constexpr int kTiles = 12;
  std::vector<double> counts(static_cast<std::size_t>(kTiles) * kTiles, 0.0);
  for (const Vector3d& p : points) {
    const int x = static_cast<int>(std::floor((p.x() / half_width + 1.0) * 0.5 * kTiles));
    const int z = static_cast<int>(std::floor((p.z() / half_height + 1.0) * 0.5 * kTiles));
    if (x >= 0 && z >= 0 && x < kTiles && z < kTiles) counts[static_cast<std::size_t>(z * kTiles + x)] += 1.0;
  }
  double mean = 0.0, square = 0.0;
  for (const double c : counts) mean += c / static_cast<double>(counts.size());
  for (const double c : counts) square += (c - mean) * (c - mean) / static_cast<double>(counts.size());
  return std::sqrt(square) / mean;
}

TEST_F(SceneToolsTest, WhileMovingAtLeastFiftyThousandPointsLieEvenlyOverTheSurfaces) {
  // A wide wall seen from nearby: its middle is scanned far more densely than its ends.
  WallGrid dense;
  dense.rows = 701, dense.columns = 1201, dense.wide_deg = 130.0, dense.high_deg = 100.0;
  add({wallOf(Pose(), "wide", dense)});
  scene->show(snapshot(), Stage::Odometry);
  drawn();
  std::vector<Vector3d> all;
  for (const Vector3d& p : cellPoints(*must(snapshot()->scans()[0].image()), snapshot()->scans()[0].geometry))
    all.push_back(p);
  scene->setMoving(true);
  const std::vector<Vector3d> some = scene->movingPoints();
  EXPECT_GE(some.size(), 50000U);
  EXPECT_LE(some.size(), 3 * ui::kMovingPoints + 1000);
  EXPECT_EQ(scene->pointsDrawn(), some.size());
  const double even = unevenness(some, 7.0, 4.0), raw = unevenness(all, 7.0, 4.0);
  EXPECT_GT(raw, 0.4);
  EXPECT_LT(even, 0.25);
  // Near by, where little of it is seen, as many lie within the picture as the scan has there, or enough.
  scene->setPivot(scene->pixelOf({0, 4, 0}));
  scene->zoom(6.0);
  drawn();
  std::size_t inside = 0;
  for (const Vector3d& p : scene->movingPoints()) {
    const Vector2d pixel = scene->pixelOf(p);
    inside += pixel.minCoeff() >= 0 && pixel.x() < kWidth && pixel.y() < kHeight;
  }
  EXPECT_GE(inside, 9000U);
  scene->setMoving(false);
}

TEST(EvenOrder, EveryBeginningCoversTheGrid) {
  ui::ScanPoints points;
  points.columns = 64;
  for (std::uint32_t cell = 0; cell < 64 * 64; ++cell) {
    points.cell.push_back(cell);
    // All equally far, off the axis of the tilt.
    points.xyz.insert(points.xyz.end(), {0.0F, 5.0F, 0.0F});
    points.intensity.push_back(static_cast<float>(cell));
  }
  ui::orderEvenly(points, true, true);
  for (const int blocks : {2, 4, 8, 16}) {  // the first n x n points: one in every block
    std::vector<int> hits(static_cast<std::size_t>(blocks) * static_cast<std::size_t>(blocks), 0);
    for (int i = 0; i < blocks * blocks; ++i) {
      const auto cell = static_cast<int>(points.cell[static_cast<std::size_t>(i)]);
      ++hits[static_cast<std::size_t>(cell / 64 * blocks / 64 * blocks + cell % 64 * blocks / 64)];
      EXPECT_EQ(points.intensity[static_cast<std::size_t>(i)], static_cast<float>(cell));
    }
    EXPECT_EQ(std::count(hits.begin(), hits.end(), 1), blocks * blocks);
  }
  // A density is reached once, and more of it are more points.
  EXPECT_EQ(points.countAtDensity(0.0), 0U);
  EXPECT_EQ(points.countAtDensity(1e30), points.size());
  EXPECT_NEAR(static_cast<double>(points.countAtDensity(0.5 / 25.0)), 2048.0, 20.0);
}

// Small pictures kept beside the tests. TILTMAP_WRITE_BASELINES=1 writes them anew: look at them then.
TEST_F(SceneToolsTest, PicturesAreThoseOfTheBaselines) {
  addTwoWalls();
  must(project->apply(
      posesEdit(Stage::Truth, {{id(0), Pose::planar(1, 1, 0.2)}, {id(1), Pose::planar(8, 0.5, -0.3)}})));
  const auto compare = [&](const std::string& name) {
    const RgbImage large = drawn();
    RgbImage picture(kWidth / 4, kHeight / 4, {});
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int k = 0; k < 16; ++k) {
          const Rgb c = large.at(4 * x + k % 4, 4 * y + k / 4);
          sum += Eigen::Vector3d(c.r, c.g, c.b);
        }
        picture.at(x, y) = {static_cast<std::uint8_t>(sum.x() / 16), static_cast<std::uint8_t>(sum.y() / 16),
                            static_cast<std::uint8_t>(sum.z() / 16)};
      }
    const std::filesystem::path file =
        std::filesystem::path(TILTMAP_SOURCE_DIR) / "tests/ui/baselines" / (name + ".png");
    if (std::getenv("TILTMAP_WRITE_BASELINES")) {
      must(writePng(file, picture));
      return;
    }
    const auto wanted = pngPixels(file);
    ASSERT_EQ(wanted.width, picture.width) << name;
    ASSERT_EQ(wanted.height, picture.height) << name;
    double sum = 0.0;
    int far = 0;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const int off = differenceOf(wanted.at(x, y), picture.at(x, y));
        sum += off;
        far += off > 48;
      }
    const double pixels = static_cast<double>(picture.width) * picture.height;
    EXPECT_LT(sum / pixels, 4.0) << name;
    EXPECT_LT(far / pixels, 0.02) << name;
  };
  change([](SceneSettings& s) { s.path = s.grid = s.axes = true; });
  scene->setView(SceneView::Iso);
  scene->show(snapshot(), Stage::Odometry);
  compare("scans");
  change([](SceneSettings& s) {
    s.colouring = SceneColouring::Height;
    s.shaded = true;
  });
  scene->setOrthographic(false);
  scene->setColours(ui::SceneColours::white());
  compare("height-shaded-white");
  change([](SceneSettings& s) { s.colouring = SceneColouring::Scan; });
  scene->setColours(ui::SceneColours::dark());
  scene->setView(SceneView::Top);
  scene->setCompare(SceneCompare::Wipe, Stage::Truth);
  compare("wipe-top");
}

}  // namespace
}  // namespace tiltmap::test
