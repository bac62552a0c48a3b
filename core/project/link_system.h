// Links as ties between the scans' places in the order, and the poses that fit them best.
#pragma once

#include <vector>

#include "core/multiview/pose_system.h"
#include "core/project/project_snapshot.h"

namespace tiltmap {

struct LinkTie {
  const Link* link = nullptr;  // of a snapshot that outlives it
  int fixed = 0, moving = 0;   // by index
  Matrix6d information =
      Matrix6d::Zero();  // inverse covariance, as Link::information; zero: only asked about
};

struct TiedPoses {
  std::vector<Pose> world_from_scan;
  std::vector<char> tied;  // to a held one; others keep their pose
};

// How far a tie's own pose is from where these put its two scans.
PoseDifference offOf(const LinkTie& tie, const std::vector<Pose>& world_from_scan);
std::vector<PairTerm> termsOf(const std::vector<LinkTie>& ties, const std::vector<Pose>& world_from_scan);
// From these poses, by Gauss-Newton steps; `held` ones stay. Error: the equations cannot be solved.
Result<TiedPoses> solveTies(const std::vector<LinkTie>& ties, std::vector<Pose> world_from_scan,
                            const std::vector<char>& held);

// "4 – 7": a link's scans by index.
std::string linkPairName(const ProjectSnapshot& snapshot, const Link& link);

}  // namespace tiltmap
