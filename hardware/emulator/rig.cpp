#include "hardware/emulator/rig.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace tiltmap {

namespace {

// A tilt within this of a row's is that row's.
constexpr double kRowRad = 0.001;

}  // namespace

RigView::RigView(Experiment experiment, const RigSettings& settings)
    : experiment_(std::move(experiment)),
      start_rad_(settings.start_rad),
      step_rad_(settings.step_rad),
      beam_(settings.beam) {
  moveTo(0);
}

void RigView::moveTo(int stop) {
  if (stop < 0 || stop >= experiment_.stops()) throw std::out_of_range("RigView::moveTo: no such stop");
  stop_ = stop;
  site_ = experiment_.siteAt(stop);
}

RandomStream RigView::noise(double tilt_rad) const {
  const double row = std::round((tilt_rad - start_rad_) / step_rad_);
  const bool of_row = row >= 0.0 && std::abs(start_rad_ + row * step_rad_ - tilt_rad) < kRowRad;
  // Between rows: something of its own for every thousandth of a degree or so.
  const auto place = of_row
                         ? static_cast<std::uint64_t>(row)
                         : static_cast<std::uint64_t>(std::llround((tilt_rad + 10.0) * 1e5)) + (1ULL << 40);
  return RandomStream::keyed({experiment_.seed(), static_cast<std::uint64_t>(experiment_.id()),
                              static_cast<std::uint64_t>(stop_), place});
}

std::vector<Echo> RigView::line(const ScannerGeometry& geometry, const TiltFunction& tilt,
                                double start_time_s, std::uint64_t) {
  return castLine(*site_, experiment_.siteFromScan(stop_), geometry, tilt, start_time_s,
                  noise(tilt(start_time_s)), beam_);
}

std::vector<Echo> RigView::truth(const ScannerGeometry& geometry, double tilt_rad) const {
  return castLine(
      *site_, experiment_.siteFromScan(stop_), geometry, [tilt_rad](double) { return tilt_rad; }, 0.0,
      noise(tilt_rad), beam_);
}

namespace {

std::unique_ptr<EmulatedTilt> makeTilt(Clock& clock, DeviceWire& wire, const RigSettings& settings) {
  if (settings.tilt_model == TiltModel::Epos)
    return std::make_unique<EposEmulator>(clock, wire, settings.epos);
  return std::make_unique<Mip50Emulator>(clock, wire, settings.tilt);
}

std::unique_ptr<EmulatedScanner> makeScanner(Clock& clock, SiteView& view, const RigSettings& settings) {
  if (settings.scanner_model == ScannerModel::Cola)
    return std::make_unique<ColaEmulator>(clock, view, settings.cola);
  if (settings.scanner_model == ScannerModel::Scip)
    return std::make_unique<ScipEmulator>(clock, view, settings.scip);
  return std::make_unique<LmsEmulator>(clock, view, settings.scanner);
}

}  // namespace

std::vector<std::string> RigSettings::scannerModels() {
  return {"lms291", "lms111", "lms511", "urg04lx", "utm30lx", "utm30lx-ew"};
}

