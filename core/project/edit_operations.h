// Operations that are no more than an edit.
#pragma once

#include <memory>

#include "core/project/operation.h"

namespace tiltmap {

std::unique_ptr<Operation> makeRenameOperation();  // "rename": --scan INDEX --name TEXT
std::unique_ptr<Operation>
makeRebaseOperation();  // "rebase": --scan INDEX stands at the origin, looking along +y

}  // namespace tiltmap
