#include "core/registration/metric.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>

#include "core/registration/closed_form_motion.h"
#include "core/registration/normal_equations.h"

namespace tiltmap {

namespace {

constexpr double kNoiseFactor =
    3.0;  // an eigenvalue below so many times what noisy normals make of a plane is none
constexpr double kFreeShare = 0.1;  // of the bound
constexpr double kFittingPoint_m =
    0.5;  // points agree within this (the neighbour criterion of thesis chapter 6)

// The two elements of a pair in the common frame.
struct Placed {
  Eigen::Vector3d q, p;    // fixed, moving
  Eigen::Vector3d nq, np;  // normals
};

// A residual along one normal: value, Jacobian (rotation part; the translation part is the normal), variance.
struct Residual {
  double r = 0.0;
  Eigen::Vector3d turn, normal;
  double variance = 1.0;     // m^2
  double slope_noise = 0.0;  // variance of the normal, along the surface
};

Residual pointToPlane(const Placed& e) {
  return {e.nq.dot(e.p - e.q), e.p.cross(e.nq), e.nq, 1.0};
}

double tiltVariance(const PatchShape& shape, const Eigen::Vector3d& d) {
  const double u = shape.u.dot(d), v = shape.v.dot(d);
  return u * u * shape.tilt_variance_u + v * v * shape.tilt_variance_v;
}

// Both planes extrapolate over the offset d between the centres; n = a nq + (1 - a) np with the a of least
// variance. d_fixed and d_moving are d in the frames of the two scans.
Residual patchToPatch(const Placed& e, const PatchShape& fixed, const PatchShape& moving,
                      const Eigen::Vector3d& d_fixed, const Eigen::Vector3d& d_moving) {
  const double tilt_fixed = tiltVariance(fixed, d_fixed), tilt_moving = tiltVariance(moving, d_moving);
  const double both = tilt_fixed + tilt_moving;
  const double a = both > 0.0 ? tilt_moving / both : 0.5;
  const Eigen::Vector3d d = e.p - e.q;
  Residual result;
  result.normal = a * e.nq + (1.0 - a) * e.np;
  result.r = result.normal.dot(d);
  // The moving normal turns with the scan: d(n . d) = w . (p x n + (1 - a) np x d).
  result.turn = e.p.cross(result.normal) + (1.0 - a) * e.np.cross(d);
  result.variance = fixed.offset_variance_m2 + moving.offset_variance_m2 + a * a * tilt_fixed +
                    (1.0 - a) * (1.0 - a) * tilt_moving;
  result.slope_noise = 0.5 * (a * a * (fixed.tilt_variance_u + fixed.tilt_variance_v) +
                              (1.0 - a) * (1.0 - a) * (moving.tilt_variance_u + moving.tilt_variance_v));
  return result;
}

Eigen::Matrix3d discCovariance(const Eigen::Vector3d& normal, double epsilon) {
  return Eigen::Matrix3d::Identity() - (1.0 - epsilon) * normal * normal.transpose();
}

// The loop over the kept pairs that all metrics share: places the elements, hands them to `body`.
template <class Body>
void forKept(const SurfaceElements& fixed, const SurfaceElements& moving, const Pose& common_from_fixed,
             const Pose& common_from_moving, std::span<const Correspondence> pairs, Body&& body) {
  const Eigen::Matrix3d rf = common_from_fixed.rotation(), rm = common_from_moving.rotation();
  const Eigen::Vector3d tf = common_from_fixed.translation(), tm = common_from_moving.translation();
  for (const Correspondence& pair : pairs) {
    if (!pair.kept()) continue;
    const Placed placed{rf * fixed.position[pair.fixed] + tf, rm * moving.position[pair.moving] + tm,
                        rf * fixed.normal[pair.fixed], rm * moving.normal[pair.moving]};
    body(pair, placed, rf, rm);
  }
}

struct Sums {
  LinearSystem& system;
  NormalEquations accumulator;
  Residuals* residuals = nullptr;

