#include "core/project/operations/body_mask_operation.h"

#include <nlohmann/json.hpp>

#include "core/base/atomic_file.h"
#include "core/base/text.h"
#include "core/calibration/body_mask.h"
#include "core/project/operations/index_list.h"

namespace tiltmap {

namespace {

struct BodyMaskOperationSettings {
  BodyMaskSettings mask;
  std::string scans;
  bool apply = false;
  std::string out;
};

const ParameterTable<BodyMaskOperationSettings>& bodyMaskTable() {
  using S = BodyMaskOperationSettings;
  static const ParameterTable<S> table = [] {
    ParameterTable<S> t("body-mask");
    t.text("scans", &S::scans, "Scans to learn from, such as 0-13 or 0,2,7; empty for all", "ours");
    t.boolean("apply", &S::apply,
              "Give these scans the minimum range found, so that nearer cells hold no points", "ours");
    t.text("out", &S::out, "File to write the mask to (JSON): the columns of each row that show the body",
           "ours");
    t.include(bodyMaskParameters(), &S::mask);
    return t;
  }();
  return table;
}

class BodyMaskOperation : public SettingsOperation<BodyMaskOperationSettings> {
 public:
  BodyMaskOperation() : SettingsOperation(bodyMaskTable()) {}
  std::string title() const override { return "Find the machine's body"; }
  std::string help() const override {
    return "Cells that are near, and at the same range in every scan, show the machine itself. Tells where "
           "they "
           "are and which minimum range keeps them out; with `apply` the scans get it, which can be undone.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot,
                       const BodyMaskOperationSettings& settings) const override {
    if (snapshot.scans().empty())
      return fail("the project has no scans", snapshot.path().string(),
                  "import, simulate or capture some first");
    return chosen(snapshot, settings).map([](const std::vector<int>&) {});
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const BodyMaskOperationSettings& settings,
                                      const JobControl& control) const override {
    const auto list = chosen(*snapshot, settings);
    if (!list) return fail(list.error());
    std::vector<RangeImagePtr> images;
    for (const int i : *list) {
      if (control.stopRequested())
        return fail(kCancelled, "body mask", "nothing was changed; start it again when you like");
      auto image = snapshot->scans()[static_cast<std::size_t>(i)].image();
      if (!image) return fail(image.error());
      images.push_back(std::move(*image));
      control.tell(static_cast<double>(images.size()) / static_cast<double>(list->size()), "reading scans");
    }
    const auto mask = learnBodyMask(images, settings.mask);
    if (!mask) return fail(mask.error());
    if (!settings.out.empty())
      if (Status status = writeFileAtomically(settings.out, bodyMaskText(*mask)); !status)
        return fail(status.error());

    OperationResult outcome;
    if (list->size() == 1)
      outcome.warnings.emplace_back(
          "learnt from one scan: whatever stood near it counts as the machine; name several from different "
          "places");
    const bool applies = settings.apply && mask->minimum_range_m > 0.0;
    if (settings.apply && !applies)
      outcome.warnings.emplace_back(
          mask->cells == 0 ? "nothing was applied: no cell shows the machine"
                           : "nothing was applied: surroundings come as near as the machine itself");
    if (applies) {
      outcome.edit.title = "minimum range " + fixedReal(mask->minimum_range_m, 2) + " m for " +
                           std::to_string(list->size()) + (list->size() == 1 ? " scan" : " scans");
      outcome.edit.base = snapshot;
      for (const int i : *list) {
        const ScanEntry& scan = snapshot->scans()[static_cast<std::size_t>(i)];
        SetGeometry step{scan.id, scan.geometry};
        step.geometry.minimum_range_m = mask->minimum_range_m;
        outcome.edit.steps.emplace_back(std::move(step));
      }
    }
    outcome.report_json = nlohmann::json{
        {"scans", list->size()},
        {"cells", mask->cells},
        {"furthest_m", mask->furthest_m},
        {"minimum_range_m", mask->minimum_range_m},
        {"applied", applies}}.dump();
    return outcome;
  }

 private:
  static Result<std::vector<int>> chosen(const ProjectSnapshot& snapshot,
                                         const BodyMaskOperationSettings& settings) {
    return parseIndexesOrAll(settings.scans, static_cast<int>(snapshot.scans().size()), "--scans");
  }
};

}  // namespace

std::unique_ptr<Operation> makeBodyMaskOperation() {
  return std::make_unique<BodyMaskOperation>();
}

}  // namespace tiltmap
