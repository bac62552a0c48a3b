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
  bool minimum_range = true;
  std::string out;
  std::string from;
};

const ParameterTable<BodyMaskOperationSettings>& bodyMaskTable() {
  using S = BodyMaskOperationSettings;
  static const ParameterTable<S> table = [] {
    ParameterTable<S> t("body-mask");
    t.text("scans", &S::scans, "Scans to learn from, such as 0-13 or 0,2,7; empty for all", "ours");
    t.boolean("apply", &S::apply, "Leave the cells found out of these scans from now on", "ours");
    t.boolean("minimum-range", &S::minimum_range,
              "Applied with the mask, where one was found: the minimum range that keeps the body out of the "
              "other cells as well",
              "ours");
    t.text("out", &S::out, "File to write the mask to (JSON): the columns of each row that show the body",
           "ours");
    t.text("from", &S::from, "File with a mask to give to the scans, in place of learning one", "ours");
    t.include(bodyMaskParameters(), &S::mask);
    return t;
  }();
  return table;
}

std::string scansText(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " scan" : " scans");
}

class BodyMaskOperation : public SettingsOperation<BodyMaskOperationSettings> {
 public:
  BodyMaskOperation() : SettingsOperation(bodyMaskTable()) {}
  std::string title() const override { return "Find the machine's body"; }
  std::string help() const override {
    return "Cells that are near, and at the same range in every scan, show the machine itself. Tells where "
           "they "
           "are and which minimum range keeps them out; with `apply` the scans leave them out of everything, "
           "which can be undone.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot,
                       const BodyMaskOperationSettings& settings) const override {
    if (snapshot.scans().empty())
      return fail("the project has no scans", snapshot.path().string(),
                  "import, simulate or capture some first");
    const auto scans = chosen(snapshot, settings);
    if (!scans || settings.from.empty()) return scans.map([](const std::vector<int>&) {});
    if (!settings.apply)
      return fail("a mask from a file is only of use when it is applied", "--from", "add --apply");
    if (!settings.out.empty())
      return fail("there is nothing to write when the mask comes from a file", "--out",
                  "leave --out or --from away");
    const auto mask = readBodyMask(settings.from);
    if (!mask) return fail(mask.error());
    for (const int i : *scans) {
      const ScanEntry& scan = snapshot.scans()[static_cast<std::size_t>(i)];
      if (scan.rows != mask->cells.rows || scan.columns != mask->cells.columns)
        return fail("the mask is of " + std::to_string(mask->cells.rows) + " x " +
                        std::to_string(mask->cells.columns) + " cells, and scan " + std::to_string(i) +
                        " has " + std::to_string(scan.rows) + " x " + std::to_string(scan.columns),
                    settings.from, "name scans of the scanner and sweep that the mask was learnt from");
    }
    return {};
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const BodyMaskOperationSettings& settings,
                                      const JobControl& control) const override {
    const auto list = chosen(*snapshot, settings);
    if (!list) return fail(list.error());
    OperationResult outcome;
    if (!settings.from.empty()) {
      const auto stored = readBodyMask(settings.from);
      if (!stored) return fail(stored.error());
      outcome.edit =
          edit(snapshot, *list, stored->cells, settings.minimum_range ? stored->minimum_range_m : 0);
      outcome.report_json = nlohmann::json{
          {"scans", list->size()},
          {"masked_cells", stored->cells.cells()},
          {"applied", true}}.dump();
      return outcome;
    }
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

    if (list->size() == 1)
      outcome.warnings.emplace_back(
          "learnt from one scan: whatever stood near it counts as the machine; name several from different "
          "places");
    const CellMask cells = cellsOf(*mask);
    const bool applies = settings.apply && mask->cells > 0;
    if (settings.apply && !applies)
      outcome.warnings.emplace_back(cells.empty() ? "nothing was applied: no cell shows the machine"
                                                  : "nothing was applied: the machine's cells are masked "
                                                    "already, and no others show it");
    if (applies)
      outcome.edit = edit(snapshot, *list, cells, settings.minimum_range ? mask->minimum_range_m : 0.0);
    outcome.report_json = nlohmann::json{
        {"scans", list->size()},
        {"cells", mask->cells},
        {"masked_cells", cells.cells()},
        {"furthest_m", mask->furthest_m},
        {"minimum_range_m", mask->minimum_range_m},
        {"applied", applies}}.dump();
    return outcome;
  }

 private:
  // minimum_range_m 0: the scans keep theirs.
  static ProjectEdit edit(const SnapshotPtr& snapshot, const std::vector<int>& list, const CellMask& cells,
                          double minimum_range_m) {
    ProjectEdit edit;
    edit.title =
        "leave the machine's " + std::to_string(cells.cells()) + " cells out of " + scansText(list.size());
    edit.base = snapshot;
    for (const int i : list) {
      const ScanEntry& scan = snapshot->scans()[static_cast<std::size_t>(i)];
      edit.steps.emplace_back(SetBodyMask{scan.id, cells});
      if (minimum_range_m <= 0.0) continue;
      SetGeometry step{scan.id, scan.geometry};
      step.geometry.minimum_range_m = minimum_range_m;
      edit.steps.emplace_back(std::move(step));
    }
    return edit;
  }

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
