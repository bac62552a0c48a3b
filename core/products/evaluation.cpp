#include "core/products/evaluation.h"

#include <cmath>

namespace tiltmap {

Result<TrajectoryEvaluation> evaluateTrajectory(const std::vector<Pose>& estimated,
                                                const std::vector<Pose>& truth) {
  if (estimated.size() != truth.size())
    return fail("there are " + std::to_string(estimated.size()) + " poses but " +
                    std::to_string(truth.size()) + " true ones",
                "evaluation", "compare with the truth of the same stops, one pose a stop");
  if (truth.size() < 2)
    return fail("there is nothing to compare: the first stop is the world, and there is no other",
                "evaluation", "evaluate a survey of two stops or more");
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (!estimated[i].isFinite() || !truth[i].isFinite())
      return fail("a pose holds a value that is not a number", "evaluation, stop " + std::to_string(i),
                  "correct the pose of this stop");

  const std::vector<Pose> from_first = rebased(estimated);
  const std::vector<Pose> true_from_first = rebased(truth);
  TrajectoryEvaluation evaluation;
  double translation_square = 0.0;
  double rotation_square = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const PoseDifference d = difference(from_first[i], true_from_first[i]);
    const StopError stop{i, d.translation_m, d.rotation_rad / kDegree};
    evaluation.stops.push_back(stop);
    translation_square += stop.translation_error_m * stop.translation_error_m;
    rotation_square += stop.rotation_error_deg * stop.rotation_error_deg;
  }
  const double counted = static_cast<double>(truth.size() - 1);
  evaluation.rmse_translation_m = std::sqrt(translation_square / counted);
  evaluation.rmse_rotation_deg = std::sqrt(rotation_square / counted);
  return evaluation;
}

}  // namespace tiltmap
