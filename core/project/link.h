// What registration found between two stops.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

struct PairJudgement;  // core/registration/pair_judgement.h

// Stable for the life of a project, never reused. A scan's index (0, 1, ...) is its place in the order and
// may change.
using ScanId = std::int64_t;
using LinkId = std::int64_t;

enum class LinkOrigin { Odometry, Automatic, ByHand };
enum class LinkState { Active, Disabled };  // a disabled link is kept, but nothing is computed from it

const std::string& linkOriginName(LinkOrigin origin);  // "odometry", "automatic", "by-hand"
Result<LinkOrigin> parseLinkOrigin(const std::string& name);
const std::string& linkStateName(LinkState state);  // "active", "disabled"
Result<LinkState> parseLinkState(const std::string& name);

// One registered pair. A link that did not succeed records the attempt; its pose is the start it was given
// and nothing is computed from it.
struct Link {
  LinkId id = 0;  // given by the project when the link is added
  ScanId fixed = 0;
  ScanId moving = 0;
  Pose fixed_from_moving;
  int iterations = 0;
  int correspondences = 0;    // of the last iteration, after rejection
  double rms_m = 0.0;         // of those correspondences
  double overlap = 0.0;       // 0 to 1
  double milliseconds = 0.0;  // from two raw matrices in memory to the pose
  std::string stop_reason;
  bool succeeded = false;
  LinkOrigin origin = LinkOrigin::Automatic;
  LinkState state = LinkState::Active;
  // Inverse covariance of the small motion d of Pose::moved (rotation first, rad and m, in the fixed frame).
  // Not the covariance: a corridor leaves one direction without information, which has no covariance.
  std::optional<Matrix6d> information;
  // Whether it can be trusted, by its two scans at this pose; null: not judged. The project gives it only as
  // long as both scans have the measurements and the geometry that were judged.
  std::shared_ptr<const PairJudgement> judgement = nullptr;

  bool usable() const { return succeeded && state == LinkState::Active; }
};

}  // namespace tiltmap
