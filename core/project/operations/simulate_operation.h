// Driving the simulated scanner through an experiment, into an empty project.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

std::unique_ptr<Operation> makeSimulateOperation();

}  // namespace tiltmap
