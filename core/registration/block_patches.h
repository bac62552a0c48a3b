// Plane patches of a range matrix: the largest blocks of cells that are planar.
#pragma once

#include "core/registration/cell_samples.h"
#include "core/registration/patch_raster.h"
#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"
#include "core/scan/range_image.h"

namespace tiltmap {

struct BlockPatches {
  SurfaceElements elements;
  PatchRaster raster;
  double spot_rad = 0.0;  // of the light that the patches were set back by
  CellSamples cells;      // that took part, for refinement; empty where that is not asked for
};

// Tiles of patch_rows x patch_columns cells are added up in twos to ever larger blocks (a pyramid of
// moments); from the largest down, a block that fits the noise model and is no larger than patch_block_m is
// one patch, any other is looked at by its four parts. A tile that does not fit is kept where it fits the
// wider model of rough surfaces. `image` must be a matrix.
BlockPatches blockPatches(const RangeImage& image, const ScannerGeometry& geometry,
                          const RegistrationSettings& settings);

}  // namespace tiltmap
