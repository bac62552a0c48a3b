#include "core/world/site.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/world/experiment.h"

namespace tiltmap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Ground flat(double height) {
  return Ground([height](double, double) { return height; }, {-100, -100}, {100, 100});
}

TEST(Ground, FlatGroundIsAPlane) {
  const Ground ground = flat(-0.9);
  EXPECT_NEAR(ground.height(3.3, -7.1), -0.9, 1e-12);
  const Vector3d down = Vector3d(0.1, 1.0, -0.2).normalized();
  EXPECT_NEAR(ground.hit({Vector3d::Zero(), down}, 50.0).value(), 0.9 / -down.z(), 1e-6);
  EXPECT_FALSE(ground.hit({Vector3d::Zero(), down}, 4.0));
  EXPECT_FALSE(ground.hit({Vector3d::Zero(), Vector3d(0, 1, 0.01)}, 80.0));
}

TEST(Ground, RaysEndOnTheSurfaceAndNothingIsSteppedOver) {
  const Terrain bumpy = [](double x, double y) {
    return 0.3 * std::sin(0.3 * x) * std::cos(0.25 * y) + 0.04 * std::sin(1.1 * x + y);
  };
  const Ground ground(bumpy, {-60, -60}, {60, 60});
  RandomStream random(1);
  for (int i = 0; i < 300; ++i) {
    const double way = random.uniform(0.0, 6.28), drop = random.uniform(-0.4, 0.02);
    const Ray ray{{0, 0, 1.0}, Vector3d(std::cos(way), std::sin(way), drop).normalized()};
    const auto gap = [&](double t) {
      const Vector3d p = ray.origin + t * ray.direction;
      return p.z() - ground.height(p.x(), p.y());
    };
    double first = std::numeric_limits<double>::infinity();  // by small steps
    for (double t = 0.0; t < 50.0; t += 0.01)
      if (gap(t) < 0.0) {
        first = t;
        break;
      }
    const auto hit = ground.hit(ray, 50.0);
    ASSERT_EQ(hit.has_value(), std::isfinite(first)) << i;
    if (!hit) continue;
    EXPECT_NEAR(gap(*hit), 0.0, 1e-5);
    EXPECT_NEAR(*hit, first, 0.0101);
  }
}

TEST(Ground, SlopeIsThatOfTheHeights) {
  const Terrain bumpy = [](double x, double y) { return 0.3 * std::sin(0.3 * x + 0.2 * y); };
  const Ground ground(bumpy, {-20, -20}, {20, 20});
  const double h = 1e-5;
  for (const Vector2d& p : {Vector2d(0.3, 0.9), Vector2d(-7.77, 3.1), Vector2d(1.874, 1.876)}) {
    const Vector2d numeric(ground.height(p.x() + h, p.y()) - ground.height(p.x() - h, p.y()),
                           ground.height(p.x(), p.y() + h) - ground.height(p.x(), p.y() - h));
    EXPECT_NEAR((ground.gradient(p.x(), p.y()) - numeric / (2.0 * h)).norm(), 0.0, 1e-5);
    EXPECT_NEAR(ground.height(p.x(), p.y()), Ground::heightOf(bumpy, p.x(), p.y()), 1e-12);
  }
}

TEST(Site, TreeOfBoxesFindsWhatLookingAtEveryShapeFinds) {
  const auto site = Experiment::make(ExperimentId::Exp2, 4).value().siteAt(0);
  RandomStream random(2);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const double way = random.uniform(0.0, 6.28);
    const Ray ray{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.2, 2.0)},
                  Vector3d(std::cos(way), std::sin(way), random.uniform(-0.3, 0.5)).normalized()};
    double nearest = site->ground().hit(ray, 85.0).value_or(std::numeric_limits<double>::infinity());
    for (const Shape& shape : site->shapes())
      if (const auto hit = hitOf(shape, ray, 85.0)) nearest = std::min(nearest, hit->distance_m);
    const auto found = site->cast(ray, 85.0);
    ASSERT_EQ(found.has_value(), std::isfinite(nearest));
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(found->distance_m, nearest, 1e-9);
    EXPECT_LT(found->normal.dot(ray.direction), 1e-6);
  }
  EXPECT_GT(hits, 1500);
}

