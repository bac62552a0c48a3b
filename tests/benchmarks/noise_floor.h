// How well any method could do on simulated scans: the bound of Cramer and Rao from the site's true surfaces.
#pragma once

#include <vector>

#include "core/world/experiment.h"

namespace tiltmap::benchmarks {

// Root mean square errors of the best unbiased estimate.
struct NoiseFloor {
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

// Each cell tells the distance to the surface that the axis of its beam truly strikes, with the simulator's
// range noise and steps; along the surface's normal that is the range's deviation times the cosine of
// incidence, and 1 mm more that no surface is smoother than. Cells count where the surface is flat between
// their neighbours, the range was measured on it, and another scan sees the same surface in its own cells.
// The surfaces themselves are taken as known, so that each scan's pose has the covariance of its own cells
// and a pose between two scans the sum of both: what no program, which must find the surfaces in the same
// noise, quite reaches.

// Of the pose between each two neighbours (i, i + 1); only what both see counts.
std::vector<NoiseFloor> pairFloors(const Experiment& experiment, const std::vector<SimulatedStop>& stops);
// Of each stop but the first against the first, from what any other stop of the drive sees too.
std::vector<NoiseFloor> driveFloors(const Experiment& experiment, const std::vector<SimulatedStop>& stops);

}  // namespace tiltmap::benchmarks
