#include "core/scan/kd_tree_view.h"

#include <map>
#include <stdexcept>
#include <utility>

namespace tiltmap {

namespace {

KdCell rootCell(const KdTree& tree) {
  KdCell root;
  root.low = root.high = tree.points().front();
  for (const Eigen::Vector3d& p : tree.points()) {
    root.low = root.low.cwiseMin(p);
    root.high = root.high.cwiseMax(p);
  }
  return root;
}

void complete(const KdTree& tree, KdCell& cell) {
  const KdTree::Node& node = tree.nodes()[cell.node];
  cell.is_leaf = node.axis < 0;
  cell.leaf = node.leaf;
}

double planeOf(const KdTree::Node& node) {
  return 0.5 * (node.left_end + node.split);
}

std::pair<KdCell, KdCell> halves(const KdTree& tree, const KdCell& cell) {
  const KdTree::Node& node = tree.nodes()[cell.node];
  KdCell left = cell, right = cell;
  left.node = node.left;
  right.node = node.right;
  left.depth = right.depth = cell.depth + 1;
  left.high[node.axis] = right.low[node.axis] = planeOf(node);
  complete(tree, left);
  complete(tree, right);
  return {left, right};
}

}  // namespace

std::vector<KdCell> kdCells(const KdTree& tree, int max_depth) {
  std::vector<KdCell> cells;
  if (tree.empty()) return cells;
  cells.push_back(rootCell(tree));
  complete(tree, cells.back());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].is_leaf || cells[i].depth >= max_depth) continue;
    auto [left, right] = halves(tree, cells[i]);
    cells.push_back(left);
    cells.push_back(right);
  }
  return cells;
}

KdVisit kdVisit(const KdTree& tree, const Eigen::Vector3d& query) {
  if (tree.empty()) throw std::invalid_argument("kdVisit: the tree is empty");
  KdVisit visit;
  std::vector<KdTree::Leaf> leaves;
  visit.nearest = tree.nearest(query, leaves);
  KdCell cell = rootCell(tree);
  complete(tree, cell);
  visit.path.push_back(cell);
  while (!visit.path.back().is_leaf) {
    const auto [left, right] = halves(tree, visit.path.back());
    const KdTree::Node& node = tree.nodes()[visit.path.back().node];
    // As the search decides which half comes first.
    const bool goes_left = query[node.axis] - node.left_end < node.split - query[node.axis];
    visit.path.push_back(goes_left ? left : right);
  }
  std::map<std::uint32_t, KdCell> by_first;
  for (const KdCell& one : kdCells(tree, 64))
    if (one.is_leaf) by_first.emplace(one.leaf.first, one);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    visit.leaves.push_back(by_first.at(leaves[i].first));
    visit.points_compared += leaves[i].count;
    for (const std::uint32_t index : tree.order().subspan(leaves[i].first, leaves[i].count))
      if (index == visit.nearest.index) visit.holder = i;
  }
  return visit;
}

}  // namespace tiltmap
