// PCL's counterparts of the small operations.
#include <cmath>
#include <limits>

#include <pcl/console/print.h>
#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/approximate_voxel_grid.h>
#include <pcl/filters/median_filter.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include "tests/benchmarks/operations.h"

namespace tiltmap::benchmarks {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

Cloud::Ptr unordered(const std::vector<Eigen::Vector3d>& points) {
  auto cloud = std::make_shared<Cloud>();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3f f = p.cast<float>();
    cloud->push_back({f.x(), f.y(), f.z()});
  }
  return cloud;
}

// `point(cell)` for cells that hold a point, NaN elsewhere.
template <class Function>
Cloud::Ptr organised(const RangeImage& image, Function point) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  auto cloud =
      std::make_shared<Cloud>(static_cast<std::uint32_t>(image.columns()),
                              static_cast<std::uint32_t>(image.rows()), pcl::PointXYZ(kNan, kNan, kNan));
  for (std::size_t cell = 0; cell < image.cells(); ++cell)
    if (image.hasPoint(cell)) (*cloud)[cell] = point(cell);
  cloud->is_dense = false;
  return cloud;
}

double countNormals(const Normals& normals) {
  double count = 0.0;
  for (const pcl::Normal& normal : normals) count += std::isfinite(normal.normal_x) ? 1.0 : 0.0;
  return count;
}

// PCL's filter takes the median of z over an organised cloud: it gets the ranges as z.
void addMedian(const OperationInput& input, std::vector<Operation>& list) {
  const RangeImage& image = *input.scan.image;
  const Cloud::Ptr depth = organised(image, [&image](std::size_t cell) {
    const auto columns = static_cast<std::size_t>(image.columns());
    return pcl::PointXYZ(static_cast<float>(cell % columns), static_cast<float>(cell / columns),
                         image.range(cell));
  });
  list.push_back({kMedianSquare, "PCL MedianFilter",
                  [depth] {
                    pcl::MedianFilter<pcl::PointXYZ> filter;
                    filter.setWindowSize(3);
                    filter.setInputCloud(depth);
                    Cloud result;
                    filter.filter(result);
                    double changed = 0.0;
                    for (std::size_t i = 0; i < result.size(); ++i)
                      changed += std::abs(result[i].z - (*depth)[i].z) > 2.0F ? 1.0 : 0.0;
                    return changed;
                  },
                  "cells changed by more than 2 m"});
}

// Its integral images look along z, as a depth camera does: the cloud is turned so that our y (forward) is
// its z.
void addNormals(const OperationInput& input, std::vector<Operation>& list) {
  const std::vector<Eigen::Vector3d>& points = input.cell_points;
  const Cloud::Ptr camera = organised(*input.scan.image, [&points](std::size_t cell) {
    const Eigen::Vector3f p = points[cell].cast<float>();
    return pcl::PointXYZ(p.x(), -p.z(), p.y());
  });
  using Integral = pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal>;
  const auto add = [&](const char* name, Integral::NormalEstimationMethod method) {
    list.push_back({kMatrixNormals, name,
                    [camera, method] {
                      Integral estimation;
                      estimation.setNormalEstimationMethod(method);
                      estimation.setNormalSmoothingSize(4.0F);
                      estimation.setInputCloud(camera);
                      Normals normals;
                      estimation.compute(normals);
                      return countNormals(normals);
                    },
                    "normals"});
  };
  add("PCL integral images, 3D gradient", Integral::AVERAGE_3D_GRADIENT);
  add("PCL integral images, covariance", Integral::COVARIANCE_MATRIX);
  list.push_back({kCloudNormals, "PCL NormalEstimation",
                  [cloud = unordered(input.points)] {
                    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
                    estimation.setInputCloud(cloud);
                    estimation.setKSearch(kNormalNeighbours);
                    Normals normals;
                    estimation.compute(normals);
                    return countNormals(normals);
                  },
                  "normals"});
}

template <class Grid>
Operation reduction(const char* name, const Cloud::Ptr& cloud) {
  return {kReduction, name,
          [cloud] {
            Grid grid;
            const auto leaf = static_cast<float>(kLineDistanceM);
            grid.setLeafSize(leaf, leaf, leaf);
            grid.setInputCloud(cloud);
            Cloud result;
            grid.filter(result);
            return static_cast<double>(result.size());
          },
          "points left"};
}

void addTree(const OperationInput& input, std::vector<Operation>& list) {
  const Cloud::Ptr cloud = unordered(input.points);
  const Cloud::Ptr queries = unordered(input.queries);
  constexpr const char* kName = "PCL KdTreeFLANN";
  list.push_back({kTreeBuild, kName,
                  [cloud] {
                    pcl::KdTreeFLANN<pcl::PointXYZ> tree;
                    tree.setInputCloud(cloud);
                    return static_cast<double>(cloud->size());
                  },
                  "points"});
  const auto tree = std::make_shared<pcl::KdTreeFLANN<pcl::PointXYZ>>();
  tree->setInputCloud(cloud);
  const auto several = [&](const char* subject, int count, const char* result) {
    list.push_back({subject, kName,
                    [tree, queries, count] {
                      double sum = 0.0;
                      pcl::Indices index;
                      std::vector<float> square;
                      for (const pcl::PointXYZ& q : *queries) {
                        tree->nearestKSearch(q, count, index, square);
                        sum += std::sqrt(static_cast<double>(square.back()));
                      }
                      return sum / static_cast<double>(queries->size());
                    },
                    result});
  };
  several(kNearest, 1, "m, mean distance");
  several(kTenNearest, static_cast<int>(kSeveral), "m, mean distance of the tenth");
  list.push_back({kWithin, kName,
                  [tree, queries] {
                    double sum = 0.0;
                    pcl::Indices index;
                    std::vector<float> square;
                    for (const pcl::PointXYZ& q : *queries)
                      sum += tree->radiusSearch(q, kRadiusM, index, square);
                    return sum / static_cast<double>(queries->size());
                  },
                  "points, mean"});
}

}  // namespace

std::vector<Operation> pclOperations(const OperationInput& input) {
  // It would say at each call that our scans are not from a depth camera.
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  std::vector<Operation> list;
  addMedian(input, list);
  addNormals(input, list);
  const Cloud::Ptr cloud = unordered(input.points);
  list.push_back(reduction<pcl::VoxelGrid<pcl::PointXYZ>>("PCL VoxelGrid", cloud));
  list.push_back(reduction<pcl::ApproximateVoxelGrid<pcl::PointXYZ>>("PCL ApproximateVoxelGrid", cloud));
  addTree(input, list);
  return list;
}

}  // namespace tiltmap::benchmarks
