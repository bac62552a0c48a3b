// The registration's drawing without widgets and without a display.
#include "ui/scene/registration_layer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/room_scene.h"
#include "ui/scene/offscreen_window.h"

namespace tiltmap::test {
namespace {

using ui::GizmoHandle;
using ui::RegistrationColours;
using ui::RegistrationLayer;
using ui::Scene;

class RegistrationLayerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto made = ui::OffscreenWindow::make(400, 300);
    if (!made) GTEST_SKIP() << made.error().what;
    window = std::move(*made);
    scene.attach(window->window());
    ui::SceneSettings settings = scene.settings();
    settings.grid = settings.axes = settings.path = false;
    (void)scene.setSettings(settings);
    layer = std::make_unique<RegistrationLayer>(scene);
    scene.setView(ui::SceneView::Top);
    scene.setOrthographic(true);
    // Two squares of points, the moving one a metre to the right of where it belongs.
    std::vector<float> square;
    for (int i = -5; i <= 5; ++i)
      for (int j = -5; j <= 5; ++j)
        for (const float v : {0.4F * static_cast<float>(i), 0.4F * static_cast<float>(j), 0.0F})
          square.push_back(v);
    layer->setScans(square, square, pose);
    layer->setPointSize(4.0);
  }
  void TearDown() override {
    layer.reset();
    scene.detach();
  }
  RgbImage picture() {
    scene.render();
    return window->picture();
  }
  static std::size_t count(const RgbImage& image, Rgb colour) {
    std::size_t found = 0;
    for (const Rgb& p : image.pixels) found += p.r == colour.r && p.g == colour.g && p.b == colour.b ? 1 : 0;
    return found;
  }
  static TracedPair pairOf(const Eigen::Vector3d& fixed, const Eigen::Vector3d& moving, RejectReason reason) {
    TracedPair pair;
    pair.pair.reason = reason;
    pair.fixed_point = fixed;
    pair.moving_point = moving;
    pair.weight = reason == RejectReason::None ? 1.0 : 0.0;
    return pair;
  }

  std::unique_ptr<ui::OffscreenWindow> window;
  Scene scene;
  std::unique_ptr<RegistrationLayer> layer;
  const Pose pose{Eigen::Quaterniond::Identity(), Eigen::Vector3d(1.0, 0.0, 0.0)};
  const RegistrationColours colours = RegistrationColours::of(true);
};

TEST_F(RegistrationLayerTest, OnlyTheMovingScanMoves) {
  const RgbImage before = picture();
  EXPECT_GT(count(before, colours.fixed), 200U);
  EXPECT_GT(count(before, colours.moving), 200U);
  const auto fixed_point = layer->pickPoint(true, scene.pixelOf({0.4, 0.4, 0.0}), 3.0);
  ASSERT_TRUE(fixed_point);
  EXPECT_LT((*fixed_point - Eigen::Vector3d(0.4, 0.4, 0.0)).norm(), 1e-6);
  const auto moving_point = layer->pickPoint(false, scene.pixelOf({1.4, 0.4, 0.0}), 3.0);
  ASSERT_TRUE(moving_point);
  EXPECT_LT((*moving_point - Eigen::Vector3d(0.4, 0.4, 0.0)).norm(), 1e-6);
  layer->place(Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, -0.5}));
  const auto moved = layer->pickPoint(false, scene.pixelOf({0.4, 0.4, -0.5}), 3.0);
  ASSERT_TRUE(moved);
  EXPECT_LT((*moved - Eigen::Vector3d(0.4, 0.4, 0.0)).norm(), 1e-6);
  EXPECT_EQ(count(picture(), colours.moving), 0U);  // behind the fixed one
  layer->setPointsShown(false);
  EXPECT_EQ(count(picture(), colours.fixed), 0U);
  EXPECT_FALSE(layer->pickPoint(true, {-500.0, -500.0}, 3.0));
}

