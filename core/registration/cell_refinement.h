// The last word on a pair of scans: each scan's cells against the other's plane patches.
//
// Patches are paired one to one, and where two only half cover each other each plane is extrapolated to the
// other's centre; cells that made no patch do not count at all. Once the pose is known within a few
// millimetres, every cell can be given to the patch it lies on. Those on one patch are one measurement: their
// mean, right where the patch is. Ours.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/pose.h"
#include "core/registration/metric.h"
#include "core/registration/prepared_scan.h"

namespace tiltmap {

// What one scan's cells tell about one patch of the other scan.
struct CellsOnPatch {
  std::uint32_t patch = 0;
  bool of_fixed = true;  // whose patch it is; the cells are the other scan's
  double cells = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // in the frame of the cells' scan, m
  double variance_m2 = 0.0;                        // of the mean along the patch's normal
  // The patch's plane, frame of its scan: normal . p = offset.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_m = 0.0;
  double plane_variance_m2 = 0.0;  // along the normal where the mean lies at the pose
  double slope_variance = 0.0;     // of the normal, along the surface
};

// Gives the cells of each scan to the patches of the other that they lie on at the pose: within four
// deviations of the plane, inside its outline, and seen from the same side. `excess_m` is the deviation of
// surfaces beyond that of their patches. Empty where a scan
// has no cells or patches of blocks.
std::vector<CellsOnPatch> cellsOnPatches(const PreparedScan& fixed, const PreparedScan& moving,
                                         const Pose& fixed_from_moving, double excess_m,
                                         const RegistrationSettings& settings);

// Adds them up as `linearise` does pairs of patches, in the frame of the fixed scan, for a motion of the
// moving one. What both directions tell rests on the same cells: h and b are halved, so that h is an
// information.
void lineariseCells(const Pose& fixed_from_moving, const std::vector<CellsOnPatch>& cells, double excess_m,
                    double deviations, LinearSystem& system);
// The same, for who names the scans that the cells are of.
inline void lineariseCells(const PreparedScan&, const PreparedScan&, const Pose& fixed_from_moving,
                           const std::vector<CellsOnPatch>& cells, double excess_m, double deviations,
                           LinearSystem& system) {
  lineariseCells(fixed_from_moving, cells, excess_m, deviations, system);
}

struct Refined {
  Pose fixed_from_moving;
  std::size_t patches = 0;  // that cells lie on; 0: nothing to refine by, the pose is as given
  double cells = 0.0;
  LinearSystem system;  // at the pose
};

// Gives the cells to the patches once, and moves until that is settled: in all directions that are not free,
// or, `strictly`, not weak (Conditioning).
Refined refined(const PreparedScan& fixed, const PreparedScan& moving, const Pose& fixed_from_moving,
                double excess_m, const RegistrationSettings& settings, bool strictly = true);

}  // namespace tiltmap
