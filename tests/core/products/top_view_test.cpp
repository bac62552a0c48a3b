#include "core/products/top_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/products/scan_colours.h"
#include "core/products/top_view_marks.h"

namespace tiltmap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TopViewInput twoPoints() {
  TopViewInput input;
  input.clouds = {{0, {{-10, -8, 0}}}, {1, {{10, 8, 2}}}};
  return input;
}

TopViewSettings everything(TopViewBackground background = TopViewBackground::Dark) {
  TopViewSettings settings;
  settings.shown_share = 1.0;
  settings.background = background;
  return settings;
}

double distanceBetween(Rgb a, Rgb b) {
  return (linearOf(a) - linearOf(b)).norm();
}

Rgb pixelAt(const TopView& view, const Vector2d& world) {
  const Vector2d p = view.frame.pixelOf(world);
  return view.image.at(static_cast<int>(p.x()), static_cast<int>(p.y()));
}

TEST(TopView, PutsAPointAtItsPixelWithXRightAndYUp) {
  for (const auto background : {TopViewBackground::Dark, TopViewBackground::White}) {
    const auto view = drawTopView(twoPoints(), everything(background));
    ASSERT_TRUE(view);
    EXPECT_EQ(view->points_drawn, 2U);
    EXPECT_EQ(view->image.width, 1600);
    const Vector2d low = view->frame.pixelOf({-10, -8});
    const Vector2d high = view->frame.pixelOf({10, 8});
    EXPECT_LT(low.x(), high.x());
    EXPECT_GT(low.y(), high.y());
    // In the scan's colour, and nothing where there is no point.
    const Rgb paper = topViewInks(background).paper;
    EXPECT_GT(distanceBetween(pixelAt(*view, {10, 8}), paper), 0.1);
    EXPECT_LT(distanceBetween(pixelAt(*view, {10, 8}), topViewScanColour(1, {}, background)),
              distanceBetween(pixelAt(*view, {10, 8}), topViewScanColour(0, {}, background)));
    EXPECT_GT(distanceBetween(pixelAt(*view, {-10, -8}), paper), 0.1);
    EXPECT_EQ(pixelAt(*view, {8.3, 7.1}), paper);
  }
}

TEST(TopView, TheScaleIsTheSameAlongBothAxes) {
  const auto view = drawTopView(twoPoints(), everything());
  ASSERT_TRUE(view);
  const Vector2d origin = view->frame.pixelOf({0, 0});
  EXPECT_NEAR((view->frame.pixelOf({3, 0}) - origin).norm(), (view->frame.pixelOf({0, 3}) - origin).norm(),
              1e-9);
}

TEST(TopView, TheScaleBarIsAsLongAsItSays) {
  for (const double size : {1.0, 7.0, 30.0, 450.0}) {
    TopViewInput input;
    input.clouds = {{0, {{0, 0, 0}, {size, size, 0}}}};
    const auto view = drawTopView(input, everything());
    ASSERT_TRUE(view);
    const ScaleBar& bar = view->scale_bar;
    const double drawn_px = (view->frame.pixelOf({bar.length_m, 0}) - view->frame.pixelOf({0, 0})).norm();
    EXPECT_NEAR((bar.right_px - bar.left_px).norm(), drawn_px, 1e-9);
    EXPECT_LT(drawn_px, 0.2 * view->image.width);
    EXPECT_GT(drawn_px, 0.05 * view->image.width);
    // It is really there: the pixels along it are of the text's colour, those beyond its ends are not.
    const int y = static_cast<int>(bar.left_px.y()) - 1;
    const Rgb ink = topViewInks(TopViewBackground::Dark).text;
    EXPECT_EQ(view->image.at(static_cast<int>(0.5 * (bar.left_px.x() + bar.right_px.x())), y), ink);
    EXPECT_EQ(view->image.at(static_cast<int>(bar.left_px.x()) + 3, y), ink);
    EXPECT_NE(view->image.at(static_cast<int>(bar.left_px.x()) - 4, y), ink);
    EXPECT_NE(view->image.at(static_cast<int>(bar.right_px.x()) + 4, y), ink);
  }
}

