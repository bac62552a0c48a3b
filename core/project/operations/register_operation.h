// Registering pairs of a project's scans and chaining the results (thesis chapters 4 and 5).
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// Starts each pair from the odometry. Its edit holds a link a pair and the stage `pairwise`: every scan
// chained to the one before it by their link, or by its odometry where there is no usable one (a warning).
std::unique_ptr<Operation> makeRegisterOperation();

}  // namespace tiltmap
