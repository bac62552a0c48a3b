// Plane patches of any cloud, ordered or not: cubes of space, split until each part lies in a plane.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// The points are cut into cubes of patch_size_m. Each cube's points are halved at their mean across their
// longest axis until the residual fits the noise model, at most patch_splits times. What cannot be halved any
// more, for that or for want of points (patch_min_points), is kept where it fits the wider model of rough
// surfaces, and dropped otherwise. `points` are cellPoints() of the image.
SurfaceElements cubePatches(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                            const RegistrationSettings& settings);

}  // namespace tiltmap
