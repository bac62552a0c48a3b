// Stops marked by what a relaxation makes of them, in pictures, without widgets and display.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/products/scan_colours.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/scene/wall_scenes.h"
#include "ui/scene/offscreen_window.h"
#include "ui/scene/scene.h"

namespace tiltmap::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ui::RelaxationRole;
using ui::Scene;
using ui::SceneColours;
using ui::SceneRoles;

constexpr int kWidth = 480, kHeight = 360;

int differenceOf(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

// Three walls side by side, 8 m apart, seen along +y, their stops before them.
class SceneRolesTest : public ::testing::Test {
 protected:
  SceneRolesTest() : project(must(Project::create(folder / "walls.tiltmap"))) {}
  void SetUp() override {
    auto made = ui::OffscreenWindow::make(kWidth, kHeight);
    if (!made) GTEST_SKIP() << made.error().what << " (" << made.error().remedy << ")";
    window = std::move(*made);
    must(project->apply(importEdit({wallOf(Pose(), "left"), wallOf(Pose::planar(8, 0, 0), "middle"),
                                    wallOf(Pose::planar(16, 0, 0), "right")})));
    scene = std::make_unique<Scene>();
    scene->attach(window->window());
    ui::SceneSettings settings;
    settings.point_px = 6.0;
    settings.path = settings.grid = settings.axes = false;
    scene->setSettings(settings);
    scene->setOrthographic(true);
    scene->show(project->snapshot(), Stage::Odometry);
    scene->setView(ui::SceneView::Front);
  }
  void TearDown() override {
    if (scene) scene->detach();
  }
  ScanId id(std::size_t index) const { return project->snapshot()->scans()[index].id; }
  RgbImage drawn() {
    scene->render();
    return window->picture();
  }
  // Pixels of nearly this colour within so many pixels of a place in the world.
  int countNear(const RgbImage& picture, const Vector3d& world, Rgb colour, int within = 16) {
    const Vector2d at = scene->pixelOf(world);
    int count = 0;
    for (int y = -within; y <= within; ++y)
      for (int x = -within; x <= within; ++x) {
        const int column = static_cast<int>(at.x()) + x,
                  row = picture.height - 1 - static_cast<int>(at.y()) + y;
        if (column < 0 || row < 0 || column >= picture.width || row >= picture.height) continue;
        count += differenceOf(picture.at(column, row), colour) <= 12;
      }
    return count;
  }

  TemporaryFolder folder;
  std::unique_ptr<Project> project;
  std::unique_ptr<ui::OffscreenWindow> window;
  std::unique_ptr<Scene> scene;
};

TEST_F(SceneRolesTest, EachSetHasItsMarkAndTheStaticScansArePale) {
  const RgbImage plain = drawn();
  const SceneColours colours = SceneColours::dark();
  SceneRoles roles;
  roles.of = {
      {id(0), RelaxationRole::Aligning}, {id(1), RelaxationRole::Queued}, {id(2), RelaxationRole::Waiting}};
  roles.onto = {id(1)};
  roles.legend = {{RelaxationRole::Aligning, "being aligned: 0 onto 1"}};
  scene->setRoles(roles);
  const RgbImage marked = drawn();
  EXPECT_GT(countNear(marked, {0, 0, 0}, colours.aligning), 40) << "two rings";
  EXPECT_GT(countNear(marked, {8, 0, 0}, colours.queued), 20) << "one ring";
  EXPECT_LT(countNear(marked, {8, 0, 0}, colours.queued), countNear(marked, {0, 0, 0}, colours.aligning));
  EXPECT_GT(countNear(marked, {4, 0, 0}, colours.aligning), 10) << "the line to the one it is aligned onto";
  EXPECT_EQ(countNear(plain, {4, 0, 0}, colours.aligning), 0);
  // The walls, beside their stops' marks.
  EXPECT_GT(countNear(marked, {8, 4, 0.9}, scanColour(1), 4), 20) << "as it was";
  EXPECT_GT(countNear(plain, {16, 4, 0.9}, scanColour(2), 4), 20);
  EXPECT_EQ(countNear(marked, {16, 4, 0.9}, scanColour(2), 4), 0) << "the static set is pale";
  // In words, at the upper right.
  int text = 0;
  for (int y = 8; y < 34; ++y)
    for (int x = 250; x < kWidth; ++x) text += differenceOf(marked.at(x, y), colours.text) < 40;
  EXPECT_GT(text, 60);
  scene->setRoles({});
  EXPECT_TRUE(drawn().pixels == plain.pixels) << "nothing stays behind";
}

TEST_F(SceneRolesTest, AStopBehindTheEyeIsNotMirroredIntoThePicture) {
  scene->setOrthographic(false);
  scene->frame({id(0)});
  scene->zoom(40.0);
  SceneRoles roles;
  for (std::size_t k = 0; k < 3; ++k) roles.of[id(k)] = RelaxationRole::Queued;
  scene->setRoles(roles);
  const RgbImage marked = drawn();
  int ringed = 0;
  for (const Rgb pixel : marked.pixels) ringed += differenceOf(pixel, SceneColours::dark().queued) <= 12;
  EXPECT_EQ(ringed, 0) << "the eye is between the stops and the wall";
}

TEST_F(SceneRolesTest, GhostsAreTiedToWhereTheStopsAre) {
  const RgbImage plain = drawn();
  scene->setGhosts({{id(1), Pose::planar(11, 0, 0)}});
  const RgbImage asked = drawn();
  EXPECT_GT(countNear(asked, {11, 0, 0}, SceneColours::dark().queued, 8), 12);
  EXPECT_GT(countNear(asked, {9.5, 0, 0}, SceneColours::dark().queued, 6), 6) << "the tie";
  scene->setGhosts({});
  EXPECT_TRUE(drawn().pixels == plain.pixels);
}

}  // namespace
}  // namespace tiltmap::test
