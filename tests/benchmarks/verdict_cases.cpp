#include "tests/benchmarks/verdict_cases.h"

#include <cmath>
#include <numbers>

#include "core/base/random.h"

namespace tiltmap::benchmarks {

namespace {

Eigen::Vector3d unitVector(RandomStream& random) {
  Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
  return v.norm() > 1e-6 ? Eigen::Vector3d(v.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
}

// Off by up to so much in a random direction; scans are shifted mostly along the ground, as machines are.
Pose offBy(RandomStream& random, double least_m, double most_m, double least_rad, double most_rad) {
  const double way = random.uniform(0.0, 2.0 * std::numbers::pi);
  Eigen::Vector3d shift(std::cos(way), std::sin(way), 0.3 * random.normal());
  shift = shift.normalized() * random.uniform(least_m, most_m);
  Eigen::Vector3d axis = unitVector(random);
  if (random.uniform() < 0.5) axis = Eigen::Vector3d::UnitZ() * (random.uniform() < 0.5 ? 1.0 : -1.0);
  return Pose(rotationExp(axis * random.uniform(least_rad, most_rad)), shift);
}

// Believes what it finds: no annealing, no doubts.
RegistrationSettings credulous(bool narrow) {
  RegistrationSettings s;
  s.loss = narrow ? Loss::GemanMcClure : Loss::Annealed;
  s.loss_scale_m = 0.15;
  if (!narrow) s.loss_start_m = 0.3;
  s.min_overlap = 0.0;
  s.min_agreement = 0.0;
  s.min_eigenvalue = 1e-6;
  s.retry_agreement = 0.0;
  s.retry_deviation_m = 1e9;
  return s;
}

VerdictCase judged(const VerdictPair& pair, const std::string& kind, const PairClaim& claim,
                   const JudgementSettings& settings) {
  VerdictCase c;
  c.kind = kind;
  c.judgement = judgePair(*pair.fixed->judged, *pair.moving->judged, claim, settings);
  if (!pair.overlaps) return c;
  c.error = difference(pair.truth, claim.fixed_from_moving);
  c.rig_error = rigError(pair.truth, claim.fixed_from_moving);
  c.right = c.error.translation_m <= kRightM && c.error.rotation_rad <= kRightRad;
  c.counts = c.right || c.error.translation_m >= kWrongM || c.error.rotation_rad >= kWrongRad;
  return c;
}

}  // namespace

VerdictScan verdictScan(const Scan& scan, const RegistrationSettings& settings) {
  VerdictScan made;
  made.prepared = prepare(scan, settings);
  made.judged = judgedScan(made.prepared);
  return made;
}

Vector6d rigError(const Pose& truth, const Pose& found) {
  const Pose off = truth.inverse() * found;
  Vector6d error;
  error << rotationLog(off.quaternion()), off.translation();
  return error;
}

std::vector<VerdictCase> verdictCases(const VerdictPair& pair, int wrong_rounds,
                                      const JudgementSettings& settings) {
  std::vector<VerdictCase> cases;
  RandomStream random = RandomStream::keyed({pair.seed, 0x7e4d1c7ULL});
  if (pair.overlaps) {
    const auto result = registerPair(pair.fixed->prepared, pair.moving->prepared, pair.start, {});
    if (result) {
      VerdictCase c = judged(pair, "registered", claimOf(*result, pair.start), settings);
      // One that says itself that it failed claims nothing.
      if (!result->succeeded()) c.counts = false;
      cases.push_back(std::move(c));
    }
  }
  PairClaim claim;
  claim.start = pair.start;
  for (int round = 0; round < wrong_rounds; ++round) {
    if (pair.overlaps) {
      claim.fixed_from_moving = pair.truth * offBy(random, 0.05, 0.5, 0.3 * kDegree, 3.0 * kDegree);
      cases.push_back(judged(pair, "offset", claim, settings));
      claim.fixed_from_moving = pair.truth;
      const PairJudgement at_truth = judgePair(*pair.fixed->judged, *pair.moving->judged, claim, settings);
      const double slide = random.uniform(0.1, 2.0) * (random.uniform() < 0.5 ? 1.0 : -1.0);
      claim.fixed_from_moving =
          pair.truth * Pose(Eigen::Quaterniond::Identity(), slide * at_truth.strength.weakest);
      cases.push_back(judged(pair, "slide", claim, settings));
    }
    const RegistrationSettings believing = credulous(round % 2 == 0);
    const Pose from =
        (pair.overlaps ? pair.truth : pair.start) * offBy(random, 0.3, 4.0, 2.0 * kDegree, 25.0 * kDegree);
    Registration registration(pair.fixed->prepared, pair.moving->prepared, from, believing);
    while (!registration.done()) registration.step();
    claim.start = from;
    claim.fixed_from_moving = registration.fixedFromMoving();
    VerdictCase c = judged(pair, pair.overlaps ? "local minimum" : "no overlap", claim, settings);
    // Some find the way back: those are not wrong, and right ones are counted from the default's starts only.
    if (c.right) c.counts = false;
    cases.push_back(std::move(c));
    claim.start = pair.start;
  }
  return cases;
}

}  // namespace tiltmap::benchmarks
