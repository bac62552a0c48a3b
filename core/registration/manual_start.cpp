#include "core/registration/manual_start.h"

#include <cmath>
#include <numbers>

#include "core/registration/closed_form_motion.h"
#include "core/registration/metric.h"
#include "core/registration/pair_choice.h"
#include "core/registration/sampling.h"

namespace tiltmap {

Result<PointPairFit> fitPointPairs(std::span<const Eigen::Vector3d> fixed,
                                   std::span<const Eigen::Vector3d> moving) {
  if (fixed.size() != moving.size() || fixed.size() < 3)
    return fail("three pairs of points are needed, there are " +
                    std::to_string(std::min(fixed.size(), moving.size())),
                "point pairs", "pick the same places in both scans, three or more, not on one line");
  const auto found = closedFormMotion(ClosedForm::Svd, fixed, moving);
  if (!found)
    return fail("the picked points do not determine a motion: " + found.error().what, "point pairs",
                "pick points that do not lie on one line");
  PointPairFit fit;
  fit.fixed_from_moving = *found;
  double square = 0.0;
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    fit.residual_m.push_back((fit.fixed_from_moving * moving[i] - fixed[i]).norm());
    square += fit.residual_m.back() * fit.residual_m.back();
  }
  fit.rms_m = std::sqrt(square / static_cast<double>(fixed.size()));
  return fit;
}

Pose turnedStart(const Pose& start_fixed_from_moving, double turned_rad) {
  return start_fixed_from_moving * Pose::planar(0.0, 0.0, turned_rad);
}

namespace {

// Patches know how far a residual may be off; points agree within half a metre.
double scoreAt(const PreparedScan& fixed, const PreparedScan& moving, const Pose& pose,
               const std::vector<std::uint32_t>& sample, const RegistrationSettings& settings,
               double fitting_m) {
  RejectionState state;
  state.distance_bound_m = settings.max_distance_m;
  std::vector<Correspondence> pairs;
  RegistrationSettings one_way = settings;
  one_way.both_directions = false;
  one_way.statistics = false;  // its bound follows the distances, so that every heading would look alike
  findPairs(fixed, moving, pose, {}, sample, fitting_m, one_way, state, pairs);
  LinearSystem system;
  linearise(metricOf(settings.motion, settings.reduction == Reduction::Patches), fixed.elements,
            moving.elements, Pose(), pose, pairs, one_way, LossScale(fitting_m), system);
  return static_cast<double>(system.agreeing_moving) / static_cast<double>(sample.size());
}

// Level ground looks the same from every heading: what stands up tells them apart.
std::vector<std::uint32_t> standing(const std::vector<std::uint32_t>& sample, const SurfaceElements& elements,
                                    const Pose& start) {
  constexpr double kLevelCos = 0.8;
  const Eigen::Vector3d up = start.quaternion().inverse() * Eigen::Vector3d::UnitZ();
  std::vector<std::uint32_t> chosen;
  for (const std::uint32_t i : sample)
    if (std::abs(elements.normal[i].dot(up)) < kLevelCos) chosen.push_back(i);
  return chosen.empty() ? sample : chosen;
}

}  // namespace

Result<HeadingSweep> sweepHeadings(const PreparedScan& fixed, const PreparedScan& moving,
                                   const Pose& start_fixed_from_moving, const RegistrationSettings& settings,
                                   const HeadingSweepSettings& sweep, const JobControl& control) {
  if (!start_fixed_from_moving.isFinite())
    return fail("the start pose is not finite", "heading sweep", "give the pair a start of numbers");
  if (!(sweep.step_rad >= 0.1 * kDegree && sweep.step_rad <= 90.0 * kDegree))
    return fail("the step of the sweep is out of 0.1 to 90 degrees", "heading sweep", "give 3, say");
  const std::vector<std::uint32_t> sample =
      standing(sampledElements(moving.elements, settings), moving.elements, start_fixed_from_moving);
  if (sample.empty() || fixed.elements.empty())
    return fail("one of the two scans holds nothing to compare", "heading sweep", "choose other scans");
  HeadingSweep result;
  const int half = static_cast<int>(std::floor(std::numbers::pi / sweep.step_rad + 1e-9));
  result.step_rad = sweep.step_rad;
  for (int k = -half; k <= half; ++k) {
    if (control.stopRequested()) return fail(kCancelled, "heading sweep", "start it again when you like");
    const double turned = k * sweep.step_rad;
    result.scores.push_back({turned, scoreAt(fixed, moving, turnedStart(start_fixed_from_moving, turned),
                                             sample, settings, sweep.fitting_m)});
    control.tell(static_cast<double>(k + half) / (2.0 * half), "trying headings");
  }
  result.best = static_cast<std::size_t>(half);
  for (std::size_t i = 0; i < result.scores.size(); ++i) {
    const HeadingScore &one = result.scores[i], &best = result.bestScore();
    if (one.score > best.score ||
        (one.score == best.score && std::abs(one.turned_rad) < std::abs(best.turned_rad)))
      result.best = i;
  }
  return result;
}

}  // namespace tiltmap
