#include "core/scan/kd_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tiltmap {

namespace {

// Share of the widest extent below which an axis is passed over.
constexpr double kNarrow = 0.5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Nearer first, ties by index: the order of every answer.
bool nearer(const KdTree::Neighbour& a, const KdTree::Neighbour& b) {
  return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance
                                                  : a.index < b.index;
}

// What a search collects: bound() is the squared distance beyond which nothing is wanted, offer() takes a
// point.

struct One {
  KdTree::Neighbour best{std::numeric_limits<std::uint32_t>::max(), kInfinity};
  double bound() const { return best.squared_distance; }
  void offer(const KdTree::Neighbour& candidate, const KdTree::Leaf&) {
    if (nearer(candidate, best)) best = candidate;
  }
};

struct OneWithLeaf : One {
  KdTree::Leaf leaf;
  void offer(const KdTree::Neighbour& candidate, const KdTree::Leaf& holder) {
    if (!nearer(candidate, best)) return;
    best = candidate;
    leaf = holder;
  }
};

struct OneWithVisits : One {
  std::vector<KdTree::Leaf>& visited;
  explicit OneWithVisits(std::vector<KdTree::Leaf>& leaves) : visited(leaves) {}
  void enter(const KdTree::Leaf& leaf) { visited.push_back(leaf); }
};

struct Several {
  std::size_t count;
  std::vector<KdTree::Neighbour>& sorted;
  double limit = kInfinity;  // the last one's distance once there are enough
  double bound() const { return limit; }
  void offer(const KdTree::Neighbour& candidate, const KdTree::Leaf&) {
    if (sorted.size() < count) {
      sorted.push_back(candidate);
    } else if (!nearer(candidate, sorted.back())) {
      return;
    }
    std::size_t at = sorted.size() - 1;
    for (; at > 0 && nearer(candidate, sorted[at - 1]); --at) sorted[at] = sorted[at - 1];
    sorted[at] = candidate;
    if (sorted.size() == count) limit = sorted.back().squared_distance;
  }
};

struct AllWithin {
  double squared_radius;
  std::vector<KdTree::Neighbour>& all;
  double bound() const { return squared_radius; }
  void offer(const KdTree::Neighbour& candidate, const KdTree::Leaf&) {
    if (candidate.squared_distance <= squared_radius) all.push_back(candidate);
  }
};

}  // namespace

struct KdTree::Entry {
  Eigen::Vector3d point;
  std::uint32_t index;
};

// The squared distance to a box is summed in the same order as the one to a point, and every part of it is
// rounded from a number that is no larger. Rounding keeps order, so a box is never further than a point
// inside it, and the comparison needs no slack to be exact.
struct KdTree::Offsets {
  double axis[3];
  double squared() const { return axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]; }
};

KdTree::KdTree(std::span<const Eigen::Vector3d> points, int leaf_size) {
  if (leaf_size < 1) throw std::invalid_argument("KdTree: a leaf holds one point at least");
  if (points.size() >= std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("KdTree: more points than there are indices");
  if (points.empty()) return;
  std::vector<Entry> entries(points.size());
  low_ = high_ = points.front();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw std::invalid_argument("KdTree: a point is not finite");
    entries[i] = {points[i], static_cast<std::uint32_t>(i)};
    low_ = low_.cwiseMin(points[i]);
    high_ = high_.cwiseMax(points[i]);
  }
  nodes_.reserve(4 * points.size() / static_cast<std::size_t>(leaf_size) + 1);
  build(entries, 0, 0, static_cast<std::size_t>(leaf_size));
  order_.reserve(points.size());
  points_.reserve(points.size());
  for (const Entry& entry : entries) {
    order_.push_back(entry.index);
    points_.push_back(entry.point);
  }
}

// The halves differ by one point at most, so the depth is bounded by the number of bits of an index.
std::uint32_t KdTree::build(std::span<Entry> entries, std::uint32_t first, int axis, std::size_t leaf_size) {
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  if (entries.size() <= leaf_size) {
    nodes_[node].leaf = {first, static_cast<std::uint32_t>(entries.size())};
    return node;
  }
  Eigen::Vector3d low = entries.front().point, high = low;
  for (const Entry& entry : entries) {
    low = low.cwiseMin(entry.point);
    high = high.cwiseMax(entry.point);
  }
  const Eigen::Vector3d extent = high - low;
  while (extent[axis] < kNarrow * extent.maxCoeff()) axis = (axis + 1) % 3;
  const std::size_t half = entries.size() / 2;
  const auto middle = entries.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(entries.begin(), middle, entries.end(),
                   [axis](const Entry& a, const Entry& b) { return a.point[axis] < b.point[axis]; });
  double left_end = entries.front().point[axis];
  for (const Entry& entry : entries.first(half)) left_end = std::max(left_end, entry.point[axis]);
  const double split = middle->point[axis];
  const int next = (axis + 1) % 3;
  const std::uint32_t left = build(entries.first(half), first, next, leaf_size);
  const std::uint32_t right =
      build(entries.subspan(half), first + static_cast<std::uint32_t>(half), next, leaf_size);
  nodes_[node] = {axis, left, right, {}, split, left_end};
  return node;
}

