#include "core/multiview/misfit_pairs.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace tiltmap {

namespace {

constexpr int kAttempts = 3;
constexpr double kTryAgain_m = 0.05;  // once it has moved so far since the last attempt
constexpr double kTryAgain_rad = 0.5 * kDegree;
constexpr int kLoopLinks = 4;          // as many links or more between its ends make a loop
constexpr double kLinkError_m = 0.05;  // what each link between may have added to its error
constexpr double kLinkError_rad = 0.3 * kDegree;
constexpr double kTurnArm_m = 10.0;  // a turn counts as the shift it makes at this distance

void registerByItself(const JointLink& link, const MisfitPairs::Scene& scene, MisfitAttempt& attempt,
                      const std::stop_token& stop) {
  const RegistrationSettings& settings = scene.settings;
  Registration registration(scene.scans[static_cast<std::size_t>(link.fixed)],
                            scene.scans[static_cast<std::size_t>(link.moving)], link.fixed_from_moving,
                            settings);
  while (!registration.done()) registration.step(stop);
  ++attempt.count;
  attempt.start = link.fixed_from_moving;
  attempt.pairs = registration.keptPairs();
  attempt.rms_m = registration.rms();
  attempt.reason = *registration.stopReason();
  attempt.succeeded = false;
  if (!isSuccess(attempt.reason)) return;
  attempt.found = measureLink(link.fixed, link.moving, registration.fixedFromMoving(), scene.scans,
                              scene.samples, settings, scene.loss);
  const PoseDifference off = difference(link.fixed_from_moving, attempt.found.fixed_from_moving);
  attempt.succeeded = attempt.found.used && off.translation_m <= kLinkError_m * attempt.links_between &&
                      off.rotation_rad <= kLinkError_rad * attempt.links_between;
}

}  // namespace

const MisfitAttempt* MisfitPairs::attemptAt(const JointLink& link) const {
  const auto found = attempts_.find({link.fixed, link.moving});
  return found != attempts_.end() ? &found->second : nullptr;
}

LinkCounter MisfitPairs::counterOf(const std::vector<JointLink>& links) const {
  int scans = 0;
  for (const JointLink& link : links) scans = std::max({scans, link.fixed + 1, link.moving + 1});
  for (const auto& [a, b] : joined_) scans = std::max({scans, a + 1, b + 1});
  LinkCounter counter(static_cast<std::size_t>(scans), links);
  for (const auto& [a, b] : joined_) counter.join(a, b);
  return counter;
}

std::vector<const JointLink*> MisfitPairs::due(const std::vector<JointLink>& links) const {
  const LinkCounter counter = counterOf(links);
  std::vector<const JointLink*> list;
  for (const JointLink& link : links) {
    if (link.used || counter.linksBetween(link.fixed, link.moving) < kLoopLinks) continue;
    if (const MisfitAttempt* attempt = attemptAt(link)) {
      const PoseDifference since = difference(attempt->start, link.fixed_from_moving);
      const bool moved = since.translation_m > kTryAgain_m || since.rotation_rad > kTryAgain_rad;
      if (attempt->succeeded || !moved || attempt->count >= kAttempts) continue;
    }
    list.push_back(&link);
  }
  return list;
}

std::vector<MisfitAttempt> MisfitPairs::registered(const std::vector<const JointLink*>& due,
                                                   const std::vector<JointLink>& links, const Scene& scene,
                                                   const std::stop_token& stop) const {
  const LinkCounter counter = counterOf(links);
  std::vector<MisfitAttempt> attempts(due.size());
  parallelFor(due.size(), scene.threads, [&](std::size_t k) {
    if (const MisfitAttempt* earlier = attemptAt(*due[k])) attempts[k] = *earlier;
    attempts[k].links_between = counter.linksBetween(due[k]->fixed, due[k]->moving);
    registerByItself(*due[k], scene, attempts[k], stop);
  });
  return attempts;
}

void MisfitPairs::keep(const std::vector<const JointLink*>& due, std::vector<MisfitAttempt> attempts) {
  for (std::size_t k = 0; k < due.size(); ++k)
    attempts_[{due[k]->fixed, due[k]->moving}] = std::move(attempts[k]);
}

void MisfitPairs::addTerms(const std::vector<JointLink>& links, std::span<const Pose> world_from_scan,
                           double loss_start_m, std::vector<PairTerm>& terms) const {
  for (const JointLink& link : links) {
    const MisfitAttempt* attempt = link.used ? nullptr : attemptAt(link);
    if (!attempt || !attempt->succeeded) continue;
    const Pose present = world_from_scan[static_cast<std::size_t>(link.fixed)].inverse() *
                         world_from_scan[static_cast<std::size_t>(link.moving)];
    const PoseDifference off = difference(present, attempt->found.fixed_from_moving);
    const double distance = off.translation_m + kTurnArm_m * off.rotation_rad;
    const double weight = gemanMcClureWeight(distance * distance, loss_start_m * loss_start_m);
    terms.push_back(measuredPoseTerm(link.fixed, link.moving, present, attempt->found.fixed_from_moving,
                                     weight * attempt->found.h));
  }
}

}  // namespace tiltmap
