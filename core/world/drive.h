// How the stops of an experiment lie in its site: streets, terrain, poses.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/pose.h"
#include "core/world/ground.h"
#include "core/world/street_grid.h"

namespace tiltmap {

inline constexpr double kScannerHeightM = 0.9;  // mirror above the ground

struct Drive {
  StreetGrid grid;
  Terrain terrain;
  std::vector<Pose> site_from_scan;
  std::vector<Pose> odometry;  // planar, stop 0 the identity
};

// The terrain is bent so that it passes 0.8 to 1.0 m below every stop of the tables: their z jump by 9 cm
// within 21 cm in one place, which no smooth ground does, so up to 0.1 m is left to the springs. Stop 0 is
// level at the site's origin.
Drive experiment1Drive(std::uint64_t seed);
Drive experiment2Drive(std::uint64_t seed, bool mended);
// Every stop stands 0.9 m above the ground and leans with it; the odometry of each step is off by about 0.1 m
// and 1.5 deg.
Drive loopDrive(std::uint64_t seed, int stops);
Drive surveyDrive(std::uint64_t seed, int stops);

}  // namespace tiltmap