  // Returns the loss's weight of a squared residual, and counts the pair.
  double count(const Correspondence& pair, double square, double fitting_square, double squared_scale,
               double variance = 1.0) {
    const double w = gemanMcClureWeight(square, squared_scale);
    ++system.pairs;
    system.loss_weight += w / variance;
    system.loss_square_m2 += w / variance * square;
    if (square <= fitting_square) {
      ++system.agreeing;
      if (!pair.from_fixed) ++system.agreeing_moving;
    }
    if (residuals) residuals->size_m.push_back(std::sqrt(square));
    return w;
  }
  void addPlane(const Residual& residual, const Eigen::Vector3d& p, double w) {
    accumulator.add(residual.turn, residual.normal, w, residual.r);
    weigh(p, w);
    system.slope_noise += w * residual.slope_noise;
  }
  void weigh(const Eigen::Vector3d& p, double w) {
    system.plane_weight += w;
    system.moment += w * p;
    system.square_moment += w * p.squaredNorm();
  }
};

constexpr double kFittingSquare = kFittingPoint_m * kFittingPoint_m;

}  // namespace

Metric metricOf(MotionMethod motion, bool patches) {
  switch (motion) {
    case MotionMethod::PointToPlane:
      return Metric::PointToPlane;
    case MotionMethod::PlaneToPlane:
      return patches ? Metric::PatchToPatch : Metric::PointGicp;
    default:
      return Metric::PointToPoint;
  }
}

void linearise(Metric metric, const SurfaceElements& fixed, const SurfaceElements& moving,
               const Pose& common_from_fixed, const Pose& common_from_moving,
               std::span<const Correspondence> pairs, const RegistrationSettings& settings,
               const LossScale& loss, LinearSystem& system, Residuals* residuals) {
  if (metric == Metric::PatchToPatch &&
      (fixed.shape.size() != fixed.size() || moving.shape.size() != moving.size()))
    throw std::logic_error("linearise: the patch metric needs patches");
  if (metric != Metric::PatchToPatch && loss.isOwn())
    throw std::logic_error("linearise: only patches know the deviation of their residuals");
  if (residuals) residuals->size_m.clear(), residuals->variance_m2.clear();
  Sums sums{system, {}, residuals};
  const double squared_scale = loss.scale_m * loss.scale_m;
  const auto each = [&](auto&& body) {
    forKept(fixed, moving, common_from_fixed, common_from_moving, pairs, body);
  };
  switch (metric) {
    case Metric::PointToPoint:
      each([&](const Correspondence& pair, const Placed& e, const Eigen::Matrix3d&, const Eigen::Matrix3d&) {
        const double w = sums.count(pair, (e.p - e.q).squaredNorm(), kFittingSquare, squared_scale);
        Residual plane = pointToPlane(e);
        plane.r = 0.0;
        if (pair.has_normals) sums.addPlane(plane, e.p, w);
      });
      break;
    case Metric::PointToPlane:
      each([&](const Correspondence& pair, const Placed& e, const Eigen::Matrix3d&, const Eigen::Matrix3d&) {
        const Residual plane = pointToPlane(e);
        sums.addPlane(plane, e.p, sums.count(pair, plane.r * plane.r, kFittingSquare, squared_scale));
      });
      break;
    case Metric::PatchToPatch:
      each([&](const Correspondence& pair, const Placed& e, const Eigen::Matrix3d& rf,
               const Eigen::Matrix3d& rm) {
        const Eigen::Vector3d d = e.p - e.q;
        const Residual plane = patchToPatch(e, fixed.shape[pair.fixed], moving.shape[pair.moving],
                                            rf.transpose() * d, rm.transpose() * d);
        const double variance = plane.variance + squared_scale;
        const double w =
            sums.count(pair, plane.r * plane.r, 9.0 * variance, squaredLossScale(loss, variance), variance);
        if (residuals) residuals->variance_m2.push_back(plane.variance);
        sums.addPlane(plane, e.p, w / variance);
      });
      break;
    case Metric::PointGicp:
      each([&](const Correspondence& pair, const Placed& e, const Eigen::Matrix3d&, const Eigen::Matrix3d&) {
        const Eigen::Vector3d d = e.p - e.q;
        const double epsilon = settings.gicp_epsilon;
        const Eigen::Matrix3d m =
            2.0 * epsilon * (discCovariance(e.nq, epsilon) + discCovariance(e.np, epsilon)).inverse();
        const double w = sums.count(pair, d.dot(m * d), kFittingSquare, squared_scale);
        // The residual is d itself: J = (-[p]x, I).
        Eigen::Matrix<double, 3, 6> j;
        j << 0.0, e.p.z(), -e.p.y(), 1.0, 0.0, 0.0, -e.p.z(), 0.0, e.p.x(), 0.0, 1.0, 0.0, e.p.y(), -e.p.x(),
            0.0, 0.0, 0.0, 1.0;
        const Eigen::Matrix<double, 3, 6> mj = w * m * j;
        system.h.noalias() += j.transpose() * mj;
        system.b.noalias() += mj.transpose() * d;
        sums.weigh(e.p, w);
      });
      break;
  }
  sums.accumulator.addTo(system);
}

Conditioning conditioningOf(const LinearSystem& system, double weak_below) {
  Conditioning result;
  if (!(system.plane_weight > 0.0)) return result;
  const double bound = std::max(weak_below, kNoiseFactor * system.slope_noise / system.plane_weight);
  const Eigen::Vector3d centre = system.moment / system.plane_weight;
  const double spread = system.square_moment / system.plane_weight - centre.squaredNorm();
  const double radius = std::sqrt(std::max(spread, 1e-6));
  // A turn w about the centre moves the origin's frame by (w, centre x w): d = A d', d' = (radius * w, v).
  Matrix6d a = Matrix6d::Identity();
  Eigen::Matrix3d cross;
  cross << 0, -centre.z(), centre.y(), centre.z(), 0, -centre.x(), -centre.y(), centre.x(), 0;
  a.topLeftCorner<3, 3>() /= radius;
  a.bottomLeftCorner<3, 3>() = cross / radius;
  const Matrix6d normalised = a.transpose() * system.h * a / system.plane_weight;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(normalised);
  result.eigenvalues = solver.eigenvalues();
  result.directions = a * solver.eigenvectors();
  result.weak = result.free = 0;
  for (int i = 0; i < 6; ++i) {
    if (!(result.eigenvalues[i] >= bound)) ++result.weak;
    if (!(result.eigenvalues[i] >= kFreeShare * bound)) ++result.free;
  }
  return result;
}

namespace {

// In the eigenvectors' coordinates h is diagonal: eigenvalue times the sum of weights.
Vector6d stepFrom(int first, const LinearSystem& system, const Conditioning& condition) {
  Vector6d step = Vector6d::Zero();
  for (int i = first; i < 6; ++i) {
    const Vector6d direction = condition.directions.col(i);
    step -= direction * (direction.dot(system.b) / (condition.eigenvalues[i] * system.plane_weight));
  }
  return step;
}

}  // namespace

Vector6d solvedStep(const LinearSystem& system, const Conditioning& condition) {
  return stepFrom(condition.weak, system, condition);
}

Vector6d solvedStepOnTheWay(const LinearSystem& system, const Conditioning& condition) {
  return stepFrom(condition.free, system, condition);
}

Result<Pose> closedFormStep(MotionMethod motion, const SurfaceElements& fixed, const SurfaceElements& moving,
                            const Pose& fixed_from_moving, std::span<const Correspondence> pairs,
                            const LossScale& loss) {
  ClosedForm method = ClosedForm::Svd;
  switch (motion) {
    case MotionMethod::Svd:
      break;
    case MotionMethod::Orthonormal:
      method = ClosedForm::OrthonormalMatrices;
      break;
    case MotionMethod::Quaternion:
      method = ClosedForm::UnitQuaternion;
      break;
    case MotionMethod::DualQuaternion:
      method = ClosedForm::DualQuaternion;
      break;
    default:
      throw std::logic_error("closedFormStep: the motion has no closed form");
  }
  std::vector<Eigen::Vector3d> model, data;
  std::vector<double> weights;
  for (const Correspondence& pair : pairs) {
    if (!pair.kept()) continue;
    model.push_back(fixed.position[pair.fixed]);
    data.push_back(moving.position[pair.moving]);
    if (loss.scale_m > 0.0)
      weights.push_back(gemanMcClureWeight((fixed_from_moving * data.back() - model.back()).squaredNorm(),
                                           loss.scale_m * loss.scale_m));
  }
  return closedFormMotion(method, model, data, weights);
}

}  // namespace tiltmap
