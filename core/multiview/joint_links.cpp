#include "core/multiview/joint_links.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/base/parallel.h"
#include "core/base/ranks.h"
#include "core/registration/pair_choice.h"

namespace tiltmap {

namespace {

// Cells are given to patches anew once a pair of scans has moved by more.
constexpr double kAnew_m = 0.002;
constexpr double kAnew_rad = 2e-4;

// The value that stands at a quarter of the pairs of all used links; 0 where none is used.
double lowerQuarter(std::span<const JointLink> links, double JointLink::*value) {
  std::vector<std::pair<double, std::size_t>> values;
  std::size_t total = 0;
  for (const JointLink& link : links) {
    if (!link.used) continue;
    values.emplace_back(link.*value, link.pairs);
    total += link.pairs;
  }
  std::ranges::sort(values);
  std::size_t passed = 0;
  for (const auto& [of_link, pairs] : values) {
    passed += pairs;
    if (4 * passed >= total) return of_link;
  }
  return 0.0;
}

// h and b without the directions that the surfaces leave free: noise there must not pull.
void takeStrongDirections(const LinearSystem& system, const Conditioning& condition, JointLink& link) {
  link.weak = condition.weak;
  if (condition.weak == 0) {
    link.h = system.h;
    link.b = system.b;
    return;
  }
  link.h.setZero();
  link.b.setZero();
  if (condition.weak == 6) return;
  // Columns of `inverse`^T are the directions' duals: h = sum over k of value_k dual_k dual_k^T.
  const Matrix6d inverse = condition.directions.inverse();
  for (int k = condition.weak; k < 6; ++k) {
    const Vector6d dual = inverse.row(k).transpose();
    link.h += condition.eigenvalues[k] * system.plane_weight * dual * dual.transpose();
    link.b += condition.directions.col(k).dot(system.b) * dual;
  }
}

}  // namespace

JointLink measureLink(int fixed, int moving, const Pose& fixed_from_moving,
                      std::span<const PreparedScanPtr> scans, const Samples& samples,
                      const RegistrationSettings& settings, const LossScale& loss) {
  const auto first = static_cast<std::size_t>(fixed), second = static_cast<std::size_t>(moving);
  JointLink link;
  link.fixed = fixed;
  link.moving = moving;
  link.fixed_from_moving = fixed_from_moving;

  RejectionState rejection;
  rejection.distance_bound_m = settings.max_distance_m;
  std::vector<Correspondence> pairs;
  const RejectionCounts counts =
      findPairs(*scans[first], *scans[second], link.fixed_from_moving, samples[first], samples[second],
                loss.scale_m, settings, rejection, pairs);
  link.pairs = counts[static_cast<std::size_t>(RejectReason::None)];
  if (link.pairs < static_cast<std::size_t>(settings.min_pairs)) return link;

  const Metric metric = metricOf(settings.motion, settings.reduction == Reduction::Patches);
  LinearSystem system;
  Residuals residuals;
  linearise(metric, scans[first]->elements, scans[second]->elements, Pose(), link.fixed_from_moving, pairs,
            settings, loss, system, &residuals);
  link.loss_weight = system.loss_weight;
  const double square = system.loss_weight > 0.0 ? system.loss_square_m2 / system.loss_weight : 0.0;
  link.rms_m = std::sqrt(square);
  link.median_m = residuals.size_m.empty() ? 0.0 : medianOf(residuals.size_m);
  if (metric == Metric::PatchToPatch)
    link.excess_m = excessDeviation(residuals.size_m, residuals.variance_m2);
  std::size_t common = 0;
  for (const Correspondence& pair : pairs)
    if (!pair.from_fixed && pair.reason != RejectReason::NoPartner) ++common;
  link.overlap = common > 0 ? static_cast<double>(system.agreeing_moving) / static_cast<double>(common) : 0.0;
  link.agreement =
      static_cast<double>(system.agreeing) / static_cast<double>(std::max<std::size_t>(system.pairs, 1));
  takeStrongDirections(system, conditioningOf(system, settings.min_eigenvalue), link);
  if (metric != Metric::PatchToPatch) {
    // Unit weights become an information through the residuals' own variance.
    const double variance = std::max(square, settings.loss_minimum_m * settings.loss_minimum_m);
    link.h /= variance;
    link.b /= variance;
  }
  link.used =
      link.weak < 6 && link.overlap >= settings.min_overlap && link.agreement >= settings.min_agreement;
  return link;
}

void refineLink(JointLink& link, LinkCells& found, const Pose& fixed_from_moving,
                std::span<const PreparedScanPtr> scans, const RegistrationSettings& settings,
                const LossScale& loss) {
  const PreparedScan& fixed = *scans[static_cast<std::size_t>(link.fixed)];
  const PreparedScan& moving = *scans[static_cast<std::size_t>(link.moving)];
  const PoseDifference moved = difference(found.fixed_from_moving, fixed_from_moving);
  if (found.cells.empty() || moved.translation_m > kAnew_m || moved.rotation_rad > kAnew_rad)
    found = {fixed_from_moving, cellsOnPatches(fixed, moving, fixed_from_moving, loss.scale_m, settings)};
  if (found.cells.size() < static_cast<std::size_t>(settings.min_pairs)) return;
  LinearSystem system;
  lineariseCells(fixed_from_moving, found.cells, loss.scale_m, settings.refine_deviations, system);
  link.fixed_from_moving = fixed_from_moving;
  takeStrongDirections(system, conditioningOf(system, settings.min_eigenvalue), link);
}

std::vector<JointLink> measureLinks(std::span<const std::pair<int, int>> candidates,
                                    std::span<const PreparedScanPtr> scans, const Samples& samples,
                                    std::span<const Pose> world_from_scan,
                                    const RegistrationSettings& settings, const LossScale& loss, int threads,
                                    const std::stop_token& stop) {
  std::vector<JointLink> links(candidates.size());
  parallelFor(candidates.size(), threads, [&](std::size_t k) {
    if (stop.stop_requested()) return;
    const auto [fixed, moving] = candidates[k];
    const Pose relative = world_from_scan[static_cast<std::size_t>(fixed)].inverse() *
                          world_from_scan[static_cast<std::size_t>(moving)];
    links[k] = measureLink(fixed, moving, relative, scans, samples, settings, loss);
  });
  return links;
}

double ownResidual(std::span<const JointLink> links) {
  return lowerQuarter(links, &JointLink::median_m);
}

double ownExcess(std::span<const JointLink> links) {
  return lowerQuarter(links, &JointLink::excess_m);
}

}  // namespace tiltmap
