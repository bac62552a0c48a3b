#include "core/scan/kd_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/base/random.h"

namespace tiltmap {
namespace {

using Eigen::Vector3d;
using Neighbour = KdTree::Neighbour;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Every point, nearest first, ties by index.
std::vector<Neighbour> sortedByDistance(const std::vector<Vector3d>& points, const Vector3d& query) {
  std::vector<Neighbour> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = query.x() - points[i].x(), y = query.y() - points[i].y(), z = query.z() - points[i].z();
    all.push_back({static_cast<std::uint32_t>(i), x * x + y * y + z * z});
  }
  std::ranges::sort(all, [](const Neighbour& a, const Neighbour& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                    : a.index < b.index;
  });
  return all;
}

void expectSame(const std::vector<Neighbour>& found, const std::vector<Neighbour>& all, std::size_t count) {
  ASSERT_EQ(found.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(found[i].index, all[i].index) << i;
    EXPECT_EQ(found[i].squared_distance, all[i].squared_distance) << i;
  }
}

struct PointSet {
  std::string name;
  std::vector<Vector3d> points;
};
std::ostream& operator<<(std::ostream& out, const PointSet& set) {
  return out << set.name;
}

std::vector<PointSet> pointSets() {
  RandomStream random(21);
  std::vector<PointSet> sets{{"one", {{1, 2, 3}}},
                             {"identical", std::vector<Vector3d>(300, Vector3d(1, 2, 3))}};
  PointSet space{"random", {}}, plane{"planar", {}}, line{"collinear", {}}, twice{"duplicated", {}},
      grid{"grid", {}}, pole{"poles", {}}, scales{"scales", {}};
  for (int i = 0; i < 1500; ++i) {
    space.points.push_back({random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)});
    plane.points.push_back({random.uniform(-9, 9), 5.0, random.uniform(-2, 2)});
    line.points.push_back(Vector3d(1, 2, 3) + random.uniform(-5, 5) * Vector3d(1, -1, 0.5));
    scales.points.push_back(std::pow(10.0, random.uniform(-6, 6)) *
                            Vector3d(random.normal(), random.normal(), 1.0));
  }
  for (int i = 0; i < 500; ++i)
    for (int k = 0; k < 3; ++k) twice.points.push_back(space.points[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 1000; ++i)
    grid.points.push_back(Eigen::Vector3i(i % 10, i / 10 % 10, i / 100).cast<double>());  // ties everywhere
  for (int i = 0; i < 101; ++i) pole.points.push_back({4.0, 0.0, 0.0});
  for (int i = 0; i < 400; ++i) pole.points.push_back({0.01 * i, 0.0, 0.0});
  for (auto* set : {&space, &plane, &line, &twice, &grid, &pole, &scales}) sets.push_back(std::move(*set));
  return sets;
}

class KdTreeOver : public ::testing::TestWithParam<PointSet> {
 protected:
  // Near the points, at points, halfway between two, and far away.
  std::vector<Vector3d> queries() const {
    RandomStream random(22);
    const auto& points = GetParam().points;
    const auto any = [&] { return points[random.below(points.size())]; };
    std::vector<Vector3d> list{{1000, -1000, 50}, {0, 0, 0}};
    for (int i = 0; i < 40; ++i) {
      list.push_back(any());
      list.push_back(0.5 * (any() + any()));
      list.push_back(any() + 0.3 * Vector3d(random.normal(), random.normal(), random.normal()));
    }
    return list;
  }
};

TEST_P(KdTreeOver, FindsWhatComparingWithEveryPointFinds) {
  const auto& points = GetParam().points;
  for (const int leaf_size : {1, 3, 10, 5000}) {
    const KdTree tree(points, leaf_size);
    for (const Vector3d& query : queries()) {
      const auto all = sortedByDistance(points, query);
      const Neighbour nearest = tree.nearest(query);
      EXPECT_EQ(nearest.index, all[0].index);
      EXPECT_EQ(nearest.squared_distance, all[0].squared_distance);
      std::vector<Neighbour> found;
      for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, points.size() + 5}) {
        if (count > 7 && leaf_size != 10) continue;  // all of them once is enough
        tree.nearestSeveral(query, count, found);
        expectSame(found, all, std::min(count, points.size()));
      }
      for (const double radius : {0.0, 0.4, 2.0}) {
        tree.within(query, radius, found);
        const auto inside = std::ranges::count_if(
            all, [&](const Neighbour& n) { return n.squared_distance <= radius * radius; });
        expectSame(found, all, static_cast<std::size_t>(inside));
        Neighbour bounded{77, -1.0};
        const bool any = tree.nearestWithin(query, radius, bounded);
        EXPECT_EQ(any, all[0].squared_distance < radius * radius);
        EXPECT_EQ(bounded.index, any ? all[0].index : 77U);  // untouched where nothing was found
      }
      Neighbour unbounded;
      EXPECT_TRUE(tree.nearestWithin(query, kInfinity, unbounded));
      EXPECT_EQ(unbounded.index, all[0].index);
    }
  }
}

TEST_P(KdTreeOver, LeavesAreSmallAndHoldEveryPointOnce) {
  const auto& points = GetParam().points;
  const KdTree tree(points);
  ASSERT_EQ(tree.size(), points.size());
  std::vector<int> seen(points.size(), 0);
  std::uint32_t next = 0;
  for (const KdTree::Node& node : tree.nodes()) {
    if (node.axis >= 0) continue;
    EXPECT_LE(node.leaf.count, 10U);
    EXPECT_GE(node.leaf.count, 1U);
    EXPECT_EQ(node.leaf.first, next);
    next += node.leaf.count;
    for (std::uint32_t i = 0; i < node.leaf.count; ++i) {
      const std::uint32_t index = tree.order()[node.leaf.first + i];
      ++seen.at(index);
      EXPECT_EQ(tree.points()[node.leaf.first + i], points[index]);
    }
  }
  EXPECT_EQ(next, points.size());
  EXPECT_EQ(std::ranges::count(seen, 1), static_cast<std::ptrdiff_t>(points.size()));
}

