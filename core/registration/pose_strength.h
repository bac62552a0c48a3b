// How firmly the surfaces hold a scan in each of its six directions, in the frame of the machine that took
// it.
#pragma once

#include <string>

#include "core/geometry/pose.h"

namespace tiltmap {

// Standard deviations of where the moving scan stands on the fixed one, in the moving scan's own frame: x
// right, y forward, z up; pitch turns about x, roll about y, heading about z.
struct PoseStrength {
  // Rotation (pitch, roll, heading; rad) first, then translation (right, forward, up; m): of the small motion
  // of the moving scan in its own frame.
  Matrix6d covariance = Matrix6d::Zero();
  double pitch_rad = 0.0, roll_rad = 0.0, heading_rad = 0.0;
  double right_m = 0.0, forward_m = 0.0, up_m = 0.0;
  double weakest_m = 0.0;  // the largest deviation of the place over all directions
  Eigen::Vector3d weakest = Eigen::Vector3d::Zero();  // that direction, unit, moving scan's frame
  double weakest_rad = 0.0;                           // the largest deviation of a turn
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();     // about this axis
};

// Nothing is known worse than this: stands for a direction that the surfaces leave free.
inline constexpr double kFree_m = 10.0;
inline constexpr double kFree_rad = 1.0;

// `information`: inverse covariance of the small motion of Pose::moved in the fixed frame (rotation first,
// rad^-2 and m^-2), as a registration gives it; `factor` multiplies the covariance. All zero: everything is
// free. `pull`: a small motion of the same kind that the surfaces still ask for; the pose is at least so far
// off, so its square counts as well.
PoseStrength strengthOf(const Matrix6d& information, const Pose& fixed_from_moving, double factor = 1.0,
                        const Vector6d& pull = Vector6d::Zero());

// The same figures of a covariance in the moving scan's own frame, as PoseStrength has it.
PoseStrength strengthOfCovariance(const Matrix6d& rig_covariance);
// Takes a small motion of Pose::moved in the fixed frame to what it does to the moving scan, in that scan's
// own frame: rotation vector and shift.
Matrix6d rigFromFixed(const Pose& fixed_from_moving);

// In a sentence, with two deviations: "held everywhere: forward within 4 mm, heading within 0.01 deg" or "can
// slide 12 cm along 30 deg left of ahead" where the weakest direction is worse than the bounds.
std::string strengthSentence(const PoseStrength& strength, double weak_m, double weak_rad);
// "ahead and back", "sideways", "up and down", "30 deg left of ahead"; direction in the machine's frame.
std::string directionWords(const Eigen::Vector3d& direction);
// "12 cm", "4 mm", "3.2 m".
std::string lengthWords(double metres);
std::string angleWords(double radians);  // "0.004°", "0.12°", "3.4°"

}  // namespace tiltmap
