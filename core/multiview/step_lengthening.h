// How much longer than solved the steps of many poses are made.
#pragma once

#include <vector>

#include "core/geometry/pose.h"

namespace tiltmap {

// With a loss, and pairs of elements chosen anew, a step falls short by about the same share each time, and
// where a long drive sways that share is nearly all. How the last two steps differ tells it (Irons and Tuck
// 1969, Aitken's extrapolation for vectors).
class StepLengthening {
 public:
  // Motions as solved (rotation, translation; a turn counts as the shift it makes `turn_arm_m` away), made
  // longer in place.
  void lengthen(std::vector<Vector6d>& motions, double turn_arm_m);
  // Another problem begins: the next step is as solved.
  void restart() { last_.clear(); }

 private:
  std::vector<Vector6d> last_;  // as solved, before it was lengthened
  double length_ = 1.0;         // of the last step
};

}  // namespace tiltmap
