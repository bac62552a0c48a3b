// What a joint relaxation says about its scans and links.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/multiview/joint_links.h"
#include "core/multiview/misfit_pairs.h"
#include "core/multiview/relaxation.h"

namespace tiltmap {

// An event a pair that was registered by itself.
void reportAttempts(const std::vector<const JointLink*>& of, const std::vector<MisfitAttempt>& attempts,
                    RelaxationStep& report);

// An event a scan that may move, and a warning that names those that went further than max-correction.
void reportMovement(const std::vector<Pose>& starts, const std::vector<Pose>& poses,
                    const std::vector<char>& pinned, const RegistrationSettings& settings,
                    RelaxationStep& report, std::vector<std::string>& warnings);

// Neighbours in time should fit: where they do not, a start is wrong or they saw too little in common. An
// event and a warning each, but for those that were excluded.
void reportDropped(int scans, const std::vector<JointLink>& links,
                   const std::function<bool(int fixed, int moving)>& is_excluded, RelaxationStep& report,
                   std::vector<std::string>& warnings);

}  // namespace tiltmap
