// The list of the program's operations. A new one is declared beside its maker and added here.
#include "core/project/edit_operations.h"
#include "core/project/operation.h"

namespace tiltmap {

const OperationRegistry& operations() {
  static const OperationRegistry registry = [] {
    OperationRegistry all;
    all.add(makeRenameOperation());
    all.add(makeRebaseOperation());
    return all;
  }();
  return registry;
}

}  // namespace tiltmap
