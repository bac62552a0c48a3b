// PCL's registrations. The only file that includes them: they take 20 s and 1 GB to compile.
#include <pcl/common/transforms.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>

#include "core/scan/point_cloud.h"
#include "tests/benchmarks/pair_method.h"

namespace tiltmap::benchmarks {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using NormalCloud = pcl::PointCloud<pcl::PointNormal>;

Cloud::Ptr toPcl(const Scan& scan) {
  const PointCloud points = cloudOf(*scan.image, scan.geometry);
  auto cloud = std::make_shared<Cloud>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3d& p : points.points) {
    const Eigen::Vector3f f = p.cast<float>();
    cloud->push_back({f.x(), f.y(), f.z()});
  }
  return cloud;
}

Cloud::Ptr thinned(const Cloud::ConstPtr& cloud) {
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const auto leaf = static_cast<float>(kVoxelM);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(cloud);
  auto result = std::make_shared<Cloud>();
  grid.filter(*result);
  return result;
}

NormalCloud::Ptr withNormals(const Cloud::ConstPtr& cloud) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::PointNormal> estimation;
  estimation.setInputCloud(cloud);
  estimation.setKSearch(kNeighbours);
  auto result = std::make_shared<NormalCloud>();
  estimation.compute(*result);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    pcl::PointNormal p = (*result)[i];
    p.getVector3fMap() = (*cloud)[i].getVector3fMap();
    if (std::isfinite(p.normal_x)) (*result)[kept++] = p;
  }
  result->resize(kept);
  return result;
}

// PCL starts from the moving cloud as it lies: the start is passed as its guess.
template <class Point, class Registration>
Result<Pose> aligned(Registration& registration, const typename pcl::PointCloud<Point>::Ptr& fixed,
                     const typename pcl::PointCloud<Point>::Ptr& moving, const Pose& start) {
  registration.setMaxCorrespondenceDistance(kPairDistanceM);
  registration.setMaximumIterations(kIterations);
  registration.setInputTarget(fixed);
  registration.setInputSource(moving);
  pcl::PointCloud<Point> unused;
  registration.align(unused, start.matrix().cast<float>());
  const Eigen::Matrix4d found = registration.getFinalTransformation().template cast<double>();
  if (!registration.hasConverged() || !found.allFinite())
    return fail("PCL did not converge", "", "leave the pair out");
  return Pose(Eigen::Matrix3d(found.topLeftCorner<3, 3>()), found.topRightCorner<3, 1>());
}

PairMethod pclMethod(std::string name,
                     std::function<Result<Pose>(const Cloud::Ptr&, const Cloud::Ptr&, const Pose&)> run) {
  return {std::move(name), [run = std::move(run)](const PairProblem& pair) -> TimedJob {
            return [run, fixed = toPcl(pair.fixed), moving = toPcl(pair.moving),
                    start = pair.start_fixed_from_moving] {
              return run(thinned(fixed), thinned(moving), start);
            };
          }};
}

}  // namespace

std::vector<PairMethod> pclMethods() {
  return {
      pclMethod("PCL GICP",
                [](const Cloud::Ptr& fixed, const Cloud::Ptr& moving, const Pose& start) {
                  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp;
                  gicp.setCorrespondenceRandomness(kNeighbours);
                  return aligned<pcl::PointXYZ>(gicp, fixed, moving, start);
                }),
      pclMethod("PCL ICP, point to point",
                [](const Cloud::Ptr& fixed, const Cloud::Ptr& moving, const Pose& start) {
                  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
                  icp.setTransformationEpsilon(1e-8);
                  return aligned<pcl::PointXYZ>(icp, fixed, moving, start);
                }),
      pclMethod("PCL ICP, with normals",
                [](const Cloud::Ptr& fixed, const Cloud::Ptr& moving, const Pose& start) {
                  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
                  icp.setTransformationEpsilon(1e-8);
                  return aligned<pcl::PointNormal>(icp, withNormals(fixed), withNormals(moving), start);
                }),
  };
}

}  // namespace tiltmap::benchmarks
