#include "core/registration/heading_search.h"

#include <algorithm>
#include <chrono>
#include <vector>

namespace tiltmap {

namespace {

constexpr int kHeadings = 12;
// Good results nearer to each other are the same place, one of them perhaps not quite reached: what looks alike
// (corners, bays) lies further apart.
constexpr double kSamePlace_m = 0.25;
constexpr double kSamePlace_rad = 3.0 * kDegree;
// Another place leaves doubt where as large a share of the best one's surfaces is common to both scans there:
// a corner of a room fits many a corner.
constexpr double kRival = 0.5;

// The pose alone, wherever it lies from its start.
PairJudgement judgedAtRest(const JudgedScan& fixed, const JudgedScan& moving, const PairResult& result) {
  return judgePair(fixed, moving, claimOf(result, result.fixed_from_moving));
}

struct Found {
  PairResult result;
  double overlap = 0.0;
};

bool samePlace(const Pose& a, const Pose& b) {
  const PoseDifference off = difference(a, b);
  return off.translation_m < kSamePlace_m && off.rotation_rad < kSamePlace_rad;
}

}  // namespace

Result<SearchedPair> registerAndSearch(const PreparedScanPtr& fixed, const PreparedScanPtr& moving,
                                       const JudgedScan& judged_fixed, const JudgedScan& judged_moving,
                                       const Pose& start_fixed_from_moving,
                                       const RegistrationSettings& settings, const JobControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  auto given = registerPair(fixed, moving, start_fixed_from_moving, settings, control);
  if (!given) return fail(given.error());
  SearchedPair found;
  found.result = std::move(*given);
  found.judgement = judgePair(judged_fixed, judged_moving, claimOf(found.result, start_fixed_from_moving));
  if (found.judgement.verdict != Verdict::Bad || settings.retry_agreement <= 0.0) return found;

  found.searched = true;
  RegistrationSettings once = settings;
  once.retry_agreement = 0.0;  // each heading is tried here
  std::vector<Found> good;
  int tried = 0;
  for (int k = 1; k < kHeadings; ++k) {
    const double turned = 360.0 * kDegree * k / kHeadings;
    auto result =
        registerPair(fixed, moving, start_fixed_from_moving * Pose::planar(0.0, 0.0, turned), once, control);
    if (!result) return fail(result.error());
    ++tried;
    if (!result->succeeded()) continue;
    const PairJudgement judgement = judgedAtRest(judged_fixed, judged_moving, *result);
    if (judgement.verdict == Verdict::Good) good.push_back({std::move(*result), judgement.overlap()});
  }
  const Found* best = nullptr;
  for (const Found& one : good)
    if (!best || one.overlap > best->overlap) best = &one;
  const bool one_place = std::ranges::all_of(good, [&](const Found& one) {
    return one.overlap < kRival * best->overlap ||
           samePlace(one.result.fixed_from_moving, best->result.fixed_from_moving);
  });
  const int retries = found.result.retries + tried;
  if (best && one_place) {
    found.result = best->result;
    found.judgement = judgePair(judged_fixed, judged_moving, claimOf(found.result, start_fixed_from_moving));
  }
  found.result.retries = retries;
  found.result.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return found;
}

}  // namespace tiltmap
