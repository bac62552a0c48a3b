// Writing a project's map for other programs.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

// Changes nothing in the project; the file is written beside its place and renamed when complete.
std::unique_ptr<Operation> makeExportOperation();

}  // namespace tiltmap
