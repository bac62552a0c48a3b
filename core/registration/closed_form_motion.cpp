#include "core/registration/closed_form_motion.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace tiltmap {

namespace {

using Points = std::span<const Eigen::Vector3d>;
using Weights = std::span<const double>;

// Spread against size, and second axis against first, below which rounding or a hair decides the rotation:
// pairs within 0.1 mm of a line 10 m long.
constexpr double kNoSpread = 1e-12;
constexpr double kOneLine = 1e-10;

double weightOf(Weights weights, std::size_t k) {
  return weights.empty() ? 1.0 : weights[k];
}

// The weighted sums that every method works from (thesis 4.2.2 to 4.2.6), about the two centroids.
struct Moments {
  double weight = 0.0;
  Eigen::Vector3d model_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d data_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  // sum w * model * data^T, square metres
  double model_square = 0.0;                        // sum w * |model|^2
  double data_square = 0.0;
};

Moments momentsOf(Points model, Points data, Weights weights) {
  Moments sums;
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double w = weightOf(weights, k);
    sums.weight += w;
    sums.model_mean += w * model[k];
    sums.data_mean += w * data[k];
  }
  sums.model_mean /= sums.weight;
  sums.data_mean /= sums.weight;
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double w = weightOf(weights, k);
    const Eigen::Vector3d m = model[k] - sums.model_mean;
    const Eigen::Vector3d d = data[k] - sums.data_mean;
    sums.cross += w * m * d.transpose();
    sums.model_square += w * m.squaredNorm();
    sums.data_square += w * d.squaredNorm();
  }
  return sums;
}

// Arun, Huang and Blostein 1987: cross = U S V^T gives R = U V^T. Where that is a mirror image, turning the
// axis of the least singular value round gives the best rotation (Umeyama 1991).
Eigen::Quaterniond rotationBySvd(const Eigen::Matrix3d& cross) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& u = svd.matrixU();
  const Eigen::Matrix3d& v = svd.matrixV();
  const double guard = (u * v.transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix3d rotation = u * Eigen::Vector3d(1.0, 1.0, guard).asDiagonal() * v.transpose();
  return Eigen::Quaterniond(rotation);
}

Eigen::Vector3d mainEigenvector(const Eigen::Matrix3d& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric).eigenvectors().col(2);
}

// Horn, Hilden and Negahdaripour 1988: R = M (M^T M)^(-1/2) = sum of M u_k u_k^T / sqrt(lambda_k).
// The third term is always written as the cross product that the paper keeps for rank 2: it is the same where
// M is of full rank and positive determinant, it needs no division by a vanishing eigenvalue where the points
// lie in a plane, and where the determinant is negative (mirrored input, for which the printed formula gives
// a mirror image) it turns the weakest axis round, as the guard of the SVD does. The second axis is sought in
// what the first leaves over: M^T M squares the ratio of the axes, and a cloud a thousand times longer than
// wide would otherwise lose all but a few digits.
Eigen::Quaterniond rotationByOrthonormalMatrices(const Eigen::Matrix3d& cross) {
  const Eigen::Vector3d u1 = mainEigenvector(cross.transpose() * cross);
  const Eigen::Vector3d v1 = (cross * u1).normalized();
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d rest = (identity - v1 * v1.transpose()) * cross * (identity - u1 * u1.transpose());
  rest /= rest.norm();
  const Eigen::Vector3d u = mainEigenvector(rest.transpose() * rest);
  const Eigen::Vector3d u2 = (u - u.dot(u1) * u1).normalized();
  const Eigen::Vector3d v = rest * u2;
  const Eigen::Vector3d v2 = (v - v.dot(v1) * v1).normalized();
  const Eigen::Matrix3d rotation =
      v1 * u1.transpose() + v2 * u2.transpose() + v1.cross(v2) * u1.cross(u2).transpose();
  return Eigen::Quaterniond(rotation);
}

