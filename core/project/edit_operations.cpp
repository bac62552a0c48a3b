#include "core/project/edit_operations.h"

namespace tiltmap {

namespace {

struct RenameSettings {
  int scan = 0;
  std::string name;
};

const ParameterTable<RenameSettings>& renameTable() {
  static const ParameterTable<RenameSettings> table = [] {
    ParameterTable<RenameSettings> t("rename");
    t.integer("scan", &RenameSettings::scan, "", 0, 1e6, "Index of the stop.", "ours");
    t.text("name", &RenameSettings::name, "The new name; two stops may have the same.", "ours");
    return t;
  }();
  return table;
}

class RenameOperation : public SettingsOperation<RenameSettings> {
 public:
  RenameOperation() : SettingsOperation(renameTable()) {}
  std::string title() const override { return "Rename a stop"; }
  std::string help() const override { return "Gives a stop another name."; }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const RenameSettings& settings) const override {
    if (settings.name.empty()) return fail("the new name is empty", "--name", "give a name");
    return snapshot.scanAt(settings.scan).map([](const ScanEntry*) {});
  }
  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const RenameSettings& settings,
                                      const JobControl&) const override {
    return snapshot->scanAt(settings.scan).map([&](const ScanEntry* scan) {
      return OperationResult{renameEdit(scan->id, settings.name), {}, {}};
    });
  }
};

struct RebaseSettings {
  int scan = 0;
};

const ParameterTable<RebaseSettings>& rebaseTable() {
  static const ParameterTable<RebaseSettings> table = [] {
    ParameterTable<RebaseSettings> t("rebase");
    t.integer("scan", &RebaseSettings::scan, "", 0, 1e6, "Index of the stop that becomes the world's origin.",
              "thesis 5.1.5");
    return t;
  }();
  return table;
}

class RebaseOperation : public SettingsOperation<RebaseSettings> {
 public:
  RebaseOperation() : SettingsOperation(rebaseTable()) {}
  std::string title() const override { return "Re-base the map"; }
  std::string help() const override {
    return "Moves the poses of every stage as a rigid whole so that one stop stands at the origin and looks "
           "along +y.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const RebaseSettings& settings) const override {
    return snapshot.scanAt(settings.scan).map([](const ScanEntry*) {});
  }
  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const RebaseSettings& settings,
                                      const JobControl&) const override {
    return snapshot->scanAt(settings.scan)
        .and_then([&](const ScanEntry* scan) { return rebaseEdit(snapshot, scan->id, Pose()); })
        .map([](ProjectEdit edit) {
          return OperationResult{std::move(edit), {}, {}};
        });
  }
};

}  // namespace

std::unique_ptr<Operation> makeRenameOperation() {
  return std::make_unique<RenameOperation>();
}
std::unique_ptr<Operation> makeRebaseOperation() {
  return std::make_unique<RebaseOperation>();
}

}  // namespace tiltmap
