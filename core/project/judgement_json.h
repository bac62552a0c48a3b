// A judgement of a link as one JSON object: for scripts, and as the project keeps it.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/project/link_quality.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

// Figures in SI beside those named _deg; shares 0 to 1; `covariance` the lower triangle by rows, of the
// moving scan's own frame (pitch, roll, heading in rad, right, forward, up in m); `start` x y z and
// quaternion x y z w.
nlohmann::json judgementJson(const PairJudgement& judgement);

// One link as `link list`, `link judge` and the operation `judge` tell it: who it joins, the verdict with its
// reason, the figures of judgementJson (null where its scans were not held against each other), what the
// other links say and how its loop closes.
nlohmann::json linkJson(const ProjectSnapshot& snapshot, const Link& link, const LinkJudgement& judgement);

// What a judgement rests on. Another pose of the link, other lines or another geometry of a scan: it does not
// stand any more.
struct JudgedOf {
  struct Scan {
    std::int64_t matrix = 0, geometry = 0;  // as ScanEntry has them
    int lines = 0;
    bool operator==(const Scan&) const = default;
  };
  Scan fixed, moving;
  Pose fixed_from_moving;
};
// JSON knows no infinity: such numbers become words that exactNumberOf reads. It throws std::invalid_argument
// or an exception of nlohmann's for what is no number.
nlohmann::json exactNumber(double value);
double exactNumberOf(const nlohmann::json& value);

// All of it, to come back bit for bit with the link's pose, infinities too; but for the milliseconds.
nlohmann::json wholeJudgement(const PairJudgement& judgement);
// Throws std::invalid_argument or an exception of nlohmann's for what is no judgement.
PairJudgement judgementOf(const nlohmann::json& whole, const Pose& fixed_from_moving);

// Throws std::invalid_argument for a figure that is not finite.
std::string storedJudgement(const PairJudgement& judgement, const JudgedOf& of);
// Null for the judgement of something else, and for what is no judgement: it can be made again.
std::shared_ptr<const PairJudgement> restoredJudgement(const std::string& stored, const JudgedOf& of);

}  // namespace tiltmap
