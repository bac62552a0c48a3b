// A kD-tree with leaves one can look into (thesis 4.2.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace tiltmap {

// Split at the median, axes in turn (one along which the points spread less than half as far as along another
// is passed over: a flat floor is not cut by height), leaves of at most leaf_size points. Where figure 4.14
// would recurse for ever on equal coordinates, points equal to the median go to either side and a set of
// identical points still ends in leaves. Refers to no outside memory: points are copied in leaf order.
// Immutable, so searching from many threads is fine.
//
// Searches are exact: they find what comparing with every point would, to the last bit and in the same order.
// A search for a query that is not finite, and one for the nearest point of an empty tree, throws
// std::invalid_argument.
class KdTree {
 public:
  struct Neighbour {
    std::uint32_t index = 0;        // into the points given to the constructor
    double squared_distance = 0.0;  // m^2
  };
  struct Leaf {
    std::uint32_t first = 0;  // into order()
    std::uint32_t count = 0;
  };
  // One node of the tree, for showing it: axis 0 to 2, or -1 for a leaf.
  struct Node {
    int axis = -1;
    std::uint32_t left = 0, right = 0;  // nodes; unused in a leaf
    Leaf leaf;                          // used in a leaf
    double split = 0.0;                 // smallest coordinate on the right: the median
    double left_end = 0.0;  // largest coordinate on the left, at most split; no point lies between
  };

  // Throws std::invalid_argument for a point that is not finite, a leaf size below one, and 2^32 points or
  // more.
  explicit KdTree(std::span<const Eigen::Vector3d> points, int leaf_size = 10);

  std::size_t size() const { return order_.size(); }
  bool empty() const { return order_.empty(); }
  // The nearest point; the tree must not be empty. Ties go to the lowest index.
  Neighbour nearest(const Eigen::Vector3d& query) const;
  // The same, and the leaves that were looked into on the way, in order: for showing the search.
  Neighbour nearest(const Eigen::Vector3d& query, std::vector<Leaf>& visited) const;
  // Same, within a bound: false where no point is nearer than max_distance_m (infinity: no bound).
  bool nearestWithin(const Eigen::Vector3d& query, double max_distance_m, Neighbour& found) const;
  // The `count` nearest, nearest first, ties by index (fewer where the tree has fewer).
  void nearestSeveral(const Eigen::Vector3d& query, std::size_t count, std::vector<Neighbour>& found) const;
  // All within radius_m (the bound included), ordered by distance and then index.
  void within(const Eigen::Vector3d& query, double radius_m, std::vector<Neighbour>& found) const;
  // The leaf that holds the point nearest to the query, and that point (thesis 4.2.4).
  Leaf leafOfNearest(const Eigen::Vector3d& query, Neighbour& nearest) const;

  // Original indices in leaf order: the points of a leaf are order()[first .. first + count).
  std::span<const std::uint32_t> order() const { return order_; }
  std::span<const Eigen::Vector3d> points() const { return points_; }  // in leaf order too
  std::span<const Node> nodes() const { return nodes_; }  // the root is nodes()[0]; none in an empty tree

 private:
  struct Entry;    // a point on its way into the tree
  struct Offsets;  // from the query to the box of a node, by axis
  std::uint32_t build(std::span<Entry> entries, std::uint32_t first, int axis, std::size_t leaf_size);
  template <class Found>
  void search(const Eigen::Vector3d& query, Found& found) const;
  template <class Found>
  void descend(const Node* node, const Eigen::Vector3d& query, Offsets& offsets, Found& found) const;
  template <class Found>
  void searchLeaf(const Leaf& leaf, const Eigen::Vector3d& query, Found& found) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Eigen::Vector3d> points_;  // in leaf order
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero(),
                  high_ = Eigen::Vector3d::Zero();  // corners of the root's box
};

}  // namespace tiltmap
