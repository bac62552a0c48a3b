// The list of the program's operations. A new one is declared beside its maker and added here.
#include "core/project/edit_operations.h"
#include "core/project/operation.h"
#include "core/project/operations/body_mask_operation.h"
#include "core/project/operations/calibrate_operation.h"
#include "core/project/operations/export_operation.h"
#include "core/project/operations/import_operation.h"
#include "core/project/operations/judge_operation.h"
#include "core/project/operations/link_operation.h"
#include "core/project/operations/merge_operation.h"
#include "core/project/operations/register_operation.h"
#include "core/project/operations/relax_operation.h"
#include "core/project/operations/simulate_operation.h"

namespace tiltmap {

namespace {

OperationRegistry& registered() {
  static OperationRegistry registry = [] {
    OperationRegistry all;
    all.add(makeSimulateOperation());
    all.add(makeImportOperation());
    all.add(makeRegisterOperation());
    all.add(makeLinkOperation());
    all.add(makeJudgeOperation());
    all.add(makeRelaxOperation());
    all.add(makeCalibrateOperation());
    all.add(makeBodyMaskOperation());
    all.add(makeExportOperation());
    all.add(makeRenameOperation());
    all.add(makeRebaseOperation());
    all.add(makeMergeOperation());
    return all;
  }();
  return registry;
}

}  // namespace

const OperationRegistry& operations() {
  return registered();
}

void addOperation(std::unique_ptr<Operation> operation) {
  registered().add(std::move(operation));
}

}  // namespace tiltmap
