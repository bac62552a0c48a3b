// The surface pairs of many pairs of scans, measured and linearised at the present poses.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/multiview/relaxation.h"
#include "core/registration/cell_refinement.h"
#include "core/registration/metric.h"

namespace tiltmap {

// One pair of scans at one step.
struct JointLink {
  int fixed = 0;  // the lower index
  int moving = 0;
  Pose fixed_from_moving;
  std::size_t pairs = 0;
  double overlap = 0.0;    // as Registration::overlap
  double agreement = 0.0;  // as Registration::agreement
  double rms_m = 0.0;
  double loss_weight = 0.0;
  double median_m = 0.0;  // of the kept pairs' residuals
  double excess_m = 0.0;  // deviation that the patches do not account for (excessDeviation)
  int weak = 6;           // directions the surfaces leave free (Conditioning)
  // Information form of the step, over the directions that are not weak; h in rad^-2 and m^-2.
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  bool used = false;  // enough pairs, overlap and agreement
};

// Elements of each scan that are paired.
using Samples = std::vector<std::vector<std::uint32_t>>;

// One pair of scans at a relative pose.
JointLink measureLink(int fixed, int moving, const Pose& fixed_from_moving,
                      std::span<const PreparedScanPtr> scans, const Samples& samples,
                      const RegistrationSettings& settings, const LossScale& loss);

// Which cells of one pair of scans lie on which patches, and where that was found out.
struct LinkCells {
  Pose fixed_from_moving;
  std::vector<CellsOnPatch> cells;
};

// The same link told by its cells, at a relative pose not far from that of its patches (cell_refinement.h).
// The cells are given to the patches once, and anew where the pose has moved by millimetres since. As it was
// where too few cells lie on patches.
void refineLink(JointLink& link, LinkCells& found, const Pose& fixed_from_moving,
                std::span<const PreparedScanPtr> scans, const RegistrationSettings& settings,
                const LossScale& loss);

// Finds the pairs of elements of each candidate at the poses and linearises them with the loss. Shared
// among the threads, each link in its own slot: the same bits for any number of them.
std::vector<JointLink> measureLinks(std::span<const std::pair<int, int>> candidates,
                                    std::span<const PreparedScanPtr> scans, const Samples& samples,
                                    std::span<const Pose> world_from_scan,
                                    const RegistrationSettings& settings, const LossScale& loss, int threads,
                                    const std::stop_token& stop);

// How well these surfaces fit where they do: the median residual of the better links, which stands at a
// quarter of all used links' pairs (links of little overlap hold wrong pairs, which widen theirs). 0 where
// none is used.
double ownResidual(std::span<const JointLink> links);

// The same of their excess deviations.
double ownExcess(std::span<const JointLink> links);

}  // namespace tiltmap
