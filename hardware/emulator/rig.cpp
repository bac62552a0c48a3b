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
  return std::make_unique<LmsEmulator>(clock, view, settings.scanner);
}

}  // namespace

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
