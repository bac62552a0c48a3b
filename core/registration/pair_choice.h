// Who is paired with whom. Four choices behind one function, so that another can be put beside them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose.h"
#include "core/registration/prepared_scan.h"
#include "core/registration/rejection.h"

namespace tiltmap {

// Appends one correspondence for each index of `sample` (elements of `from`): the partner among `to`'s
// elements that the settings' pair choice finds at the pose, or the reason NoPartner. `from_is_fixed` tells
// which of the two is the fixed scan. `to` must have been prepared for the pair choice. The projective choice
// looks in a wider field while `loss_scale_m` is above wide_search_above_m.
void choosePairs(const PreparedScan& from, const PreparedScan& to, const Pose& to_from_from,
                 std::span<const std::uint32_t> sample, bool from_is_fixed, double loss_scale_m,
                 const RegistrationSettings& settings, std::vector<Correspondence>& pairs);

// Both directions where the settings ask for them at this loss scale (0: no loss), rejection applied: what
// one step of a registration uses, and what a solver over many scans asks for each of its pairs of scans.
// Replaces `pairs`; returns the counts by reason.
RejectionCounts findPairs(const PreparedScan& fixed, const PreparedScan& moving,
                          const Pose& fixed_from_moving, std::span<const std::uint32_t> fixed_sample,
                          std::span<const std::uint32_t> moving_sample, double loss_scale_m,
                          const RegistrationSettings& settings, RejectionState& state,
                          std::vector<Correspondence>& pairs);

}  // namespace tiltmap
