// Which elements of a scan are paired (Rusinkiewicz and Levoy 2001; thesis 4.2.4 samples uniformly).
#pragma once

#include <cstdint>
#include <vector>

#include "core/registration/registration_settings.h"
#include "core/registration/surface_elements.h"

namespace tiltmap {

// Ascending indices, each at most once, the same for the same seed: all; every sampling_step-th; a random
// share of one in sampling_step; or as many, spread evenly over the directions of the normals (elements
// without a normal never).
std::vector<std::uint32_t> sampledElements(const SurfaceElements& elements,
                                           const RegistrationSettings& settings);

}  // namespace tiltmap
