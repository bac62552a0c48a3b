#include "core/project/operations/register_operation.h"

#include <chrono>

#include "core/project/operations/register_pairs.h"

namespace tiltmap {

namespace {

class RegisterOperation : public SettingsOperation<RegisterSettings> {
 public:
  RegisterOperation() : SettingsOperation(registerParameters()) {}
  std::string title() const override { return "Register pairs"; }
  std::string help() const override {
    return "Finds the motion between pairs of scans from their range matrices, starting from the odometry, "
           "and chains "
           "the results into the stage `pairwise`.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const RegisterSettings& settings) const override {
    return checkRegister(snapshot, settings);
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const RegisterSettings& settings,
                                      const JobControl& control) const override {
    const auto started = std::chrono::steady_clock::now();
    auto pairs = parsePairList(settings.pairs, static_cast<int>(snapshot->scans().size()));
    if (!pairs) return fail(pairs.error());
    return registerPairs(*snapshot, *pairs, settings, control)
        .map([&](const std::vector<RegisteredPair>& found) {
          const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - started;
          return registeredOutcome(snapshot, found, took.count());
        });
  }
};

}  // namespace

std::unique_ptr<Operation> makeRegisterOperation() {
  return std::make_unique<RegisterOperation>();
}

}  // namespace tiltmap
