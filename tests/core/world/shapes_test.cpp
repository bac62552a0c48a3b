#include "core/world/shapes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Ray towards(const Vector3d& from, const Vector3d& to) {
  return {from, (to - from).normalized()};
}

TEST(Shapes, BoxIsStruckWhereItsWallsAre) {
  Isometry3d frame = Isometry3d::Identity();
  frame.linear() = Eigen::AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix();
  frame.translation() = Vector3d(1.0, 10.0, 0.5);
  const Shape box = Hull::box(frame, {-1.0, -2.0, -0.5}, {1.0, 2.0, 1.5}, 0.4);
  // A point of the wall that looks back along -y of the box.
  const Vector3d on_wall = frame * Vector3d(0.3, -2.0, 0.7);
  const auto hit = hitOf(box, towards({0, 0, 1}, on_wall), 50.0);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, (on_wall - Vector3d(0, 0, 1)).norm(), 1e-9);
  EXPECT_NEAR((hit->normal - frame.linear() * -Vector3d::UnitY()).norm(), 0.0, 1e-12);
  EXPECT_EQ(hit->reflectivity, 0.4);
  EXPECT_FALSE(hitOf(box, towards({0, 0, 1}, on_wall), hit->distance_m - 0.01))
      << "beyond the reach asked for";
  EXPECT_FALSE(hitOf(box, {Vector3d(0, 0, 1), -Vector3d::UnitY()}, 50.0)) << "behind the ray";
  EXPECT_FALSE(hitOf(box, {frame * Vector3d(0, 0, 0), Vector3d::UnitY()}, 50.0)) << "from inside";
  EXPECT_LT(distanceOf(box, frame * Vector3d(0, 0, 0)), 0.0);
  EXPECT_NEAR(distanceOf(box, frame * Vector3d(3.0, 0, 0)), 2.0, 1e-12);
}

TEST(Shapes, CutTakesACornerOff) {
  Hull hull = Hull::box(Isometry3d::Identity(), {-1, -1, -1}, {1, 1, 1}, 0.4);
  hull.cut({0, -0.5, 1}, {0, -1, 1});
  const auto hit = hull.hit({{0, -5, 0.9}, Vector3d::UnitY()}, 20.0);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 5.0 - 0.6, 1e-12);
  EXPECT_NEAR(hit->normal.z(), std::sqrt(0.5), 1e-12);
  for (int i = 0; i < 5; ++i) hull.cut({0, 0, 5}, {0, 0, 1});
  EXPECT_THROW(hull.cut({0, 0, 5}, {0, 0, 1}), std::logic_error);
}

TEST(Shapes, BallAndCylinderAreRound) {
  const Shape ball = Ball{{0, 8, 1}, 1.5, 0.3};
  RandomStream random(3);
  for (int i = 0; i < 200; ++i) {
    const Ray ray{{0, 0, 1},
                  Vector3d(random.uniform(-0.3, 0.3), 1.0, random.uniform(-0.3, 0.3)).normalized()};
    const double nearest = (Vector3d(0, 8, 1) - ray.origin).cross(ray.direction).norm();
    const auto hit = hitOf(ball, ray, 50.0);
    ASSERT_EQ(hit.has_value(), nearest < 1.5);
    if (!hit) continue;
    const Vector3d p = ray.origin + hit->distance_m * ray.direction;
    EXPECT_NEAR((p - Vector3d(0, 8, 1)).norm(), 1.5, 1e-9);
    EXPECT_LT(hit->normal.dot(ray.direction), 1e-9);
  }
  const Shape post = Cylinder{{0, 6}, 0.1, -1.0, 4.0, 0.5};
  EXPECT_NEAR(hitOf(post, {{0, 0, 1}, Vector3d::UnitY()}, 50.0)->distance_m, 5.9, 1e-12);
  EXPECT_FALSE(hitOf(post, {{0.11, 0, 1}, Vector3d::UnitY()}, 50.0));
  EXPECT_FALSE(hitOf(post, {{0, 0, 4.1}, Vector3d::UnitY()}, 50.0));
  EXPECT_NEAR(hitOf(post, {{0, 6, 9}, -Vector3d::UnitZ()}, 50.0)->distance_m, 5.0, 1e-12) << "from above";
}

TEST(Shapes, FoliageLetsSomeBeamsThroughAndAlwaysTheSame) {
  const Foliage crown{{0, 10, 3}, 1.5, 1.8, 0.4, 0.5, 99};
  int through = 0, struck = 0;
  for (int i = 0; i < 400; ++i) {
    const Ray ray = towards({0, 0, 1}, {-0.8 + 0.08 * (i % 20), 10.0, 2.2 + 0.08 * (i / 20)});
    const auto hit = crown.hit(ray, 50.0);
    hit ? ++struck : ++through;
    if (!hit) continue;
    const auto again = crown.hit({ray.origin + 2.0 * ray.direction, ray.direction}, 48.0);
    ASSERT_TRUE(again);
    EXPECT_NEAR(again->distance_m + 2.0, hit->distance_m, 1e-9)
        << "the leaf must not depend on where one stands";
    // Nor on how far one looks, as long as it is far enough.
    EXPECT_TRUE(crown.hit(ray, hit->distance_m + 1e-6));
    EXPECT_FALSE(crown.hit(ray, hit->distance_m - 1e-6));
    EXPECT_LT(crown.distance(ray.origin + hit->distance_m * ray.direction), 0.3);
  }
  EXPECT_GT(struck, 100);
  EXPECT_GT(through, 20);
}

TEST(Shapes, WindowsAreRecessed) {
  Facade facade;
  facade.site_from_frame.translation() = Vector3d(0, 15, 0);
  facade.half_m = {8.0, 5.0};
  facade.height_m = 6.8;
  facade.seed = 5;
  int wall = 0, deep = 0, reveal = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d target(-7.5 + 15.0 * (i % 80) / 80.0, 10.0, 0.1 + 6.5 * (i / 80) / 50.0);
    const Ray ray = towards({0, 0, 1}, target);
    const auto hit = hitOf(Shape(facade), ray, 80.0);
    ASSERT_TRUE(hit);
    const double depth = (ray.origin + hit->distance_m * ray.direction).y() - 10.0;
    EXPECT_GE(depth, -1e-9);
    EXPECT_LE(depth, facade.recess_m + 0.25 + 1e-9);
    if (depth < 1e-9)
      ++wall;
    else if (std::abs(hit->normal.y()) > 0.5)
      ++deep;
    else
      ++reveal;
  }
  EXPECT_GT(wall, 2000);
  EXPECT_GT(deep, 400);
  EXPECT_GT(reveal, 40);
  EXPECT_LT(distanceOf(Shape(facade), {0, 15, 1}), 0.0);
}

}  // namespace
}  // namespace tiltmap
