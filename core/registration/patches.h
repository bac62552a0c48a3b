// Plane patches of one scan: groups of neighbouring points, split until each lies in a plane.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// A matrix is cut into blocks of patch_rows x patch_columns cells, after cells on edges are dropped; an
// unordered cloud into cubes of patch_size_m. Each group is halved at its mean across its longest axis until
// its residual fits the noise model, at most patch_splits times, each half with at least patch_min_points;
// what still does not fit is dropped. `points` are cellPoints() of the image; normals point to the scanner.
SurfaceElements planePatches(const RangeImage& image, const ScannerGeometry& geometry,
                             const std::vector<Eigen::Vector3d>& points,
                             const RegistrationSettings& settings);

}  // namespace tiltmap