TEST(TopView, RoundLengthsAreOneTwoAndFive) {
  EXPECT_DOUBLE_EQ(roundLength(1.0), 1.0);
  EXPECT_DOUBLE_EQ(roundLength(1.99), 1.0);
  EXPECT_DOUBLE_EQ(roundLength(2.0), 2.0);
  EXPECT_DOUBLE_EQ(roundLength(49.0), 20.0);
  EXPECT_DOUBLE_EQ(roundLength(50.0), 50.0);
  EXPECT_DOUBLE_EQ(roundLength(0.3), 0.2);
  EXPECT_DOUBLE_EQ(roundLength(1000.0), 1000.0);
}

TEST(TopView, AChosenColourIsThatOfTheStopAndItsPoints) {
  TopViewInput input;
  input.world_from_scan = {Pose(), Pose::planar(6, 0, 0)};
  const auto usual = drawTopView(input, everything());
  input.colours = {Rgb{1, 200, 30}};
  const auto chosen = drawTopView(input, everything());
  ASSERT_TRUE(usual && chosen);
  EXPECT_EQ(pixelAt(*chosen, {0, 0}), (Rgb{1, 200, 30}));
  EXPECT_EQ(pixelAt(*chosen, {6, 0}), scanColour(1)) << "none was chosen for it";
}

TEST(TopView, DrawsTheStopInItsScansColourAndTheArrowAlongItsHeading) {
  TopViewInput input;
  input.world_from_scan = {Pose(), Pose::planar(6, 0, -90 * kDegree)};  // the second looks along +x
  const auto view = drawTopView(input, everything());
  ASSERT_TRUE(view);
  EXPECT_EQ(pixelAt(*view, {0, 0}), scanColour(0));
  EXPECT_EQ(pixelAt(*view, {6, 0}), scanColour(1));
  const Rgb ink = topViewInks(TopViewBackground::Dark).path;
  const double step = 20.0 / view->frame.px_per_m;
  const auto inked = [&](const Vector2d& world) { return distanceBetween(pixelAt(*view, world), ink) < 0.2; };
  EXPECT_TRUE(inked({0, step}));
  EXPECT_FALSE(inked({0, -step}));
  EXPECT_TRUE(inked({6 + step, 0}));
  EXPECT_TRUE(inked({3, 0})) << "the path between the stops";
}

TEST(TopView, FewFarPointsDoNotShrinkTheMap) {
  TopViewInput input;
  RandomStream random(3);
  input.clouds = {{0, {}}};
  for (int k = 0; k < 2000; ++k)
    input.clouds[0].points.emplace_back(random.uniform(0, 20), random.uniform(0, 20), 0);
  const auto near = drawTopView(input);
  input.clouds[0].points.emplace_back(4000, 0, 0);
  input.clouds[0].points.emplace_back(0, -4000, 0);
  const auto far = drawTopView(input);
  ASSERT_TRUE(near && far);
  EXPECT_NEAR(far->frame.px_per_m / near->frame.px_per_m, 1.0, 0.05);
  // Unless one wants to see them; and a stop is never cut off.
  const auto all = drawTopView(input, everything());
  ASSERT_TRUE(all);
  EXPECT_LT(all->frame.px_per_m, 0.1 * near->frame.px_per_m);
  EXPECT_EQ(all->points_drawn, 2002U);
  input.world_from_scan = {Pose(), Pose::planar(100, 0, 0)};
  const auto with_stop = drawTopView(input);
  ASSERT_TRUE(with_stop);
  const Vector2d stop = with_stop->frame.pixelOf({100, 0});
  EXPECT_TRUE(with_stop->image.contains(static_cast<int>(stop.x()), static_cast<int>(stop.y())));
}

