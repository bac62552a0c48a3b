// A kD-tree laid open: its cells, and what a search looks at (thesis 4.2.3, figure 4.13).
#pragma once

#include <vector>

#include "core/scan/kd_tree.h"

namespace tiltmap {

// The box that a node of the tree is responsible for, within the box of all points.
struct KdCell {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
  std::uint32_t node = 0;
  int depth = 0;  // 0: the root
  KdTree::Leaf leaf;
  bool is_leaf = false;
};

// Every cell down to the depth, the root first; leaves that end above it as well. None for an empty tree.
// A pair of halves shares the plane midway between the last point on the left and the first on the right.
std::vector<KdCell> kdCells(const KdTree& tree, int max_depth);

struct KdVisit {
  std::vector<KdCell> path;    // from the root to the leaf whose side of every plane the query is on
  std::vector<KdCell> leaves;  // looked into, in the order of the search
  std::size_t holder = 0;      // of `leaves`: the one with the nearest point
  KdTree::Neighbour nearest;
  std::size_t points_compared = 0;
};
// Throws std::invalid_argument for an empty tree or a query that is not finite.
KdVisit kdVisit(const KdTree& tree, const Eigen::Vector3d& query);

}  // namespace tiltmap