TEST_P(KdTreeOver, NodesSplitAtTheMedian) {
  const KdTree tree(GetParam().points);
  // Points below a node, by walking down.
  const auto collect = [&](const auto& self, std::uint32_t at, std::vector<Vector3d>& below) -> void {
    const KdTree::Node& node = tree.nodes()[at];
    if (node.axis >= 0) {
      self(self, node.left, below);
      self(self, node.right, below);
      return;
    }
    for (std::uint32_t i = 0; i < node.leaf.count; ++i) below.push_back(tree.points()[node.leaf.first + i]);
  };
  for (const KdTree::Node& node : tree.nodes()) {
    if (node.axis < 0) continue;
    std::vector<Vector3d> left, right;
    collect(collect, node.left, left);
    collect(collect, node.right, right);
    EXPECT_LE(right.size() - left.size(), 1U);
    double left_end = -kInfinity, right_start = kInfinity;
    for (const auto& p : left) left_end = std::max(left_end, p[node.axis]);
    for (const auto& p : right) right_start = std::min(right_start, p[node.axis]);
    EXPECT_EQ(node.left_end, left_end);
    EXPECT_EQ(node.split, right_start);
    EXPECT_LE(node.left_end, node.split);
  }
}

TEST_P(KdTreeOver, TheLeafOfTheNearestHoldsIt) {
  const auto& points = GetParam().points;
  const KdTree tree(points);
  for (const Vector3d& query : queries()) {
    Neighbour nearest;
    const KdTree::Leaf leaf = tree.leafOfNearest(query, nearest);
    EXPECT_EQ(nearest.index, sortedByDistance(points, query)[0].index);
    const auto members = tree.order().subspan(leaf.first, leaf.count);
    EXPECT_NE(std::ranges::find(members, nearest.index), members.end());
    EXPECT_LE(leaf.count, 10U);
  }
}

INSTANTIATE_TEST_SUITE_P(Sets, KdTreeOver, ::testing::ValuesIn(pointSets()),
                         [](const auto& tested) { return tested.param.name; });

TEST(KdTree, TakesAxesInTurnAndPassesOverANarrowOne) {
  RandomStream random(23);
  std::vector<Vector3d> cube, floor;
  for (int i = 0; i < 2000; ++i) {
    cube.push_back({random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)});
    floor.push_back({random.uniform(0, 20), random.uniform(0, 20), random.uniform(0, 0.05)});
  }
  const KdTree tree(cube);
  const auto& root = tree.nodes()[0];
  EXPECT_EQ(root.axis, 0);
  EXPECT_EQ(tree.nodes()[root.left].axis, 1);
  EXPECT_EQ(tree.nodes()[tree.nodes()[root.left].right].axis, 2);
  const KdTree flat(floor);
  for (const KdTree::Node& node : flat.nodes()) EXPECT_NE(node.axis, 2);
}

TEST(KdTree, AnEmptyTreeFindsNothing) {
  const KdTree tree(std::vector<Vector3d>{});
  EXPECT_TRUE(tree.empty());
  EXPECT_TRUE(tree.nodes().empty());
  Neighbour nearest;
  std::vector<Neighbour> found{{1, 1.0}};
  EXPECT_FALSE(tree.nearestWithin({0, 0, 0}, 5.0, nearest));
  tree.nearestSeveral({0, 0, 0}, 3, found);
  EXPECT_TRUE(found.empty());
  tree.within({0, 0, 0}, 3.0, found);
  EXPECT_TRUE(found.empty());
  EXPECT_THROW(tree.nearest({0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(tree.leafOfNearest({0, 0, 0}, nearest), std::invalid_argument);
}

TEST(KdTree, FindsTheNearestEvenWhereDistancesOverflow) {
  const KdTree tree(std::vector<Vector3d>{{1e200, 0, 0}, {-1e200, 0, 0}});
  EXPECT_EQ(tree.nearest({0, 0, 0}).index, 0U);
}

TEST(KdTree, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(KdTree(std::vector<Vector3d>{{0, 0, 0}, {0, nan, 0}}), std::invalid_argument);
  EXPECT_THROW(KdTree(std::vector<Vector3d>{{0, 0, kInfinity}}), std::invalid_argument);
  EXPECT_THROW(KdTree(std::vector<Vector3d>{{0, 0, 0}}, 0), std::invalid_argument);
  const KdTree tree(std::vector<Vector3d>{{0, 0, 0}});
  EXPECT_THROW(tree.nearest({0, nan, 0}), std::invalid_argument);
  Neighbour found;
  EXPECT_FALSE(tree.nearestWithin({0, 0, 0}, nan, found));
  EXPECT_FALSE(tree.nearestWithin({0, 0, 0}, -1.0, found));
}

TEST(KdTree, MayBeSearchedFromManyThreads) {
  RandomStream random(24);
  std::vector<Vector3d> points, queries;
  for (int i = 0; i < 2000; ++i) {
    points.push_back({random.normal(), random.normal(), random.normal()});
    queries.push_back({random.normal(), random.normal(), random.normal()});
  }
  const KdTree tree(points);
  const auto answers = [&](int threads) {
    std::vector<std::uint32_t> list(queries.size());
    parallelFor(queries.size(), threads, [&](std::size_t i) { list[i] = tree.nearest(queries[i]).index; });
    return list;
  };
  EXPECT_EQ(answers(4), answers(1));
}

}  // namespace
}  // namespace tiltmap
