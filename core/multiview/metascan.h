// Several scans as one: the union of their elements, for registering another scan onto it.
#pragma once

#include <functional>
#include <span>
#include <stop_token>

#include "core/multiview/relaxation.h"
#include "core/registration/registration.h"

namespace tiltmap {

// The elements of the named scans at their poses, in the frame `world_from_frame` (metres), with the search
// structure that the settings' pair choice asks for. Give the frame of the scan that will be registered: the
// projective choice then looks along its beams. Elements keep the normals they have, so those of a wall seen
// from both sides stay apart.
PreparedScanPtr metascan(std::span<const PreparedScanPtr> scans, std::span<const Pose> world_from_scan,
                         std::span<const int> members, const Pose& world_from_frame,
                         const RegistrationSettings& settings);

// How a registration onto a metascan ended: the new pose where it may be used, else the start. `each` is told
// before the first iteration and after every one.
struct MetascanAlignment {
  Pose world_from_scan;
  PoseDifference moved;
  std::size_t pairs = 0;
  double rms_m = 0.0;
  StopReason reason = StopReason::TooFewPairs;
};
MetascanAlignment alignToMetascan(std::span<const PreparedScanPtr> scans,
                                  std::span<const Pose> world_from_scan, std::span<const int> members,
                                  int scan, const Pose& start_world_from_scan,
                                  const RegistrationSettings& settings, const std::stop_token& stop,
                                  const std::function<void(const Registration&)>& each = {});

}  // namespace tiltmap
