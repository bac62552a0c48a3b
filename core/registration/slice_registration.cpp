#include "core/registration/slice_registration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/registration/metric.h"
#include "core/registration/pair_choice.h"
#include "core/registration/sampling.h"
#include "core/scan/point_cloud.h"

namespace tiltmap {

namespace {

double headingOf(const Pose& pose) {
  const Eigen::Vector3d h = pose.heading();
  return std::atan2(-h.x(), h.y());  // left positive from +y
}

double turnBetween(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

std::vector<Eigen::Vector3d> sliceOf(const Scan& scan, const SliceSettings& settings) {
  std::vector<Eigen::Vector3d> slice;
  const std::vector<Eigen::Vector3d> points = cellPoints(*scan.image, scan.geometry);
  for (std::size_t cell = 0; cell < points.size(); ++cell)
    if (scan.image->hasPoint(cell) &&
        std::abs(points[cell].z() - settings.height_m) <= 0.5 * settings.thickness_m)
      slice.emplace_back(points[cell].x(), points[cell].y(), 0.0);
  return slice;
}

PreparedScan flatScan(const std::vector<Eigen::Vector3d>& slice, const RegistrationSettings& settings) {
  PreparedScan prepared;
  prepared.elements.position = slice;
  prepared.elements.normal.assign(slice.size(), Eigen::Vector3d::Zero());
  addSearch(settings, prepared);
  return prepared;
}

RegistrationSettings planarSettings(const SliceSettings& slice) {
  RegistrationSettings settings;
  settings.reduction = Reduction::None;
  settings.pair_choice = PairChoice::Nearest;
  settings.both_directions = false;
  settings.max_distance_m = slice.max_distance_m;
  settings.max_angle_rad = std::numbers::pi;
  settings.statistics = true;
  settings.statistics_distance_m = slice.good_distance_m;
  settings.motion = MotionMethod::Svd;
  settings.loss = Loss::None;
  return settings;
}

StopReason iterate(const PreparedScan& fixed, const PreparedScan& moving, const SliceSettings& slice,
                   SliceResult& result) {
  const RegistrationSettings settings = planarSettings(slice);
  const std::vector<std::uint32_t> sample = sampledElements(moving.elements, settings);
  RejectionState state;
  state.distance_bound_m = slice.max_distance_m;
  std::vector<Correspondence> pairs;
  double last = 0.0;
  for (int k = 0; k < slice.max_iterations; ++k) {
    const Pose& pose = result.fixed_from_moving;
    findPairs(fixed, moving, pose, {}, sample, 0.0, settings, state, pairs);
    SliceStep step;
    double square = 0.0;
    for (const Correspondence& pair : pairs) {
      if (!pair.kept()) continue;
      ++step.pairs;
      square +=
          (pose * moving.elements.position[pair.moving] - fixed.elements.position[pair.fixed]).squaredNorm();
    }
    if (step.pairs < static_cast<std::size_t>(slice.min_pairs)) return StopReason::TooFewPairs;
    const double error = square / static_cast<double>(step.pairs);
    const auto moved =
        closedFormStep(settings.motion, fixed.elements, moving.elements, pose, pairs, LossScale());
    if (!moved) return StopReason::Degenerate;
    // Rounding must not lift the slice out of its plane.
    const Eigen::Vector3d t = moved->translation();
    result.fixed_from_moving = Pose::planar(t.x(), t.y(), headingOf(*moved));
    step.fixed_from_moving = result.fixed_from_moving;
    step.rms_m = std::sqrt(error);
    result.steps.push_back(step);
    if (k > 0 && std::abs(error - last) <= slice.min_change * std::max(last, 1e-300))
      return StopReason::Converged;
    last = error;
  }
  return StopReason::IterationLimit;
}

}  // namespace

Result<SliceResult> registerSlices(const Scan& fixed, const Scan& moving, const Pose& start_fixed_from_moving,
                                   const SliceSettings& settings) {
  if (!start_fixed_from_moving.isFinite())
    return fail("the start pose is not finite", "slice matching", "give the pair a start of numbers");
  if (!(settings.thickness_m > 0.0) || !(settings.max_distance_m > 0.0) || !(settings.good_distance_m > 0.0))
    return fail("a slice needs a thickness and a distance bound", "slice matching",
                "give lengths above zero");
  for (const Scan* scan : {&fixed, &moving})
    if (!scan->image)
      return fail("a scan has no range matrix", scan->name, "choose a scan that was imported or captured");
  SliceResult result;
  result.fixed = sliceOf(fixed, settings);
  result.moving = sliceOf(moving, settings);
  const Eigen::Vector3d t = start_fixed_from_moving.translation();
  result.start = Pose::planar(t.x(), t.y(), headingOf(start_fixed_from_moving));
  result.fixed_from_moving = result.start;
  const RegistrationSettings planar = planarSettings(settings);
  const PreparedScan flat_fixed = flatScan(result.fixed, planar);
  const PreparedScan flat_moving = flatScan(result.moving, planar);
  result.stop_reason = iterate(flat_fixed, flat_moving, settings, result);
  return result;
}

SliceComparison compareSlice(const Pose& slice, const Pose& whole) {
  SliceComparison c;
  c.shift_m = (slice.translation() - whole.translation()).head<2>().norm();
  c.heading_rad = turnBetween(headingOf(slice), headingOf(whole));
  c.height_m = whole.translation().z();
  c.tilt_rad = std::acos(std::clamp((whole.quaternion() * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
  return c;
}

}  // namespace tiltmap
