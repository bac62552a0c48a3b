#include "core/scan/kd_tree_view.h"

#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

std::vector<Eigen::Vector3d> cube(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
  return points;
}

TEST(KdView, CellsHoldTheirPointsAndDoNotOverlap) {
  const KdTree tree(cube(500, 3));
  const auto cells = kdCells(tree, 64);
  std::size_t held = 0;
  double volume = 0.0;
  for (const KdCell& cell : cells) {
    if (!cell.is_leaf) continue;
    held += cell.leaf.count;
    volume += (cell.high - cell.low).prod();
    for (const Eigen::Vector3d& p : tree.points().subspan(cell.leaf.first, cell.leaf.count)) {
      EXPECT_TRUE((p.array() >= cell.low.array()).all());
      EXPECT_TRUE((p.array() <= cell.high.array()).all());
    }
  }
  EXPECT_EQ(held, 500U);
  EXPECT_NEAR(volume, (cells[0].high - cells[0].low).prod(), 1e-9);
  EXPECT_EQ(kdCells(tree, 0).size(), 1U);
  EXPECT_EQ(kdCells(tree, 2).size(), 7U);
  EXPECT_TRUE(kdCells(KdTree({}), 3).empty());
}

TEST(KdView, AVisitFindsWhatTheSearchFinds) {
  const KdTree tree(cube(800, 4));
  for (const Eigen::Vector3d& query : cube(50, 5)) {
    const KdVisit visit = kdVisit(tree, query);
    EXPECT_EQ(visit.nearest.index, tree.nearest(query).index);
    ASSERT_FALSE(visit.leaves.empty());
    ASSERT_FALSE(visit.path.empty());
    EXPECT_TRUE(visit.path.back().is_leaf);
    // The search goes down to the query's own leaf first.
    EXPECT_EQ(visit.path.back().leaf.first, visit.leaves.front().leaf.first);
    std::set<std::uint32_t> looked_into;
    std::size_t points = 0;
    for (const KdCell& leaf : visit.leaves) {
      looked_into.insert(leaf.leaf.first);
      points += leaf.leaf.count;
    }
    EXPECT_EQ(looked_into.size(), visit.leaves.size());
    EXPECT_EQ(points, visit.points_compared);
    EXPECT_LT(visit.points_compared, tree.size());
    const KdCell& holder = visit.leaves[visit.holder];
    bool holds = false;
    for (const std::uint32_t i : tree.order().subspan(holder.leaf.first, holder.leaf.count))
      holds |= i == visit.nearest.index;
    EXPECT_TRUE(holds);
    // No leaf that was passed over could hold anything nearer.
    for (const KdCell& cell : kdCells(tree, 64)) {
      if (!cell.is_leaf || looked_into.contains(cell.leaf.first)) continue;
      for (const Eigen::Vector3d& p : tree.points().subspan(cell.leaf.first, cell.leaf.count))
        EXPECT_GE((p - query).squaredNorm(), visit.nearest.squared_distance);
    }
  }
}

TEST(KdView, OnePointAndEqualPointsAreLeavesToo) {
  const std::vector<Eigen::Vector3d> one = {{1, 2, 3}};
  const KdVisit visit = kdVisit(KdTree(one), {0, 0, 0});
  EXPECT_EQ(visit.leaves.size(), 1U);
  EXPECT_EQ(visit.path.size(), 1U);
  const std::vector<Eigen::Vector3d> equal(40, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(kdVisit(KdTree(equal), {1, 1, 1}).nearest.index, 0U);
  EXPECT_THROW(kdVisit(KdTree({}), {0, 0, 0}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(kdVisit(KdTree(one), {nan, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
