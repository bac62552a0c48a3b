#include "hardware/capture/known_rig.h"

#include <algorithm>
#include <set>

#include "core/base/text.h"
#include "core/calibration/calibration_file.h"

namespace tiltmap {

namespace {

// "LMS291;S05 at /dev/ttyUSB0, MIP 50 at /dev/ttyUSB1": plugged in again, they may have changed places.
std::string withoutPorts(const std::string& instruments) {
  std::vector<std::string> names;
  for (const std::string_view part : splitAt(instruments, ',')) {
    const std::string_view name = trimmed(part);
    names.emplace_back(name.substr(0, name.find(" at ")));
  }
  return joined(names, ", ");
}

bool sameSweep(const ScannerGeometry& a, const ScannerGeometry& b) {
  return a.rows == b.rows && a.columns == b.columns && a.azimuth_start_rad == b.azimuth_start_rad &&
         a.azimuth_step_rad == b.azimuth_step_rad && a.tilt_start_rad == b.tilt_start_rad &&
         a.tilt_step_rad == b.tilt_step_rad;
}

bool isCalibrated(const ScannerGeometry& geometry) {
  const ScannerGeometry as_built;
  return !sameCalibration(geometry, as_built) || geometry.minimum_range_m != as_built.minimum_range_m ||
         geometry.maximum_range_m != as_built.maximum_range_m;
}

// Of a scan whose lines are all there; nothing where none is masked.
Result<std::optional<CellMask>> maskOf(const ScanEntry& scan) {
  const auto image = scan.image();
  if (!image) return fail(image.error());
  std::vector<char> masked((*image)->cells());
  std::ranges::transform((*image)->data().code, masked.begin(),
                         [](CellCode code) { return static_cast<char>(code == cell_code::kMasked); });
  CellMask mask = cellMask((*image)->rows(), (*image)->columns(), masked);
  return mask.empty() ? std::optional<CellMask>() : std::optional(std::move(mask));
}

}  // namespace

Result<KnownRig> knownRig(const ProjectSnapshot& snapshot, const ScannerGeometry& sweep,
                          const std::string& instruments) {
  KnownRig rig;
  const std::string names = withoutPorts(instruments);
  // The mask goes with the geometry, of which a survey has one or two: each is looked at once.
  std::set<std::int64_t> seen;
  const auto& scans = snapshot.scans();
  for (auto scan = scans.rbegin(); scan != scans.rend() && !(rig.calibration && rig.body); ++scan) {
    if (!sameSweep(scan->geometry, sweep) || withoutPorts(scan->source) != names) continue;
    if (!rig.calibration && isCalibrated(scan->geometry)) {
      rig.calibration = scan->geometry;
      rig.calibrated_at = scan->name;
    }
    if (rig.body || scan->lines < scan->rows || !seen.insert(scan->geometry_id).second) continue;
    auto mask = maskOf(*scan);
    if (!mask) return fail(mask.error());
    if (!*mask) continue;
    rig.body = std::move(*mask);
    rig.body_at = scan->name;
  }
  return rig;
}

void takeOver(const KnownRig& rig, ScannerGeometry& geometry) {
  if (!rig.calibration) return;
  takeCalibration(*rig.calibration, geometry);
  geometry.minimum_range_m = rig.calibration->minimum_range_m;
  geometry.maximum_range_m = rig.calibration->maximum_range_m;
}

std::string knownRigText(const KnownRig& rig) {
  std::vector<std::string> parts;
  // A body that is out by its range alone is no calibration to speak of.
  if (rig.calibration)
    parts.push_back(std::string(sameCalibration(*rig.calibration, ScannerGeometry())
                                    ? "the range bounds of "
                                    : "the calibration of ") +
                    rig.calibrated_at);
  if (rig.body)
    parts.push_back("the mask of the machine's body of " + rig.body_at + " (" +
                    std::to_string(rig.body->cells()) + " cells)");
  return joined(parts, " and ");
}

}  // namespace tiltmap