TEST_F(RegistrationLayerTest, PairsAreDrawnByFateAndPicked) {
  layer->setPointsShown(false);
  const std::vector<TracedPair> pairs = {
      pairOf({0.0, 1.5, 0.0}, {0.0, 1.5, 0.0}, RejectReason::None),
      pairOf({0.0, 0.5, 0.0}, {0.0, 0.5, 0.0}, RejectReason::TooFar),
      pairOf({0.0, -0.5, 0.0}, {0.0, -0.5, 0.0}, RejectReason::NormalDisagrees),
      pairOf({0.0, 0.0, 0.0}, {0.0, -1.5, 0.0}, RejectReason::NoPartner)};
  const std::set<RejectReason> all = {RejectReason::None, RejectReason::TooFar, RejectReason::NormalDisagrees,
                                      RejectReason::NoPartner};
  layer->setPairs(nullptr, pairs, all, false);
  EXPECT_EQ(layer->linesDrawn(), 4U);
  const RgbImage drawn = picture();
  const std::size_t kept = count(drawn, colours.fate[0]);
  EXPECT_GT(kept, 20U);
  // Dashes leave gaps: the fate is seen without its colour.
  EXPECT_LT(count(drawn, colours.fate[static_cast<std::size_t>(RejectReason::TooFar)]), kept);
  EXPECT_GT(count(drawn, colours.fate[static_cast<std::size_t>(RejectReason::NormalDisagrees)]), 5U);
  EXPECT_EQ(layer->pickPair(scene.pixelOf({0.5, 1.5, 0.0}), 5.0), 0U);
  EXPECT_EQ(layer->pickPair(scene.pixelOf({0.5, -0.5, 0.0}), 5.0), 2U);
  EXPECT_EQ(layer->pickPair(scene.pixelOf({1.0, -1.5, 0.0}), 5.0), 3U);
  EXPECT_FALSE(layer->pickPair(scene.pixelOf({0.5, 1.0, 0.0}), 5.0));
  layer->setPicked(0);
  EXPECT_GT(count(picture(), colours.picked), 20U);
  layer->setPairs(nullptr, pairs, {RejectReason::TooFar}, false);
  EXPECT_EQ(layer->linesDrawn(), 1U);
  EXPECT_EQ(count(picture(), colours.fate[0]), 0U);
  EXPECT_FALSE(layer->pickPair(scene.pixelOf({0.5, 1.5, 0.0}), 5.0));
}

TEST_F(RegistrationLayerTest, APairWithoutWeightFades) {
  layer->setPointsShown(false);
  TracedPair faint = pairOf({0.0, 1.0, 0.0}, {0.0, 1.0, 0.0}, RejectReason::None);
  faint.weight = 0.0;
  layer->setPairs(nullptr, {faint}, {RejectReason::None}, false);
  EXPECT_EQ(count(picture(), colours.fate[0]), 0U);
  EXPECT_GT(count(picture(), mixed(colours.fate[0], colours.ground, 0.8)), 20U);
}

TEST_F(RegistrationLayerTest, PatchesOfARegistrationAreOutlined) {
  const Scan fixed = test_support::sceneScan(test_support::roomScene(), Pose(), 0.005, 1);
  const Scan moving = test_support::sceneScan(test_support::roomScene(), pose, 0.005, 2);
  auto trace = RegistrationTrace::begin(fixed, moving, Pose(), RegistrationSettings{});
  ASSERT_TRUE(trace);
  const TraceStepPtr step = trace->step();
  layer->setPointsShown(false);
  const auto traced = tracedPairs(trace->attempts()[0], *step);
  layer->setPairs(&trace->attempts()[0], traced, {RejectReason::None}, false);
  const RgbImage without = picture();
  layer->setPairs(&trace->attempts()[0], traced, {RejectReason::None}, true);
  EXPECT_NE(picture().pixels, without.pixels);
}

