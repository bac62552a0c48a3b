// The rigid motion that brings paired points together, in closed form (thesis 4.2.5).
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

// Four solutions of the same least-squares problem, as compared by Lorusso, Eggert and Fisher (1995).
enum class ClosedForm {
  Svd,                  // Arun, Huang, Blostein 1987, with the determinant guard (Umeyama 1991)
  OrthonormalMatrices,  // Horn, Hilden, Negahdaripour 1988
  UnitQuaternion,       // Horn 1987
  DualQuaternion,       // Walker, Shao, Volz 1991
};

// model_from_data minimising sum |model[k] - model_from_data * data[k]|^2 (metres). Equations 4.2.6 to 4.2.8
// as printed carry the model onto the data; this is the direction the algorithm needs. `weights` is empty or
// one non-negative number a pair. Always a rotation, also for planar and reflected input: of mirrored pairs
// all four give the best proper rotation (where several are equally good, such as for the mirrored corners of
// a cube, one of them). Error: sizes differ, fewer than three pairs of positive weight, a coordinate or
// weight that is not finite, a negative weight, points on one line or all in one place (the rotation is then
// free).
Result<Pose> closedFormMotion(ClosedForm method, std::span<const Eigen::Vector3d> model,
                              std::span<const Eigen::Vector3d> data, std::span<const double> weights = {});

}  // namespace tiltmap
