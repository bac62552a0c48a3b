#include <memory>

#include "core/scan/filters.h"
#include "core/scan/kd_tree.h"
#include "core/scan/normals.h"
#include "core/scan/point_cloud.h"
#include "core/scan/reduction.h"
#include "tests/benchmarks/operations.h"

namespace tiltmap::benchmarks {

namespace {

constexpr const char* kOurs = "Tiltmap";

double countNormals(const std::vector<Eigen::Vector3d>& normals) {
  double count = 0.0;
  for (const Eigen::Vector3d& normal : normals) count += normal.isZero() ? 0.0 : 1.0;
  return count;
}

void addScanOperations(const OperationInput& input, std::vector<Operation>& list) {
  const OperationInput* in = &input;
  const RangeImage* image = input.scan.image.get();
  list.push_back({kMedianSquare, kOurs,
                  [in] { return static_cast<double>(medianFiltered(in->scan.image, {}).changes.size()); },
                  "cells changed, threshold 2 m"});
  list.push_back({"median filter, 7 of a line", kOurs,
                  [in] {
                    MedianFilterSettings settings;
                    settings.window = MedianWindow::Line;
                    return static_cast<double>(medianFiltered(in->scan.image, settings).changes.size());
                  },
                  "cells changed, threshold 2 m"});
  list.push_back({"points from ranges", kOurs,
                  [in, image] { return static_cast<double>(cellPoints(*image, in->scan.geometry).size()); },
                  "cells"});
  list.push_back({kMatrixNormals, kOurs,
                  [in, image] { return countNormals(matrixNormals(*image, in->cell_points)); }, "normals"});
  list.push_back(
      {kCloudNormals, kOurs,
       [in] { return countNormals(cloudNormals(in->points, kNormalNeighbours, Eigen::Vector3d::Zero())); },
       "normals"});
  list.push_back({kReduction, "Tiltmap, voxels",
                  [in, cloud = std::make_shared<PointCloud>(PointCloud{in->points, {}, {}, {}})] {
                    return static_cast<double>(voxelReduced(*cloud, kLineDistanceM).size());
                  },
                  "points left"});
  list.push_back({kReduction, "Tiltmap, along lines",
                  [in, image] {
                    return static_cast<double>(
                        reducedAlongLines(*image, in->cell_points, {}, kLineDistanceM).size());
                  },
                  "points left"});
}

void addTreeOperations(const OperationInput& input, std::vector<Operation>& list) {
  const OperationInput* in = &input;
  list.push_back(
      {kTreeBuild, kOurs,
       [in] { return static_cast<double>(KdTree(in->points, static_cast<int>(kLeafSize)).size()); },
       "points"});
  const auto tree = std::make_shared<const KdTree>(in->points, static_cast<int>(kLeafSize));
  list.push_back({kNearest, kOurs,
                  [in, tree] {
                    double sum = 0.0;
                    for (const Eigen::Vector3d& q : in->queries)
                      sum += std::sqrt(tree->nearest(q).squared_distance);
                    return sum / static_cast<double>(in->queries.size());
                  },
                  "m, mean distance"});
  list.push_back({kTenNearest, kOurs,
                  [in, tree] {
                    double sum = 0.0;
                    std::vector<KdTree::Neighbour> found;
                    for (const Eigen::Vector3d& q : in->queries) {
                      tree->nearestSeveral(q, kSeveral, found);
                      sum += std::sqrt(found.back().squared_distance);
                    }
                    return sum / static_cast<double>(in->queries.size());
                  },
                  "m, mean distance of the tenth"});
  list.push_back({kWithin, kOurs,
                  [in, tree] {
                    double sum = 0.0;
                    std::vector<KdTree::Neighbour> found;
                    for (const Eigen::Vector3d& q : in->queries) {
                      tree->within(q, kRadiusM, found);
                      sum += static_cast<double>(found.size());
                    }
                    return sum / static_cast<double>(in->queries.size());
                  },
                  "points, mean"});
}

}  // namespace

std::vector<Operation> ownOperations(const OperationInput& input) {
  std::vector<Operation> list;
  addScanOperations(input, list);
  addTreeOperations(input, list);
  return list;
}

}  // namespace tiltmap::benchmarks
