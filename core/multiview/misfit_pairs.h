// Pairs of scans whose surfaces do not fit yet, such as the two ends of a loop: registered by themselves,
// verified, and then pulling as measured poses.
#pragma once

#include <map>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "core/multiview/joint_links.h"
#include "core/multiview/link_counter.h"
#include "core/multiview/pose_system.h"
#include "core/registration/registration.h"

namespace tiltmap {

// A pair registered by itself, from the poses it had then.
struct MisfitAttempt {
  int count = 0;
  int links_between = 0;  // the shortest way round, when it was made
  Pose start;
  bool succeeded = false;
  std::size_t pairs = 0;
  double rms_m = 0.0;
  StopReason reason = StopReason::TooFewPairs;
  JointLink found;  // at the pose found
};

// A value: a copy continues with the same bits.
class MisfitPairs {
 public:
  // What a registration needs, besides the links.
  struct Scene {
    std::span<const PreparedScanPtr> scans;
    const Samples& samples;
    const RegistrationSettings& settings;
    LossScale loss;  // at which a found pose is verified
    int threads = 0;
  };

  // Two scans that a link joins which is not among those that are measured.
  void joined(int a, int b) { joined_.emplace_back(a, b); }
  // The links whose turn it is: not used, four links or more apart, and not tried in vain from here already.
  std::vector<const JointLink*> due(const std::vector<JointLink>& links) const;
  // Registers them, each by itself. What was found counts where it fits and lies no further from the present
  // pose than the links between the two may have added up to. The attempts, in the order of `due`.
  std::vector<MisfitAttempt> registered(const std::vector<const JointLink*>& due,
                                        const std::vector<JointLink>& links, const Scene& scene,
                                        const std::stop_token& stop) const;
  void keep(const std::vector<const JointLink*>& due, std::vector<MisfitAttempt> attempts);

  // The terms of those that were found, of links that still do not fit. The further off, the less they pull:
  // one that no other link supports must not bend the rest.
  void addTerms(const std::vector<JointLink>& links, std::span<const Pose> world_from_scan,
                double loss_start_m, std::vector<PairTerm>& terms) const;

 private:
  const MisfitAttempt* attemptAt(const JointLink& link) const;
  LinkCounter counterOf(const std::vector<JointLink>& links) const;

  std::vector<std::pair<int, int>> joined_;
  std::map<std::pair<int, int>, MisfitAttempt> attempts_;
};

}  // namespace tiltmap
