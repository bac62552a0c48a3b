// Everything registration derives from one scan, made once and shared.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/registration/cell_samples.h"
#include "core/registration/direction_index.h"
#include "core/registration/patch_disc.h"
#include "core/registration/patch_raster.h"
#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"
#include "core/scan/kd_tree.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// Immutable. Holds what the settings' components ask for: the tree for the pair choices that search one, the
// directions for the projective one. Empty elements are possible (a scan without a point) and mean no
// information.
struct PreparedScan {
  Scan scan;  // what it was made from; without an image where it was put together from others
  SurfaceElements elements;
  std::optional<KdTree> tree;                // over element positions; absent where empty or not asked for
  std::optional<DirectionIndex> directions;  // likewise
  std::optional<DirectionIndex> wide_directions;  // the same in larger buckets, for the first steps
  std::optional<PatchRaster> raster;              // instead of both, for patches made of a matrix
  std::vector<PatchDisc> discs;                   // with a raster: one an element
  CellSamples cells;                              // likewise: the cells, for refinement, as measured
  double spot_rad = 0.0;                          // of their light (patch_spot_rad); the patches are set back
  std::size_t raw_points = 0;                     // cells with a point before the filter
  std::size_t filter_changes = 0;                 // cells the filter changed
  double milliseconds = 0.0;
  std::vector<std::string> warnings;
};
using PreparedScanPtr = std::shared_ptr<const PreparedScan>;

// Adds what the pair choice finds the elements by: the directions for the projective one (unless there is a
// raster), the tree for the others. Nothing where there are no elements.
void addSearch(const RegistrationSettings& settings, PreparedScan& prepared);

// Filter, normals, reduction or patches, and the search structure, in that order. Throws
// std::invalid_argument where checkSettings refuses the settings.
PreparedScanPtr prepare(const Scan& scan, const RegistrationSettings& settings);

}  // namespace tiltmap