TEST(Site, BundleFindsWhatItsRaysFindAlone) {
  const auto drive = Experiment::make(ExperimentId::Exp1, 2).value();
  const auto site = drive.siteAt(0);
  const Pose eye = drive.siteFromScan(0);
  RandomStream random(8);
  int hits = 0, misses = 0;
  for (int i = 0; i < 3000; ++i) {
    const double way = random.uniform(0.0, 6.28);
    std::vector<Ray> rays;
    const Vector3d axis = Vector3d(std::cos(way), std::sin(way), random.uniform(-0.3, 0.5)).normalized();
    for (int k = 0; k < 9; ++k) {
      Vector3d aside = Vector3d::Zero();
      if (k > 0) aside = Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      rays.push_back({eye.translation() + 0.01 * aside, axis + 0.006 * aside});
    }
    std::vector<std::optional<SurfaceHit>> bundle(rays.size());
    site->cast(rays, 90.0, bundle);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const auto alone = site->cast(rays[k], 90.0);
      ASSERT_EQ(alone.has_value(), bundle[k].has_value()) << i << " " << k;
      alone ? ++hits : ++misses;
      if (alone) {
        ASSERT_NEAR(alone->distance_m, bundle[k]->distance_m, 1e-9) << i << " " << k;
      }
    }
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(misses, 1000);
  std::vector<Ray> many(Site::kMaxBundle + 1, Ray{eye.translation(), Vector3d::UnitY()});
  std::vector<std::optional<SurfaceHit>> slots(many.size());
  EXPECT_THROW(site->cast(many, 90.0, slots), std::invalid_argument);
}

TEST(Site, EmptySiteIsGroundAlone) {
  const Site site(flat(0.0), {});
  EXPECT_TRUE(std::isinf(site.clearance({0, 0, 1})));
  EXPECT_NEAR(site.cast({{0, 0, 1}, -Vector3d::UnitZ()}, 10.0)->distance_m, 1.0, 1e-6);
  EXPECT_FALSE(site.cast({{0, 0, 1}, Vector3d::UnitZ()}, 10.0));
}

// The same place built around two stops: the same surfaces, or the map would not fit together.
TEST(Site, SitesAroundNeighbouringStopsAgree) {
  const auto drive = Experiment::make(ExperimentId::Survey, 6, 12).value();
  const auto near = drive.siteAt(4), far = drive.siteAt(9);
  const Vector3d eye = drive.siteFromScan(6).translation();
  RandomStream random(5);
  for (int i = 0; i < 1000; ++i) {
    const double way = random.uniform(0.0, 6.28);
    const Ray ray{eye, Vector3d(std::cos(way), std::sin(way), random.uniform(-0.3, 0.4)).normalized()};
    const auto a = near->cast(ray, 50.0), b = far->cast(ray, 50.0);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      EXPECT_NEAR(a->distance_m, b->distance_m, 1e-6);
    }
  }
}

TEST(Site, EveryStopStandsOnTheGroundClearOfEverything) {
  for (const ExperimentId id :
       {ExperimentId::Exp1, ExperimentId::Exp2Fixed, ExperimentId::Loop, ExperimentId::Survey})
    for (std::uint64_t seed = 1; seed <= (id == ExperimentId::Loop ? 1U : 3U); ++seed) {
      const auto drive = Experiment::make(id, seed, id == ExperimentId::Survey ? 20 : 0).value();
      for (int stop = 0; stop < drive.stops(); ++stop) {
        const auto site = drive.siteAt(stop);
        const Vector3d eye = drive.siteFromScan(stop).translation();
        const double height = eye.z() - site->ground().height(eye.x(), eye.y());
        EXPECT_GE(height, 0.8) << nameOf(id) << " seed " << seed << " stop " << stop;
        EXPECT_LE(height, 1.0) << nameOf(id) << " seed " << seed << " stop " << stop;
        EXPECT_GT(site->clearance(eye), 1.0) << nameOf(id) << " seed " << seed << " stop " << stop;
      }
    }
}

}  // namespace
}  // namespace tiltmap
