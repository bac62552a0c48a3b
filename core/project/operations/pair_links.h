// What a project keeps of registered pairs: the link of each, and the poses chained from them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/project/project_edit.h"
#include "core/registration/register_pair.h"

namespace tiltmap {

// fixed_from_moving by odometry: where registering starts.
Pose odometryStart(const ScanEntry& fixed, const ScanEntry& moving);

// `milliseconds`: from the two raw matrices to the pose.
Link pairLink(ScanId fixed, ScanId moving, const PairResult& result, double milliseconds);

// The link with what judging its pair at its pose gave.
Link judgedLink(Link link, const PairJudgement& judgement);

// The links, and the stage `pairwise`: every scan chained to the one before it by its link (one of these,
// else one that the project has), or by its odometry where there is no usable one.
ProjectEdit pairLinksEdit(const SnapshotPtr& snapshot, std::vector<Link> links);

// One pair that a person stepped through and accepts: the link, the poses and the job record that
// `register --pairs FIXED:MOVING` would store. From a start that a person set it is a link by hand, which
// takes the place of any other between the two scans and which registering again leaves alone; the record
// then tells the start. `values` and `preset` are those of the operation `register`. Throws
// std::invalid_argument for a result that did not succeed or scans that are not there.
struct SteppedPair {
  ScanId fixed = 0;
  ScanId moving = 0;
  PairResult result;
  bool start_by_hand = false;
  Pose start;  // the one given, before retries
  std::string preset = "default";
  ParameterValues values;
  std::string started;  // UTC, as utcNow()
  std::shared_ptr<const PairJudgement> judgement = nullptr;  // of the result; null: not judged
};
ProjectEdit steppedPairEdit(const SnapshotPtr& snapshot, const SteppedPair& pair);

}  // namespace tiltmap