// Quaternions as columns (w, x, y, z).
Eigen::Quaterniond mainQuaternion(const Eigen::Matrix4d& symmetric) {
  const Eigen::Vector4d q = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(symmetric).eigenvectors().col(3);
  return {q(0), q(1), q(2), q(3)};
}

// Horn 1987: the quaternion that maximises sum model . (q data q*) is the eigenvector of the greatest
// eigenvalue. Every unit quaternion is a rotation, so planes and mirrored input need no special case.
Eigen::Quaterniond rotationByUnitQuaternion(const Eigen::Matrix3d& cross) {
  const Eigen::Matrix3d s = cross.transpose();  // Horn's S: rows for what is turned, columns for the target
  Eigen::Matrix4d n;
  const double xx = s(0, 0), yy = s(1, 1), zz = s(2, 2);
  n << xx + yy + zz, s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),  //
      s(1, 2) - s(2, 1), xx - yy - zz, s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),   //
      s(2, 0) - s(0, 2), s(0, 1) + s(1, 0), yy - xx - zz, s(1, 2) + s(2, 1),   //
      s(0, 1) - s(1, 0), s(2, 0) + s(0, 2), s(1, 2) + s(2, 1), zz - xx - yy;
  return mainQuaternion(n);
}

// p * q = leftFactor(p) q and q * p = rightFactor(p) q, for a vector p taken as a quaternion without real
// part.
Eigen::Matrix4d leftFactor(const Eigen::Vector3d& p) {
  Eigen::Matrix4d m;
  m << 0, -p.x(), -p.y(), -p.z(),  //
      p.x(), 0, -p.z(), p.y(),     //
      p.y(), p.z(), 0, -p.x(),     //
      p.z(), -p.y(), p.x(), 0;
  return m;
}
Eigen::Matrix4d rightFactor(const Eigen::Vector3d& p) {
  Eigen::Matrix4d m;
  m << 0, -p.x(), -p.y(), -p.z(),  //
      p.x(), 0, p.z(), -p.y(),     //
      p.y(), -p.z(), 0, p.x(),     //
      p.z(), p.y(), -p.x(), 0;
  return m;
}

// Walker, Shao and Volz 1991: rotation r and s = t r (t the translation) at once, from
// |m - r d r* - t| = |(Q(m) - W(d)) r - s|. The best s is linear in r, which leaves r^T A r to be maximised.
// The paper takes half vectors; the halves cancel and are left out. The points count from the first pair, not
// from the centroids (that would be the method above) and not from the frames' origins: in national
// coordinates the sums would lose their digits.
Pose motionByDualQuaternion(Points model, Points data, Weights weights) {
  const Eigen::Vector3d model_origin = model.front();
  const Eigen::Vector3d data_origin = data.front();
  double weight = 0.0;
  Eigen::Vector3d model_sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d data_sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double w = weightOf(weights, k);
    const Eigen::Vector3d m = model[k] - model_origin;
    const Eigen::Vector3d d = data[k] - data_origin;
    weight += w;
    model_sum += w * m;
    data_sum += w * d;
    products += w * m * d.transpose();
  }
  // C1 = sum w Q(m)^T W(d) and C3 = sum w (Q(m) - W(d)) of the paper, up to signs and factors; both are
  // linear in the sums, so that no 4 x 4 product is needed for each pair.
  Eigen::Matrix4d c1 = Eigen::Matrix4d::Zero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      c1 += products(a, b) *
            (leftFactor(Eigen::Vector3d::Unit(a)).transpose() * rightFactor(Eigen::Vector3d::Unit(b)));
  const Eigen::Matrix4d c3 = leftFactor(model_sum) - rightFactor(data_sum);
  const Eigen::Quaterniond r =
      mainQuaternion(c1 + c1.transpose() + c3.transpose() * c3 / weight).normalized();
  const Eigen::Vector4d s = c3 * Eigen::Vector4d(r.w(), r.x(), r.y(), r.z()) / weight;
  const Eigen::Vector3d shift = (Eigen::Quaterniond(s(0), s(1), s(2), s(3)) * r.conjugate()).vec();
  return {r, shift + model_origin - r * data_origin};
}

