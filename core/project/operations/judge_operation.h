// Holding the scans of links against each other once more, and keeping what comes of it with the links.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// "judge": whether each link can be trusted, by its scans and by the other links. Its limits hold for what is
// shown of the project's links from then on.
std::unique_ptr<Operation> makeJudgeOperation();

}  // namespace tiltmap
