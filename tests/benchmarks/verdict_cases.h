// Right and wrong registrations to judge, each with what is known about it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/registration/pair_judgement.h"

namespace tiltmap::benchmarks {

// Off the truth by less than these a registration is right; by more than the second ones it is wrong; in
// between it is neither, and is not counted.
inline constexpr double kRightM = 0.02, kRightRad = 0.2 * kDegree;
inline constexpr double kWrongM = 0.05, kWrongRad = 0.3 * kDegree;

struct VerdictScan {
  PreparedScanPtr prepared;
  JudgedScanPtr judged;
};
VerdictScan verdictScan(const Scan& scan, const RegistrationSettings& settings = {});

// Two scans, how they truly lie, and where a registration of them starts.
struct VerdictPair {
  const VerdictScan* fixed = nullptr;
  const VerdictScan* moving = nullptr;
  Pose truth;  // fixed_from_moving
  Pose start;
  bool overlaps = true;    // where not, there is no truth and every pose is wrong
  std::uint64_t seed = 1;  // of what is planted
};

struct VerdictCase {
  std::string kind;  // "registered", "offset", "slide", "local minimum", "no overlap"
  bool right = false;
  bool counts = true;  // neither right nor wrong: not
  PoseDifference error;
  Vector6d rig_error = Vector6d::Zero();  // of the pose, as PoseStrength::covariance has it
  PairJudgement judgement;
};

// The pair registered by the preset `default` from its start, and judged; then wrong alignments of it: the
// true pose off by 0.05 to 0.5 m and 0.3 to 3 deg, slid along its weakest direction by 0.1 to 2 m, and where
// registrations end that are told to believe whatever they find, from starts 0.3 to 4 m and 2 to 25 deg off.
// Wrong ones claim to have succeeded. `wrong_rounds`: of each kind.
std::vector<VerdictCase> verdictCases(const VerdictPair& pair, int wrong_rounds,
                                      const JudgementSettings& settings = {});

// A pose of the moving scan against the truth, in the moving scan's frame: rotation vector, then shift.
Vector6d rigError(const Pose& truth, const Pose& found);

}  // namespace tiltmap::benchmarks
