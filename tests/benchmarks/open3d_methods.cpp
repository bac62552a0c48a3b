// Open3D's registrations. The only file that includes them.
#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/GeneralizedICP.h>
#include <open3d/pipelines/registration/Registration.h>

#include "core/scan/point_cloud.h"
#include "tests/benchmarks/pair_method.h"

namespace tiltmap::benchmarks {

namespace {

namespace o3d = open3d::pipelines::registration;
using Cloud = open3d::geometry::PointCloud;
using CloudPtr = std::shared_ptr<Cloud>;

CloudPtr toOpen3d(const Scan& scan) {
  return std::make_shared<Cloud>(cloudOf(*scan.image, scan.geometry).points);
}

o3d::ICPConvergenceCriteria criteria() {
  return {1e-6, 1e-6, kIterations};
}

Result<Pose> poseOf(const o3d::RegistrationResult& found) {
  const Eigen::Matrix4d matrix = found.transformation_;
  if (!matrix.allFinite() || found.fitness_ <= 0.0)
    return fail("Open3D found no pairs", "", "leave the pair out");
  return Pose(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>()), matrix.topRightCorner<3, 1>());
}

PairMethod open3dMethod(std::string name,
                        std::function<o3d::RegistrationResult(Cloud&, Cloud&, const Eigen::Matrix4d&)> run) {
  return {std::move(name), [run = std::move(run)](const PairProblem& pair) -> TimedJob {
            return [run, fixed = toOpen3d(pair.fixed), moving = toOpen3d(pair.moving),
                    start = pair.start_fixed_from_moving.matrix()]() -> Result<Pose> {
              const CloudPtr thin_fixed = fixed->VoxelDownSample(kVoxelM);
              const CloudPtr thin_moving = moving->VoxelDownSample(kVoxelM);
              return poseOf(run(*thin_fixed, *thin_moving, start));
            };
          }};
}

}  // namespace

std::vector<PairMethod> open3dMethods() {
  return {
      open3dMethod("Open3D ICP, point to point",
                   [](Cloud& fixed, Cloud& moving, const Eigen::Matrix4d& start) {
                     return o3d::RegistrationICP(moving, fixed, kPairDistanceM, start,
                                                 o3d::TransformationEstimationPointToPoint(false),
                                                 criteria());
                   }),
      open3dMethod("Open3D ICP, point to plane",
                   [](Cloud& fixed, Cloud& moving, const Eigen::Matrix4d& start) {
                     fixed.EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(kNeighbours));
                     return o3d::RegistrationICP(moving, fixed, kPairDistanceM, start,
                                                 o3d::TransformationEstimationPointToPlane(), criteria());
                   }),
      open3dMethod("Open3D GICP",
                   [](Cloud& fixed, Cloud& moving, const Eigen::Matrix4d& start) {
                     return o3d::RegistrationGeneralizedICP(moving, fixed, kPairDistanceM, start,
                                                            o3d::TransformationEstimationForGeneralizedICP(),
                                                            criteria());
                   }),
  };
}

}  // namespace tiltmap::benchmarks
