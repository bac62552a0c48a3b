#include "core/project/link_system.h"

namespace tiltmap {

namespace {

// As the relaxation: nothing beside what links tell, but a direction that nothing determines stays.
constexpr double kDamping = 1.0;
constexpr int kSteps = 100;
constexpr double kAtRest = 1e-7;  // m and rad

Pose presentPose(const LinkTie& tie, const std::vector<Pose>& poses) {
  return poses[static_cast<std::size_t>(tie.fixed)].inverse() * poses[static_cast<std::size_t>(tie.moving)];
}

}  // namespace

PoseDifference offOf(const LinkTie& tie, const std::vector<Pose>& world_from_scan) {
  return difference(presentPose(tie, world_from_scan), tie.link->fixed_from_moving);
}

std::vector<PairTerm> termsOf(const std::vector<LinkTie>& ties, const std::vector<Pose>& world_from_scan) {
  std::vector<PairTerm> terms;
  for (const LinkTie& tie : ties)
    terms.push_back(measuredPoseTerm(tie.fixed, tie.moving, presentPose(tie, world_from_scan),
                                     tie.link->fixed_from_moving, tie.information));
  return terms;
}

Result<TiedPoses> solveTies(const std::vector<LinkTie>& ties, std::vector<Pose> poses,
                            const std::vector<char>& held_first) {
  TiedPoses solution;
  solution.tied = tiedToHeld(poses.size(), held_first, termsOf(ties, poses));
  std::vector<char> held = held_first;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (!solution.tied[i]) held[i] = 1;
  for (int step = 0; step < kSteps; ++step) {
    const auto motions = solvePoses(poses.size(), held, termsOf(ties, poses), kDamping);
    if (!motions) return fail(motions.error());
    double largest = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (held[i]) continue;
      poses[i] = poses[i] * Pose().moved((*motions)[i]);
      largest = std::max(largest, (*motions)[i].cwiseAbs().maxCoeff());
    }
    if (largest < kAtRest) break;
  }
  for (const Pose& pose : poses)
    if (!pose.isFinite())
      return fail("the links contradict each other too much to be solved together", "links",
                  "disable the worst one first");
  solution.world_from_scan = std::move(poses);
  return solution;
}

std::string linkPairName(const ProjectSnapshot& snapshot, const Link& link) {
  return std::to_string(snapshot.indexOf(link.fixed).value_or(0)) + " – " +
         std::to_string(snapshot.indexOf(link.moving).value_or(0));
}

}  // namespace tiltmap
