// Learning where the machine's own body stands in its scans, and keeping it out of them.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// "body-mask". With `apply` the cells found are left out of the scans named (cell_code::kMasked) and, where
// one keeps the body out, the scans get its minimum range; stored ranges stay, and all of it can be undone.
std::unique_ptr<Operation> makeBodyMaskOperation();

}  // namespace tiltmap