template <class Found>
void KdTree::searchLeaf(const Leaf& leaf, const Eigen::Vector3d& query, Found& found) const {
  if constexpr (requires { found.enter(leaf); }) found.enter(leaf);
  const Eigen::Vector3d* point = points_.data() + leaf.first;
  const std::uint32_t* index = order_.data() + leaf.first;
  for (std::uint32_t i = 0; i < leaf.count; ++i) {
    const double x = query[0] - point[i][0], y = query[1] - point[i][1], z = query[2] - point[i][2];
    const double squared = x * x + y * y + z * z;
    if (squared <= found.bound()) found.offer({index[i], squared}, leaf);
  }
}

// Called at most once a level, so never deeper than the number of bits of an index.
template <class Found>
void KdTree::descend(const Node* node, const Eigen::Vector3d& query, Offsets& offsets, Found& found) const {
  if (node->axis >= 0) {
    // How far the query lies outside either half.
    const double beyond_left = query[node->axis] - node->left_end;
    const double before_right = node->split - query[node->axis];
    const bool left_first = beyond_left < before_right;
    descend(nodes_.data() + (left_first ? node->left : node->right), query, offsets, found);
    double& offset = offsets.axis[node->axis];
    const double kept = offset;
    offset = left_first ? before_right : beyond_left;
    if (offsets.squared() <= found.bound())
      descend(nodes_.data() + (left_first ? node->right : node->left), query, offsets, found);
    offset = kept;
    return;
  }
  searchLeaf(node->leaf, query, found);
}

template <class Found>
void KdTree::search(const Eigen::Vector3d& query, Found& found) const {
  // One test for three: the sum is finite only where all of them are.
  if (!std::isfinite(query[0] + query[1] + query[2]))
    throw std::invalid_argument("KdTree: the query is not finite");
  if (empty()) return;
  Offsets offsets{};
  for (int axis = 0; axis < 3; ++axis)
    offsets.axis[axis] = std::max({low_[axis] - query[axis], query[axis] - high_[axis], 0.0});
  if (offsets.squared() <= found.bound()) descend(nodes_.data(), query, offsets, found);
}

KdTree::Neighbour KdTree::nearest(const Eigen::Vector3d& query) const {
  if (empty()) throw std::invalid_argument("KdTree::nearest: the tree is empty");
  One found;
  search(query, found);
  return found.best;
}

KdTree::Neighbour KdTree::nearest(const Eigen::Vector3d& query, std::vector<Leaf>& visited) const {
  if (empty()) throw std::invalid_argument("KdTree::nearest: the tree is empty");
  visited.clear();
  OneWithVisits found(visited);
  search(query, found);
  return found.best;
}

bool KdTree::nearestWithin(const Eigen::Vector3d& query, double max_distance_m, Neighbour& found) const {
  if (!(max_distance_m > 0.0)) return false;
  One one;
  // An index below every point's: a point at exactly the bound loses the tie.
  if (max_distance_m < kInfinity) one.best = {0, max_distance_m * max_distance_m};
  const double bound = one.best.squared_distance;
  search(query, one);
  if (!(one.best.squared_distance < bound)) return false;
  found = one.best;
  return true;
}

void KdTree::nearestSeveral(const Eigen::Vector3d& query, std::size_t count,
                            std::vector<Neighbour>& found) const {
  found.clear();
  if (count == 0) return;
  Several several{std::min(count, size()), found};
  search(query, several);
}

void KdTree::within(const Eigen::Vector3d& query, double radius_m, std::vector<Neighbour>& found) const {
  found.clear();
  if (!(radius_m >= 0.0)) return;
  AllWithin all{radius_m * radius_m, found};
  search(query, all);
  std::ranges::sort(found, nearer);
}

KdTree::Leaf KdTree::leafOfNearest(const Eigen::Vector3d& query, Neighbour& nearest) const {
  if (empty()) throw std::invalid_argument("KdTree::leafOfNearest: the tree is empty");
  OneWithLeaf found;
  search(query, found);
  nearest = found.best;
  return found.leaf;
}

}  // namespace tiltmap
