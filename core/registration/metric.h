// What a pair costs, and the motion that lowers the sum. Every metric gives the same linearised system, so
// that a solver of one pair and a solver of many scans add them up alike.
#pragma once

#include <span>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/registration/loss_scale.h"
#include "core/registration/registration_settings.h"
#include "core/registration/rejection.h"
#include "core/registration/surface_elements.h"

namespace tiltmap {

// Geman and McClure 1985, rho = r^2 / (s^2 + r^2), as a weight for iterated least squares; 1 where s is 0 (no
// loss).
inline double gemanMcClureWeight(double squared_residual, double squared_scale) {
  if (squared_scale <= 0.0) return 1.0;
  const double w = squared_scale / (squared_scale + squared_residual);
  return w * w;
}

// The squared scale of the loss for one residual; `variance_m2` with the loss's excess or scale added
// (patches), any number for the others.
inline double squaredLossScale(const LossScale& loss, double variance_m2) {
  return loss.isOwn() ? loss.deviations * loss.deviations * variance_m2 : loss.scale_m * loss.scale_m;
}

// Which residual a combination of motion and elements has.
enum class Metric {
  PointToPoint,  // distance of the two points (closed forms)
  PointToPlane,  // along the fixed element's normal
  PatchToPatch,  // along the blend of both normals that lets the better-known plane extrapolate
  PointGicp,  // Segal et al. 2009: both points' covariances, scaled so that aligned surfaces give the plane
              // distance
};
Metric metricOf(MotionMethod motion, bool patches);

// Sum of J^T w J and J^T w r over the kept pairs, for a small motion (rotation, translation) applied on the
// left of the moving scan's pose in the common frame (Pose::moved). Applying one small motion to both scans
// changes no residual, so the fixed scan's Jacobian is the negative: a solver of many scans adds h to both
// diagonal blocks, -h off the diagonal, +b to the moving and -b to the fixed scan's right-hand side, and
// solves H d = -b. PatchToPatch weighs by the variance of each residual, so h is an information (rad^-2,
// m^-2); the others by 1 m^-2. PointToPoint has a closed form and leaves b at zero; its h is that of the
// fixed normals, for the conditioning.
struct LinearSystem {
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  std::size_t pairs = 0;            // used
  double loss_weight = 0.0;         // sum of the loss's weights (patches: over the residual's variance)
  double loss_square_m2 = 0.0;      // sum of the same times the squared residual
  std::size_t agreeing = 0;         // residual within three deviations (points: 0.5 m)
  std::size_t agreeing_moving = 0;  // of those, found from the moving scan's side
  double plane_weight = 0.0;  // sum of the weights in h, their first and second moments in the common frame
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double square_moment = 0.0;
  double slope_noise = 0.0;  // sum of the weights times the variance of the normals (patches)
};

struct Residuals {
  std::vector<double> size_m;       // |residual|
  std::vector<double> variance_m2;  // of it, from the two patches alone; empty for the other metrics
};

// Adds up the kept pairs at two poses into a common frame (pairwise: that of the fixed scan, its pose the
// identity). `residuals`, where given, is replaced by those of the kept pairs. With a loss the variance of a
// pair of patches grows by the square of the scale.
void linearise(Metric metric, const SurfaceElements& fixed, const SurfaceElements& moving,
               const Pose& common_from_fixed, const Pose& common_from_moving,
               std::span<const Correspondence> pairs, const RegistrationSettings& settings,
               const LossScale& loss, LinearSystem& system, Residuals* residuals = nullptr);

// What the surfaces determine: h per unit weight, about the pairs' centre, rotations measured as displacement
// at their root mean square distance from it. Dimensionless; 0 means free to slide or turn. Noisy normals let
// a plane look as if it held a little; what they would make of one counts as weak too.
struct Conditioning {
  Vector6d eigenvalues = Vector6d::Zero();  // ascending
  Matrix6d directions = Matrix6d::Zero();   // a column each: (rotation, translation) for Pose::moved
  int weak = 6;                             // how many lie below the bound
  int free = 6;                             // how many of them below a tenth of it
};
Conditioning conditioningOf(const LinearSystem& system, double weak_below);

// The step -h^-1 b within the directions that are not weak; zero where all are.
Vector6d solvedStep(const LinearSystem& system, const Conditioning& condition);
// The same within all that are not free: on the way, when pairs are still wrong or few, a direction that will
// be held in the end may look weak, and would stay where it is for good.
Vector6d solvedStepOnTheWay(const LinearSystem& system, const Conditioning& condition);

// The closed forms: fixed_from_moving from the kept pairs, weighted by the loss. Error: too few pairs, or on
// a line.
Result<Pose> closedFormStep(MotionMethod motion, const SurfaceElements& fixed, const SurfaceElements& moving,
                            const Pose& fixed_from_moving, std::span<const Correspondence> pairs,
                            const LossScale& loss);

}  // namespace tiltmap
