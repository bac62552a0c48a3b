#include "core/registration/pair_judgement.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <Eigen/LU>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/registration/cell_refinement.h"
#include "core/registration/pair_choice.h"

namespace tiltmap {

namespace {

constexpr double kFitDeviations = 3.0;
constexpr double kLeastExcess_m = 0.003;  // a fit is not asked to be better than surfaces are
constexpr double kMostExcess_m = 0.015;   // nor excused by more
constexpr double kGap_m = 0.5;            // patches further apart along their planes are not the same place
// Surfaces that face the same way, less than this apart, are meant to be the same one.
constexpr double kFacing_m = 0.5;
// Nearer or further than its surroundings by less than this and a share of its range, a point is not apart.
constexpr double kMargin_m = 0.2;
constexpr double kMarginShare = 0.01;
constexpr double kNoiseFactor = 1.4;  // times what noisy normals make of a plane is taken off
constexpr std::size_t kFewest = 12;   // as RegistrationSettings::min_pairs
// Giving cells to patches anew: ends with a motion of less than this, a turn counting at so many metres.
constexpr int kMostRounds = 4;
constexpr double kAtRest_m = 1e-4;
constexpr double kLever_m = 10.0;

// How the pairs of both directions are looked for: as the last steps of a registration.
const RegistrationSettings& pairing() {
  static const RegistrationSettings settings;
  return settings;
}

std::vector<std::uint32_t> all(const SurfaceElements& elements) {
  std::vector<std::uint32_t> every(elements.size());
  std::iota(every.begin(), every.end(), 0U);
  return every;
}

// Beyond the edges of both patches, how far their centres are apart along the first one's plane.
double gapAlong(const PatchShape& a, const PatchShape& b, const Eigen::Vector3d& d_in_a) {
  constexpr double kEdge = 1.7;  // a uniform patch ends at 3^(1/2) deviations
  const double other = kEdge * std::max(b.extent_u_m, b.extent_v_m);
  const double u = std::max(0.0, std::abs(d_in_a.dot(a.u)) - kEdge * a.extent_u_m - other);
  const double v = std::max(0.0, std::abs(d_in_a.dot(a.v)) - kEdge * a.extent_v_m - other);
  return std::hypot(u, v);
}

// What became of the patches of one scan at the other.
struct Side {
  std::size_t total = 0, fits = 0, misfits = 0, through = 0;
};

struct Comparison {
  Side moving, fixed;
  std::vector<double> fitting_residuals, fitting_variances;
  LinearSystem system;  // both directions: twice the information
  Conditioning condition;
  double excess_m = 0.0;
};

Comparison compare(const JudgedScan& fixed, const JudgedScan& moving, const Pose& pose) {
  Comparison found;
  const SurfaceElements& q = fixed.patches->elements;
  const SurfaceElements& p = moving.patches->elements;
  found.moving.total = p.size();
  found.fixed.total = q.size();
  RejectionState rejection;
  std::vector<Correspondence> pairs;
  findPairs(*fixed.patches, *moving.patches, pose, all(q), all(p), 0.0, pairing(), rejection, pairs);

  // Pairs that are no common place say nothing about the fit.
  const Eigen::Matrix3d r = pose.rotation();
  const Pose back = pose.inverse();
  for (Correspondence& pair : pairs) {
    if (!pair.kept()) continue;
    const Eigen::Vector3d d = pose * p.position[pair.moving] - q.position[pair.fixed];
    const double gap = std::min(gapAlong(q.shape[pair.fixed], p.shape[pair.moving], d),
                                gapAlong(p.shape[pair.moving], q.shape[pair.fixed], r.transpose() * d));
    if (gap > kGap_m) pair.reason = RejectReason::TooFar;
  }
  Residuals residuals;
  LinearSystem plain;
  linearise(Metric::PatchToPatch, q, p, Pose(), pose, pairs, pairing(),
            LossScale::ofOwnDeviation(2.0, kMostExcess_m), plain, &residuals);
  if (!residuals.size_m.empty()) found.excess_m = excessDeviation(residuals.size_m, residuals.variance_m2);
  const double excess = std::clamp(found.excess_m, kLeastExcess_m, kMostExcess_m);
  linearise(Metric::PatchToPatch, q, p, Pose(), pose, pairs, pairing(),
            LossScale::ofOwnDeviation(2.0, excess), found.system);
  found.condition = conditioningOf(found.system, pairing().min_eigenvalue);

  std::size_t kept = 0;
  for (const Correspondence& pair : pairs) {
    Side& side = pair.from_fixed ? found.fixed : found.moving;
    if (pair.kept()) {
      const double residual = residuals.size_m[kept], variance = residuals.variance_m2[kept];
      ++kept;
      if (residual <= kFitDeviations * std::sqrt(variance + excess * excess)) {
        ++side.fits;
        found.fitting_residuals.push_back(residual);
        found.fitting_variances.push_back(variance);
        continue;
      }
      if (residual <= kFacing_m) {
        ++side.misfits;
        continue;
      }
    }
    // No surface to compare with: hidden, or of another thing, unless the other scan looked through it.
    const Eigen::Vector3d seen =
        pair.from_fixed ? back * q.position[pair.fixed] : pose * p.position[pair.moving];
    const double margin = kMargin_m + kMarginShare * seen.norm();
    if ((pair.from_fixed ? moving : fixed).seen.placeOf(seen, margin) == SeenPlace::Through) ++side.through;
  }
  return found;
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

// The information without what noisy normals make up: they let a plane look as if it held a little along
// itself. Along each direction of the conditioning so much is taken off as a plane would seem to hold.
Matrix6d heldInformation(const LinearSystem& system, const Conditioning& condition) {
  Matrix6d held = Matrix6d::Zero();
  if (!(system.plane_weight > 0.0) || condition.weak == 6) return held;
  const double made_up = kNoiseFactor * system.slope_noise / system.plane_weight;
  // Columns of `inverse`^T are the directions' duals: h = sum over k of value_k dual_k dual_k^T.
  const Matrix6d inverse = condition.directions.inverse();
  for (int k = 0; k < 6; ++k) {
    const double value = condition.eigenvalues[k] - made_up;
    if (condition.eigenvalues[k] < pairing().min_eigenvalue || value <= 0.0) continue;
    const Vector6d dual = inverse.row(k).transpose();
    held += value * system.plane_weight * dual * dual.transpose();
  }
  return held;
}

// What the scans themselves tell of the pose: its information, and the motion they still ask for. By cells
// where there are any, which know best, else by patches. A registration gives the cells to the patches once;
// where it then moved, other cells lie on other patches, and only when they have been given anew until all is
// at rest the motion is known. One step of it fell short in one pair of ten.
struct Hold {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  bool by_cells = false;
};

// The small motion of the moving scan, on the left, from one pose to the other.
Vector6d motionBetween(const Pose& from, const Pose& to) {
  const Pose motion = to * from.inverse();
  Vector6d small;
  small << rotationLog(motion.quaternion()), motion.translation();
  return small;
}

Hold holdAt(const JudgedScan& fixed, const JudgedScan& moving, const Pose& pose, const Comparison& found) {
  const double excess = std::min(found.excess_m, kMostExcess_m);
  Hold hold;
  Pose at = pose;
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    const auto cells = cellsOnPatches(*fixed.patches, *moving.patches, at, excess, pairing());
    if (cells.size() < kFewest) break;
    LinearSystem system;
    lineariseCells(*fixed.patches, *moving.patches, at, cells, excess, pairing().refine_deviations, system);
    const Conditioning condition = conditioningOf(system, pairing().min_eigenvalue);
    const Vector6d step = solvedStep(system, condition);
    const double size = step.tail<3>().norm() + kLever_m * step.head<3>().norm();
    if (size > last) break;
    hold.information = heldInformation(system, condition);
    hold.by_cells = true;
    at = at.moved(step);
    last = size;
    if (size < kAtRest_m) break;
  }
  // Both directions rest on the same surfaces: half of what they tell together.
  if (!hold.by_cells)
    return {0.5 * heldInformation(found.system, found.condition), solvedStep(found.system, found.condition)};
  hold.pull = motionBetween(pose, at);
  return hold;
}

struct Figure {
  double badness = 0.0;
  std::string reason;
};

// 1 at the good limit, 2 at the bad one, 0 at no badness at all.
double atMost(double value, double good, double bad) {
  if (value <= good) return good > 0.0 ? std::max(0.0, value / good) : 0.0;
  return 1.0 + (value - good) / std::max(bad - good, 1e-12);
}
double atLeast(double value, double good, double bad) {
  return atMost(1.0 - value, 1.0 - good, 1.0 - bad);
}

std::string percent(double share) {
  return fixedReal(100.0 * share, 0) + " %";
}

void decide(PairJudgement& j, const PairClaim& claim, const JudgementSettings& s) {
  const double doubt_only = 1.99;
  std::array<Figure, 8> figures = {
      Figure{atLeast(j.overlap(), s.overlap_good, s.overlap_bad),
             "only " + percent(j.overlap()) + " of the surfaces are common to both scans"},
      Figure{atMost(j.through, s.through_good, s.through_bad),
             percent(j.through) + " of the surfaces stand where the other scan looked through free space"},
      Figure{atLeast(j.fit, s.fit_good, s.fit_bad),
             "of what both scans could see, only " + percent(j.fit) + " lies on the other"},
      Figure{atMost(j.expected_m > 0.0 ? j.residual_m / j.expected_m : 0.0, s.residual_good, s.residual_bad),
             "the surfaces that fit are " + lengthWords(j.residual_m) + " apart, their noise explains " +
                 lengthWords(j.expected_m)},
      Figure{atMost(j.excess_m, s.excess_good_m, s.excess_bad_m),
             "the surfaces are " + lengthWords(j.excess_m) + " apart beyond their noise"},
      Figure{std::max(atMost(2.0 * j.strength.weakest_m, s.weak_good_m, s.weak_bad_m),
                      atMost(2.0 * j.strength.weakest_rad, s.weak_good_rad, s.weak_bad_rad)),
             "the pose " + j.strength_sentence},
      Figure{std::max(atMost(j.pull_m, s.pull_good_m, s.pull_bad_m),
                      atMost(j.pull_rad, s.pull_good_rad, s.pull_bad_rad)),
             "the surfaces still pull the pose " + lengthWords(j.pull_m) + " and " +
                 fixedReal(j.pull_rad / kDegree, 2) + "° elsewhere"},
      Figure{std::min(doubt_only,
                      std::max(atMost(j.moved.translation_m, s.moved_good_m, 2.0 * s.moved_good_m),
                               atMost(j.moved.rotation_rad, s.moved_good_rad, 2.0 * s.moved_good_rad))),
             "the pose is " + lengthWords(j.moved.translation_m) + " and " +
                 fixedReal(j.moved.rotation_rad / kDegree, 1) + "° from where it started"}};
  const Figure& worst = *std::ranges::max_element(figures, {}, &Figure::badness);
  j.badness = worst.badness;
  j.reason = worst.reason;
  if (!claim.succeeded) {
    j.badness = std::max(j.badness, 3.0);
    j.reason = claim.ended.empty() ? "the registration found no pose" : claim.ended;
  }
  j.verdict = j.badness <= 1.0 ? Verdict::Good : j.badness <= 2.0 ? Verdict::Doubtful : Verdict::Bad;
  if (j.verdict == Verdict::Good)
    j.reason = percent(j.fit) + " of what both scans could see fits, " + percent(j.overlap()) +
               " is common to both; " + j.strength_sentence;
}

}  // namespace

const std::string& verdictName(Verdict verdict) {
  static const std::array<std::string, 3> names = {"good", "doubtful", "bad"};
  return names.at(static_cast<std::size_t>(verdict));
}

JudgedScanPtr judgedScan(const PreparedScanPtr& prepared) {
  if (!prepared) throw std::invalid_argument("judgedScan: no scan");
  const bool fits = prepared->elements.empty() ||
                    (prepared->elements.arePatches() && (prepared->raster || prepared->directions));
  return std::make_shared<const JudgedScan>(
      JudgedScan{fits ? prepared : prepare(prepared->scan, pairing()), SeenSpace(prepared->scan)});
}

PairClaim claimOf(const PairResult& result, const Pose& start) {
  PairClaim claim;
  claim.fixed_from_moving = result.fixed_from_moving;
  claim.start = start;
  claim.succeeded = result.succeeded();
  if (!claim.succeeded)
    claim.ended = stopReasonName(result.stop_reason) + ": " + stopReasonSentence(result.stop_reason);
  return claim;
}

PairJudgement judgePair(const JudgedScan& fixed, const JudgedScan& moving, const PairClaim& claim,
                        const JudgementSettings& settings) {
  const auto begin = std::chrono::steady_clock::now();
  PairJudgement j;
  j.start = claim.start;
  j.moved = difference(claim.start, claim.fixed_from_moving);
  const auto finish = [&] {
    j.strength_sentence = strengthSentence(j.strength, settings.weak_good_m, settings.weak_good_rad);
    decide(j, claim, settings);
    j.milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    return j;
  };
  if (!claim.fixed_from_moving.isFinite()) throw std::invalid_argument("judgePair: the pose is not finite");
  j.strength = strengthOf(Matrix6d::Zero(), claim.fixed_from_moving);
  if (fixed.patches->elements.empty() || moving.patches->elements.empty()) return finish();

  const Comparison found = compare(fixed, moving, claim.fixed_from_moving);
  j.overlap_moving = share(found.moving.fits, found.moving.total);
  j.overlap_fixed = share(found.fixed.fits, found.fixed.total);
  const std::size_t fits = found.moving.fits + found.fixed.fits;
  const std::size_t through = found.moving.through + found.fixed.through;
  j.seen = fits + through + found.moving.misfits + found.fixed.misfits;
  j.fit = share(fits, j.seen);
  j.through = share(through, j.seen);
  j.excess_m = found.excess_m;
  if (fits < kFewest) return finish();
  j.residual_m = medianOf(found.fitting_residuals);
  j.expected_m = 0.6745 * std::sqrt(medianOf(found.fitting_variances));

  const Hold hold = holdAt(fixed, moving, claim.fixed_from_moving, found);
  constexpr double kLeastOverlap = 0.05;
  const double scarce =
      std::max(1.0, settings.covariance_overlap / std::max(kLeastOverlap, j.overlap()));
  const double factor = hold.by_cells ? settings.covariance_cells : settings.covariance_patches;
  j.strength = strengthOf(hold.information, claim.fixed_from_moving, scarce * factor, hold.pull);
  // Cells only see near their surfaces: patches may still pull where they do not.
  for (const Vector6d& step : {hold.pull, solvedStep(found.system, found.condition)}) {
    const PoseDifference pull = difference(claim.fixed_from_moving, claim.fixed_from_moving.moved(step));
    j.pull_m = std::max(j.pull_m, pull.translation_m);
    j.pull_rad = std::max(j.pull_rad, pull.rotation_rad);
  }
  return finish();
}

bool sameJudgement(const PairJudgement* a, const PairJudgement* b) {
  if (a == b || !a || !b) return a == b;
  return a->verdict == b->verdict && a->badness == b->badness && a->reason == b->reason &&
         a->strength.covariance == b->strength.covariance;
}

}  // namespace tiltmap
