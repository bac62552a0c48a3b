// Spreading what the pairs' errors added up to over all scans (thesis chapter 6).
#pragma once

#include <memory>

#include "core/project/operation.h"
#include "core/project/operations/relaxation_feed.h"

namespace tiltmap {

// The stop reason of a link that a relaxation found, not a registration of its own.
inline constexpr const char* kFoundByRelaxation = "relaxed";

// Starts from the stage `pairwise`; where there is none, every scan is registered to the one before it first
// (a warning says so), in the same edit. Its edit holds the stage `relaxed`, a pose a scan, and a link of
// origin automatic for each overlapping pair of scans that none of its own joins; those of an earlier
// relaxation are replaced. Links set by hand pull as they stand; links found by registration do where the
// surfaces give none now, but for those between scans that are no neighbours in time and that contradict the
// others, which are left out and named (link_consistency.h); pairs whose link is disabled are left out. Its
// report has `milliseconds`, `moved` (scan, translation_m, rotation_deg), `unlinked`, `warnings`, and the
// record: `events`, `links`, `steps`, `rms_m`, `method`, `registered_first`, `pins`, `prepared` (scans).
// Scans pinned in the project never move, nor do those that the parameter `pin` names.
//
// Where only scans have come since the last relaxation (addedSinceRelaxation), these alone (the report's
// `added`) are registered and put onto the others (relax_increment.h); links that do not concern them stay.
//
// A run tells the feed, where there is one, and waits while that is paused; an operation with a feed is for
// one run. What it computes is the same bits.
std::unique_ptr<Operation> makeRelaxOperation(std::shared_ptr<RelaxationFeed> feed = nullptr);

}  // namespace tiltmap
