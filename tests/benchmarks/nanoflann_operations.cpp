// nanoflann's counterparts of the tree.
#include <cmath>
#include <memory>

#include <nanoflann.hpp>

#include "tests/benchmarks/operations.h"

namespace tiltmap::benchmarks {

namespace {

constexpr const char* kName = "nanoflann";

// How nanoflann sees our points; it does not copy them.
struct PointAdaptor {
  const std::vector<Eigen::Vector3d>* points;
  std::size_t kdtree_get_point_count() const { return points->size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return (*points)[index][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointAdaptor>,
                                                 PointAdaptor, 3, std::uint32_t>;

struct OwnedTree {
  explicit OwnedTree(const std::vector<Eigen::Vector3d>& points)
      : adaptor{&points}, tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}
  PointAdaptor adaptor;
  Tree tree;
};

Operation several(const char* subject, const std::shared_ptr<const OwnedTree>& tree,
                  const OperationInput& input, std::size_t count, const char* result) {
  return {subject, kName,
          [tree, in = &input, count] {
            double sum = 0.0;
            std::vector<std::uint32_t> index(count);
            std::vector<double> square(count);
            for (const Eigen::Vector3d& q : in->queries) {
              const auto found = tree->tree.knnSearch(q.data(), count, index.data(), square.data());
              sum += std::sqrt(square[static_cast<std::size_t>(found) - 1]);
            }
            return sum / static_cast<double>(in->queries.size());
          },
          result};
}

}  // namespace

std::vector<Operation> nanoflannOperations(const OperationInput& input) {
  std::vector<Operation> list;
  list.push_back({kTreeBuild, kName,
                  [in = &input] {
                    const OwnedTree tree(in->points);
                    return static_cast<double>(tree.adaptor.kdtree_get_point_count());
                  },
                  "points"});
  const auto tree = std::make_shared<const OwnedTree>(input.points);
  list.push_back(several(kNearest, tree, input, 1, "m, mean distance"));
  list.push_back(several(kTenNearest, tree, input, kSeveral, "m, mean distance of the tenth"));
  list.push_back({kWithin, kName,
                  [tree, in = &input] {
                    double sum = 0.0;
                    std::vector<std::pair<std::uint32_t, double>> found;
                    for (const Eigen::Vector3d& q : in->queries)
                      sum += static_cast<double>(tree->tree.radiusSearch(q.data(), kRadiusM * kRadiusM, found,
                                                                         nanoflann::SearchParams()));
                    return sum / static_cast<double>(in->queries.size());
                  },
                  "points, mean"});
  return list;
}

}  // namespace tiltmap::benchmarks