TEST_F(RegistrationLayerTest, GhostTreeMarksAndGizmoComeAndGo) {
  const RgbImage plain = picture();
  layer->setGhost(Pose(Eigen::Quaterniond::Identity(), {0.2, 0.2, 0.1}));
  EXPECT_NE(picture().pixels, plain.pixels);
  layer->setGhost({});
  EXPECT_EQ(picture().pixels, plain.pixels);
  const std::vector<Eigen::Vector3d> points = {{-1, -1, 0}, {1, 1, 0}, {0.5, -0.5, 0}};
  const KdTree tree(points, 1);
  layer->setTree(kdCells(tree, 3), kdVisit(tree, {0.1, 0.1, 0.0}), {0.1, 0.1, 0.0});
  EXPECT_GT(count(picture(), colours.visited) + count(picture(), colours.picked), 20U);
  layer->setTree({}, {}, Eigen::Vector3d::Zero());
  EXPECT_EQ(picture().pixels, plain.pixels);
  layer->setMarks({{{0.0, 0.0, 0.0}, 1}}, {{{0.0, 0.0, 0.0}, 1}});
  EXPECT_NE(picture().pixels, plain.pixels);
  layer->setMarks({}, {});
  EXPECT_EQ(layer->gizmoAt(layer->handlePixel(GizmoHandle::X)), GizmoHandle::None);
  layer->setGizmo(true);
  for (const GizmoHandle handle : {GizmoHandle::X, GizmoHandle::Y, GizmoHandle::Plane, GizmoHandle::Turn})
    EXPECT_EQ(layer->gizmoAt(layer->handlePixel(handle)), handle);
  EXPECT_EQ(layer->gizmoAt({3.0, 3.0}), GizmoHandle::None);
  layer->setGizmo(false);
  EXPECT_EQ(picture().pixels, plain.pixels);
}

TEST_F(RegistrationLayerTest, DragsMoveWhatTheHandleSays) {
  scene.setView(ui::SceneView::Iso);
  layer->setGizmo(true);
  const Eigen::Vector3d at = pose.translation();
  const auto drag = [&](GizmoHandle handle, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return layer->dragged(handle, scene.pixelOf(from), scene.pixelOf(to));
  };
  const auto x = drag(GizmoHandle::X, at, at + Eigen::Vector3d(0.5, 0, 0));
  EXPECT_NEAR(x.shift_m.x(), 0.5, 0.05);
  EXPECT_EQ(x.shift_m.y(), 0.0);
  const auto z = drag(GizmoHandle::Z, at, at + Eigen::Vector3d(0, 0, -0.3));
  EXPECT_NEAR(z.shift_m.z(), -0.3, 0.03);
  const auto plane = drag(GizmoHandle::Plane, at, at + Eigen::Vector3d(0.4, -0.7, 0));
  EXPECT_LT((plane.shift_m - Eigen::Vector3d(0.4, -0.7, 0)).norm(), 1e-3);
  const auto turn = drag(GizmoHandle::Turn, at + Eigen::Vector3d(1, 0, 0), at + Eigen::Vector3d(0, 1, 0));
  EXPECT_NEAR(turn.turn_rad, std::acos(-1.0) / 2.0, 1e-3);
  const auto back = drag(GizmoHandle::Turn, at + Eigen::Vector3d(0, 1, 0), at + Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(back.turn_rad, -std::acos(-1.0) / 2.0, 1e-3);
  // From above the vertical handle points at the eye and does not move.
  scene.setView(ui::SceneView::Top);
  EXPECT_EQ(drag(GizmoHandle::Z, at, at + Eigen::Vector3d(0.5, 0, 0)).shift_m.norm(), 0.0);
}

TEST(FateDashes, DifferByMoreThanColour) {
  std::set<std::vector<std::pair<double, double>>> kinds;
  for (const RejectReason reason :
       {RejectReason::None, RejectReason::TooFar, RejectReason::NormalDisagrees, RejectReason::Statistics,
        RejectReason::NoNormal, RejectReason::NoPartner})
    kinds.insert(ui::fateDashes(reason));
  EXPECT_EQ(kinds.size(), 6U);
}

}  // namespace
}  // namespace tiltmap::test