TEST(TopView, HeightAndDensityFollowTheColourMap) {
  TopViewInput input;
  input.clouds = {{0, {}}};
  for (int k = 0; k < 100; ++k) {
    input.clouds[0].points.emplace_back(0.0, 0.0, 0.0);
    input.clouds[0].points.emplace_back(10.0, 10.0, 5.0);
  }
  input.clouds[0].points.emplace_back(0.0, 10.0, 5.0);  // one point alone
  TopViewSettings settings = everything();
  const auto lightnessAt = [&](const Vector2d& world) {
    const auto view = drawTopView(input, settings);
    return okLabOf(linearOf(pixelAt(*view, world))).x();
  };
  settings.colouring = TopViewColouring::Height;
  EXPECT_GT(lightnessAt({10, 10}), lightnessAt({0, 0}) + 0.3);
  settings.colouring = TopViewColouring::Density;
  EXPECT_NEAR(lightnessAt({10, 10}), lightnessAt({0, 0}), 0.1);
  EXPECT_GT(lightnessAt({10, 10}), lightnessAt({0, 10}) + 0.1);
  EXPECT_GT(lightnessAt({0, 10}), lightnessAt({5, 6}) + 0.05) << "a lone point shows";
}

TEST(TopView, TheSameInputGivesTheSamePicture) {
  EXPECT_TRUE(drawTopView(twoPoints())->image.pixels == drawTopView(twoPoints())->image.pixels);
}

TEST(TopView, PointsThatAreNotFiniteAreLeftOut) {
  TopViewInput input = twoPoints();
  input.clouds[0].points.emplace_back(std::nan(""), 0, 0);
  input.clouds[0].points.emplace_back(0, std::numeric_limits<double>::infinity(), 0);
  const auto view = drawTopView(input, everything());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->points_drawn, 2U);
}

TEST(TopView, OnePointOneStopAndManyStopsAreDrawn) {
  TopViewInput point;
  point.clouds = {{3, {{5, 5, 1}}}};
  EXPECT_TRUE(drawTopView(point));
  TopViewInput stop;
  stop.world_from_scan = {Pose()};
  EXPECT_TRUE(drawTopView(stop));
  // A heading that points straight up has no arrow.
  stop.world_from_scan = {Pose(rotationExp({90 * kDegree, 0, 0}), {0, 0, 0})};
  EXPECT_TRUE(drawTopView(stop));
  TopViewInput crowd;
  for (int k = 0; k < 300; ++k) {
    crowd.world_from_scan.push_back(Pose::planar(0.05 * k, 0, 0));
    crowd.clouds.push_back({static_cast<std::size_t>(k), {{0.05 * k, 1, 0}}});
  }
  EXPECT_TRUE(drawTopView(crowd));
}

TEST(TopView, SaysWhyNothingCanBeDrawn) {
  EXPECT_FALSE(drawTopView({}));
  TopViewInput nothing_finite;
  nothing_finite.clouds = {{0, {{std::nan(""), 0, 0}}}};
  EXPECT_FALSE(drawTopView(nothing_finite));
  TopViewSettings settings;
  settings.width_px = 10;
  EXPECT_FALSE(drawTopView(twoPoints(), settings));
  TopViewInput broken = twoPoints();
  broken.world_from_scan = {Pose(), Pose(Eigen::Quaterniond::Identity(), {std::nan(""), 0, 0})};
  const auto view = drawTopView(broken);
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().where, "top view, stop 1");
}

TEST(TopView, ItsParametersAreDescribed) {
  TopViewSettings settings;
  ASSERT_TRUE(topViewParameters().apply({{"background", std::string("white")}, {"width", 800LL}}, settings));
  EXPECT_EQ(settings.background, TopViewBackground::White);
  EXPECT_EQ(drawTopView(twoPoints(), settings)->image.width, 800);
  EXPECT_FALSE(topViewParameters().apply({{"width", 50LL}}, settings));
}

}  // namespace
}  // namespace tiltmap
