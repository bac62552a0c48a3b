#include "core/multiview/sweep_registration.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace tiltmap {

namespace {

// How the lines so far are judged: a partial scan may be held less well than a whole one.
JudgementSettings judgementOf(const SweepSettings& settings) {
  JudgementSettings judgement;
  judgement.weak_good_m = settings.most_weak_m;
  judgement.weak_good_rad = settings.most_weak_rad;
  judgement.overlap_good = settings.least_overlap;
  return judgement;
}

}  // namespace

struct SweepRegistration::Found {
  std::size_t stop = 0;
  Pose world_from_scan;
  PairJudgement judgement;
};

SweepRegistration::SweepRegistration(std::shared_ptr<const StopMap> map, const Pose& odometry,
                                     const SweepSettings& settings)
    : map_(std::move(map)), odometry_(odometry), settings_(settings) {
  if (!map_) throw std::invalid_argument("SweepRegistration: no map");
  if (!odometry.isFinite()) throw std::invalid_argument("SweepRegistration: the odometry is not finite");
  estimate_.world_from_scan = odometry;
  estimate_.sentence = map_->empty() ? "the first stop: nothing to register to" : "not yet: no lines";
}

std::optional<SweepRegistration::Found> SweepRegistration::registered(std::size_t stop,
                                                                      const PreparedScanPtr& moving,
                                                                      const JudgedScanPtr& judged) const {
  const MapStop& fixed = (*map_)[stop];
  RegistrationSettings settings = map_->settings();
  // From a pose that was held there is nothing to search for.
  if (!estimate_.from_odometry && settings.loss == Loss::Annealed)
    settings.loss_start_m = std::clamp(0.5, settings.loss_end_m, settings.loss_start_m);
  const Pose start = fixed.world_from_scan.inverse() * estimate_.world_from_scan;
  Registration registration(fixed.prepared, moving, start, settings);
  while (!registration.done()) registration.step();
  PairClaim claim;
  claim.fixed_from_moving = registration.fixedFromMoving();
  claim.start = start;
  claim.succeeded = isSuccess(*registration.stopReason());
  if (!claim.succeeded) claim.ended = stopReasonName(*registration.stopReason());
  Found found;
  found.stop = stop;
  found.world_from_scan = fixed.world_from_scan * claim.fixed_from_moving;
  found.judgement = judgePair(*fixed.judged, *judged, claim, judgementOf(settings_));
  return found;
}

void SweepRegistration::conclude(const std::vector<Found>& found) {
  estimate_.sure = false;
  const Found* best = nullptr;
  for (const Found& one : found)
    if (!best || one.judgement.badness < best->judgement.badness) best = &one;
  if (!best) return;
  estimate_.judgement = best->judgement;
  estimate_.neighbour = best->stop;
  estimate_.overlap = best->judgement.overlap_moving;
  estimate_.deviation_m = best->judgement.strength.weakest_m;
  estimate_.deviation_rad = best->judgement.strength.weakest_rad;
  if (best->judgement.verdict != Verdict::Good) {
    estimate_.sentence = "not yet: " + best->judgement.reason;
    return;
  }
  for (const Found& other : found) {
    if (other.judgement.verdict != Verdict::Good) continue;
    const PoseDifference apart = difference(best->world_from_scan, other.world_from_scan);
    if (apart.translation_m <= settings_.most_apart_m && apart.rotation_rad <= settings_.most_apart_rad)
      continue;
    estimate_.sentence = "not yet: two stops put the scan " + lengthWords(apart.translation_m) + " apart";
    return;
  }
  estimate_.sure = true;
  estimate_.from_odometry = false;
  estimate_.world_from_scan = best->world_from_scan;
  estimate_.sentence = "in place within " + lengthWords(2.0 * estimate_.deviation_m);
}

const SweepEstimate& SweepRegistration::update(const Scan& so_far) {
  const auto begin = std::chrono::steady_clock::now();
  if (!so_far.image) throw std::invalid_argument("SweepRegistration::update: the scan has no range image");
  const int lines = so_far.image->scannedLines();
  if (map_->empty()) {
    estimate_.lines = lines;
    return estimate_;
  }
  if (lines < settings_.first_lines) {
    estimate_.lines = lines;
    estimate_.sentence = "not yet: " + std::to_string(lines) + " lines";
    return estimate_;
  }
  std::vector<Found> found;
  PreparedScanPtr prepared[2];
  JudgedScanPtr judged[2];
  for (const std::size_t stop :
       map_->neighbours(estimate_.world_from_scan.translation(),
                        static_cast<std::size_t>(settings_.neighbours), settings_.within_m)) {
    // Cut as the stop is: the first lines see only near ground, and would be cut into cubes.
    const bool blocks = (*map_)[stop].prepared->raster.has_value();
    if (!prepared[blocks]) {
      RegistrationSettings settings = map_->settings();
      if (settings.patch_grouping == PatchGrouping::Auto)
        settings.patch_grouping = blocks ? PatchGrouping::Blocks : PatchGrouping::Cubes;
      prepared[blocks] = prepare(so_far, settings);
      judged[blocks] = judgedScan(prepared[blocks]);
    }
    if (auto one = registered(stop, prepared[blocks], judged[blocks])) found.push_back(std::move(*one));
  }
  estimate_.lines = lines;
  conclude(found);
  estimate_.moved = difference(odometry_, estimate_.world_from_scan);
  estimate_.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return estimate_;
}

}  // namespace tiltmap
