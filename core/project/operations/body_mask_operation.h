// Learning where the machine's own body stands in its scans, and keeping it out of them.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// "body-mask". With `apply` the scans named get the minimum range that keeps the body out (their geometry's;
// stored ranges stay), which can be undone.
std::unique_ptr<Operation> makeBodyMaskOperation();

}  // namespace tiltmap
