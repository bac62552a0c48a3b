// Everything registration derives from one scan, made once and shared.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/registration/cell_samples.h"
#include "core/registration/direction_index.h"
#include "core/registration/patch_raster.h"
#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"
#include "core/scan/kd_tree.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// A patch in the form that is looked at most often, one a cache line. Scan frame, m; see PatchShape.
struct alignas(64) PatchDisc {
  float x = 0.0F, y = 0.0F, z = 0.0F, nx = 0.0F, ny = 0.0F, nz = 0.0F;
  float ux = 0.0F, uy = 0.0F, uz = 0.0F, vx = 0.0F, vy = 0.0F, vz = 0.0F;
  float reach_u = 0.0F, reach_v = 0.0F;  // from the centre to the edge
  float offset_variance = 0.0F;          // m^2
};

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