// Ranges, noise and divergence of the beams by the makers' data sheets, rounded.
Status RigSettings::chooseScanner(std::string_view model) {
  beam = {};
  if (model == "lms291") {
    scanner_model = ScannerModel::Lms2xx;
    return {};
  }
  beam.interlaced = false;
  if (model == "lms111" || model == "lms511") {
    const bool large = model == "lms511";
    scanner_model = ScannerModel::Cola;
    cola = large ? ColaEmulatorSettings::lms5xx() : ColaEmulatorSettings::lms1xx();
    beam.divergence_rad = large ? 0.0047 : 0.015;
    beam.maximum_range_m = large ? 80.0 : 20.0;
    beam.sensitivity_m = large ? 40.0 : 18.0;
    beam.noise_m = large ? 0.007 : 0.012;
    // In the units that its telegrams hold.
    beam.resolution_m = 0.001 * static_cast<double>(cola.scale);
    beam.turn_s = 100.0 / cola.setting.frequency_chz;
    return {};
  }
  if (model == "urg04lx" || model == "utm30lx" || model == "utm30lx-ew") {
    const bool small = model == "urg04lx";
    scanner_model = ScannerModel::Scip;
    scip = small                ? ScipEmulatorSettings::urg04lx()
           : model == "utm30lx" ? ScipEmulatorSettings::utm30lx()
                                : ScipEmulatorSettings::utm30lxEw();
    beam.divergence_rad = small ? 0.01 : 0.0035;
    beam.maximum_range_m = small ? 5.6 : 30.0;
    beam.sensitivity_m = small ? 5.0 : 20.0;
    beam.noise_m = 0.01;
    beam.resolution_m = 0.001;
    beam.turn_s = 60.0 / scip.parameters.rpm;
    return {};
  }
  return fail("`" + std::string(model) + "` is no scanner that can be emulated", "emulated rig",
              "there are " + joined(scannerModels(), ", "));
}

std::string RigSettings::scannerUrl(const std::string& port) const {
  if (scanner_model == ScannerModel::Scip) return (scip.network ? "urg:tcp:" : "urg:") + port;
  return (scanner_model == ScannerModel::Cola ? "lms1xx:" : "lms2xx:") + port;
}

std::vector<std::string> RigSettings::tiltModels() {
  return {"mip50", "epos", "epos-v1", "epos-usb"};
}

Status RigSettings::chooseTilt(std::string_view model) {
  if (model == "mip50") {
    tilt_model = TiltModel::Mip50;
    return {};
  }
  tilt_model = TiltModel::Epos;
  if (model == "epos") {
    epos.protocol = EposProtocol::V2;
  } else if (model == "epos-usb") {
    epos.protocol = EposProtocol::V2Usb;
  } else if (model == "epos-v1") {
    epos.protocol = EposProtocol::V1;
    epos.baud = 38400;
  } else {
    return fail("`" + std::string(model) + "` is no tilt unit that can be emulated", "emulated rig",
                "there are " + joined(tiltModels(), ", "));
  }
  return {};
}

std::string RigSettings::tiltUrl(const std::string& port) const {
  return (tilt_model == TiltModel::Epos ? "epos:" : "mip50:") + port +
         "?level=" + std::to_string(levelCount());
}

std::int64_t RigSettings::levelCount() const {
  return tilt_model == TiltModel::Epos ? epos.levelCount() : tilt.levelCount();
}
double RigSettings::countsPerTurn() const {
  return tilt_model == TiltModel::Epos ? epos.counts_per_turn : tilt.counts_per_turn;
}

EmulatedRig::EmulatedRig(Clock& clock, Experiment experiment, RigSettings settings, DeviceWire& scanner_wire,
                         DeviceWire& tilt_wire)
    : experiment_(experiment),
      view_(std::move(experiment), settings),
      tilt_(makeTilt(clock, tilt_wire, settings)),
      scanner_(makeScanner(clock, view_, settings)) {
  scanner_->plug(&scanner_wire);
  scanner_->setTilt([this](Instant at) { return tilt_->angle(at); });
}

Status EmulatedRig::moveTo(int stop) {
  if (stop < 0 || stop >= experiment_.stops())
    return fail("there is no stop " + std::to_string(stop), std::string(nameOf(experiment_.id())),
                "its stops are 0 to " + std::to_string(experiment_.stops() - 1));
  view_.moveTo(stop);
  return {};
}

Status EmulatedRig::fault(const std::string& text) {
  const auto names = tilt_->knownFaults();
  if (std::ranges::find(names, text) != names.end()) return tilt_->applyFault(text);
  return scanner_->applyFault(text);
}

std::vector<std::string> EmulatedRig::faultNames() const {
  std::vector<std::string> names = scanner_->knownFaults();
  for (std::string& name : tilt_->knownFaults()) names.push_back(std::move(name));
  return names;
}

}  // namespace tiltmap
