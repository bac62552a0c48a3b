// Plane patches of one scan: groups of neighbouring points, split until each lies in a plane.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// The points are cut into cubes of patch_size_m or, of a matrix and where asked, into blocks of patch_rows x
// patch_columns cells. Each group is halved at its mean across its longest axis until its residual fits the
// noise model, at most patch_splits times. What cannot be halved any more, for that or for want of points
// (patch_min_points), is kept where it fits the wider model of rough surfaces, and dropped otherwise.
// `points` are cellPoints() of the image; normals point to the scanner.
SurfaceElements planePatches(const RangeImage& image, const ScannerGeometry& geometry,
                             const std::vector<Eigen::Vector3d>& points,
                             const RegistrationSettings& settings);

}  // namespace tiltmap