Status checkPairs(Points model, Points data, Weights weights) {
  if (model.size() != data.size())
    return fail(std::to_string(model.size()) + " model points but " + std::to_string(data.size()) +
                    " data points were given as pairs",
                "closed-form motion", "give one data point for every model point");
  if (!weights.empty() && weights.size() != model.size())
    return fail(
        std::to_string(weights.size()) + " weights were given for " + std::to_string(model.size()) + " pairs",
        "closed-form motion", "give one weight a pair, or none at all");
  std::size_t counted = 0;
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double w = weightOf(weights, k);
    if (!model[k].allFinite() || !data[k].allFinite() || !std::isfinite(w) || w < 0.0)
      return fail("the pair holds a coordinate that is not a number, or a weight below zero",
                  "closed-form motion, pair " + std::to_string(k), "leave such pairs out");
    if (w > 0.0) ++counted;
  }
  if (counted < 3)
    return fail("only " + std::to_string(counted) + " point pairs to compute a motion from; three are needed",
                "closed-form motion", "raise the distance bound or sample more points");
  return {};
}

// The rotation is determined when the cross-covariance has rank 2 or 3. Its norm and its cofactors' norm hold
// that ratio: about s2 / s1 of the singular values, without computing them.
Status checkSpread(const Moments& sums) {
  const double model_size = sums.model_square + sums.weight * sums.model_mean.squaredNorm();
  const double data_size = sums.data_square + sums.weight * sums.data_mean.squaredNorm();
  if (std::sqrt(sums.model_square) <= kNoSpread * std::sqrt(model_size) ||
      std::sqrt(sums.data_square) <= kNoSpread * std::sqrt(data_size))
    return fail("all paired points lie in one place, so that any rotation fits", "closed-form motion",
                "sample points that are spread over the scan");
  const double scale = std::sqrt(sums.model_square * sums.data_square);
  const Eigen::Matrix3d unit = sums.cross / scale;
  Eigen::Matrix3d cofactors;
  for (int k = 0; k < 3; ++k) cofactors.col(k) = unit.col((k + 1) % 3).cross(unit.col((k + 2) % 3));
  if (unit.norm() <= kOneLine || cofactors.norm() <= kOneLine * unit.squaredNorm())
    return fail("the paired points lie on one line, so that the rotation about it is free",
                "closed-form motion", "sample points that are spread over the scan");
  return {};
}

}  // namespace

Result<Pose> closedFormMotion(ClosedForm method, Points model, Points data, Weights weights) {
  if (const Status status = checkPairs(model, data, weights); !status) return fail(status.error());
  const Moments sums = momentsOf(model, data, weights);
  if (const Status status = checkSpread(sums); !status) return fail(status.error());

  // The scale of the sums does not matter to a rotation, but keeps the squares below in range.
  const Eigen::Matrix3d cross = sums.cross / sums.cross.norm();
  Eigen::Quaterniond rotation;
  switch (method) {
    case ClosedForm::Svd:
      rotation = rotationBySvd(cross);
      break;
    case ClosedForm::OrthonormalMatrices:
      rotation = rotationByOrthonormalMatrices(cross);
      break;
    case ClosedForm::UnitQuaternion:
      rotation = rotationByUnitQuaternion(cross);
      break;
    case ClosedForm::DualQuaternion:
      return motionByDualQuaternion(model, data, weights);
    default:
      throw std::invalid_argument("closedFormMotion: unknown method");
  }
  rotation.normalize();
  // Thesis 4.2.8 in our direction: data onto model.
  return Pose(rotation, sums.model_mean - rotation * sums.data_mean);
}

}  // namespace tiltmap
