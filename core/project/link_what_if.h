// What the links say together, and what the others would say without some of them.
#pragma once

#include <string>
#include <vector>

#include "core/project/project_snapshot.h"

namespace tiltmap {

// How far a link is from where the links together put its two scans.
struct LinkVerdict {
  LinkId link = 0;
  bool left_out = false;
  PoseDifference before;  // with all links
  PoseDifference after;   // without those left out
  // Of a link left out: the others tie its two scans, so that `after` is what they say against it.
  bool supported = true;
};

struct LinkWhatIf {
  std::vector<LinkVerdict> links;     // the usable ones and those left out, by id
  std::vector<Pose> before, after;    // world_from_scan by index
  std::vector<PoseDifference> moved;  // by index, from before to after
  std::vector<int> separated;         // scans that only the left-out links tied to scan 0 or a pinned one
  // Root mean square of how far the links that stay are off.
  double rms_before_m = 0.0, rms_after_m = 0.0;
};

// The poses that fit all usable links best, each weighed by its information (links without one as set by
// hand: 2 cm and half a degree), once with and once without those left out; scan 0 and pinned scans stay.
// Only the links are used, no surface: quick, and a preview of what a relaxation would find, not its result.
// Error: a link is not there or is no link to compute from (it failed), or the equations cannot be solved.
Result<LinkWhatIf> whatIfWithout(const ProjectSnapshot& snapshot, const std::vector<LinkId>& left_out);

// For people: what the others say, in a sentence or two.
std::string whatIfText(const ProjectSnapshot& snapshot, const LinkWhatIf& what_if);

// What a link set by hand is worth where it does not say: inverse covariance, rad^-2 and m^-2.
Matrix6d informationByHand();

}  // namespace tiltmap
