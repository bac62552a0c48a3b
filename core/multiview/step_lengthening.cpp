#include "core/multiview/step_lengthening.h"

#include <algorithm>

namespace tiltmap {

namespace {

constexpr double kFurthest = 6.0;

}  // namespace

void StepLengthening::lengthen(std::vector<Vector6d>& motions, double turn_arm_m) {
  const auto product = [&](const Vector6d& a, const Vector6d& b) {
    return turn_arm_m * turn_arm_m * a.head<3>().dot(b.head<3>()) + a.tail<3>().dot(b.tail<3>());
  };
  if (last_.size() == motions.size()) {
    double along = 0.0, square = 0.0;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const Vector6d change = motions[i] - last_[i];
      along += product(last_[i], change);
      square += product(change, change);
    }
    length_ = square > 0.0 ? std::clamp(-length_ * along / square, 1.0, kFurthest) : 1.0;
  } else {
    length_ = 1.0;
  }
  last_ = motions;
  for (Vector6d& motion : motions) motion *= length_;
}

}  // namespace tiltmap
