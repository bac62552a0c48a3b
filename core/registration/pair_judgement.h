// Whether the registration of a pair of scans can be trusted: its figures, and a verdict with the reason.
//
// The scans are held against each other anew at the pose, whoever found it. Three questions decide. Do the
// surfaces that both scans could see lie on each other? Does one scan's surface stand where the other looked
// through (a wrong minimum fits many surfaces, but not the empty space)? And is the pose held in every
// direction, and at rest? Ours; the free-space cue after the visibility constraints of Pulli 1999.
#pragma once

#include <memory>
#include <string>

#include "core/registration/judgement_settings.h"
#include "core/registration/pose_strength.h"
#include "core/registration/prepared_scan.h"
#include "core/registration/register_pair.h"
#include "core/registration/seen_space.h"

namespace tiltmap {

enum class Verdict { Good, Doubtful, Bad };
const std::string& verdictName(Verdict verdict);  // "good", "doubtful", "bad"

// One scan with what judging needs of it, made once and shared between pairs and threads.
struct JudgedScan {
  PreparedScanPtr patches;  // plane patches and what finds them by direction
  SeenSpace seen;
};
using JudgedScanPtr = std::shared_ptr<const JudgedScan>;
// From a scan as prepared for a registration; cut into patches anew where that was done by points.
JudgedScanPtr judgedScan(const PreparedScanPtr& prepared);

// What a registration claims of a pair.
struct PairClaim {
  Pose fixed_from_moving;
  Pose start;             // where it began
  bool succeeded = true;  // it said so itself
  std::string ended;      // where not: how it ended, in words
};
PairClaim claimOf(const PairResult& result, const Pose& start);

struct PairJudgement {
  Verdict verdict = Verdict::Bad;
  std::string reason;  // one sentence, of the figure that decided
  // How far the worst figure is out: up to 1 good, up to 2 doubtful, beyond bad.
  double badness = 0.0;

  // Shares, 0 to 1, of plane patches.
  double overlap_moving = 0.0;  // of all of the moving scan's: lie on the fixed one
  double overlap_fixed = 0.0;   // the other way round
  double fit = 0.0;             // of those of both that the other could see: lie on it
  double through = 0.0;         // of the same: stand where the other looked through
  std::size_t seen = 0;         // how many those are

  double residual_m = 0.0;  // median distance of the surfaces along the normal
  double expected_m = 0.0;  // what the patches' own noise makes of it
  double excess_m = 0.0;    // deviation beyond that noise

  PoseStrength strength;
  std::string strength_sentence;  // "can slide 12 cm along 30 deg left of ahead"
  // Where the surfaces still pull the moving scan to, from the pose.
  double pull_m = 0.0, pull_rad = 0.0;
  Pose start;            // where the registration began, as it claims
  PoseDifference moved;  // from there
  double milliseconds = 0.0;

  double overlap() const { return overlap_moving < overlap_fixed ? overlap_fixed : overlap_moving; }
};

PairJudgement judgePair(const JudgedScan& fixed, const JudgedScan& moving, const PairClaim& claim,
                        const JudgementSettings& settings = {});

// By what tells two of them apart; a missing one is like a missing one.
bool sameJudgement(const PairJudgement* a, const PairJudgement* b);

}  // namespace tiltmap
