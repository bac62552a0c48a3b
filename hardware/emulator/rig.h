// Both instruments of a rig, emulated: the scanner on the tilt, at a stop of a simulated drive.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/world/experiment.h"
#include "hardware/emulator/cola_emulator.h"
#include "hardware/emulator/epos_emulator.h"
#include "hardware/emulator/lms_emulator.h"
#include "hardware/emulator/mip50_emulator.h"
#include "hardware/emulator/scip_emulator.h"

namespace tiltmap {

// What the rig consists of; the thesis had an LMS 291 on a MIP 50.
enum class ScannerModel { Lms2xx, Cola, Scip };
enum class TiltModel { Mip50, Epos };

struct RigSettings {
  ScannerModel scanner_model = ScannerModel::Lms2xx;
  TiltModel tilt_model = TiltModel::Mip50;
  // The sweep that lines are expected of. A line measured at such a tilt has the noise that the simulation
  // gives that row; the scanner itself does not know rows.
  double start_rad = -0.52359877559829887308;  // -30 deg
  double step_rad = 0.01396263401595463662;    // 0.8 deg
  LmsBeam beam;
  LmsEmulatorSettings scanner;
  ColaEmulatorSettings cola;
  ScipEmulatorSettings scip;
  Mip50EmulatorSettings tilt;
  EposEmulatorSettings epos;

  // "lms291", "urg04lx", "utm30lx"; over a network "lms111", "lms511", "utm30lx-ew". Fails for other words.
  // Sets the beam as well.
  Status chooseScanner(std::string_view model);
  static std::vector<std::string> scannerModels();
  // How the scanner at a port is named for a capture: "lms2xx:PORT".
  std::string scannerUrl(const std::string& port) const;
  // At a network instead of a serial port.
  bool scannerOverNetwork() const {
    return scanner_model == ScannerModel::Cola || (scanner_model == ScannerModel::Scip && scip.network);
  }

  // "mip50"; "epos" (protocol V2, 115200 Bd), "epos-v1" (38400 Bd), "epos-usb". Fails for other words.
  Status chooseTilt(std::string_view model);
  static std::vector<std::string> tiltModels();
  // How the tilt unit at a port is named for a capture: "mip50:PORT?level=312525".
  std::string tiltUrl(const std::string& port) const;

  // Of the tilt unit that is there.
  std::int64_t levelCount() const;
  double countsPerTurn() const;
};

// What the scanner sees from a stop.
class RigView : public SiteView {
 public:
  RigView(Experiment experiment, const RigSettings& settings);
  // Throws std::out_of_range for a stop that the drive does not have.
  void moveTo(int stop);
  int stop() const { return stop_; }
  std::vector<Echo> line(const ScannerGeometry& geometry, const TiltFunction& tilt, double start_time_s,
                         std::uint64_t key) override;
  // What is truly measured at a tilt that stands still: to compare with what was stored.
  std::vector<Echo> truth(const ScannerGeometry& geometry, double tilt_rad) const;

 private:
  RandomStream noise(double tilt_rad) const;
  Experiment experiment_;
  double start_rad_, step_rad_;
  LmsBeam beam_;
  int stop_ = 0;
  std::shared_ptr<const Site> site_;
};

class EmulatedRig {
 public:
  // Booted, at the first stop. The clock must outlive it; the wires as long as they are plugged in.
  EmulatedRig(Clock& clock, Experiment experiment, RigSettings settings, DeviceWire& scanner_wire,
              DeviceWire& tilt_wire);

  // While nothing acts.
  Status moveTo(int stop);
  int stop() const { return view_.stop(); }
  const Experiment& experiment() const { return experiment_; }
  // A fault of either instrument by its word, as faultNames() lists them.
  Status fault(const std::string& text);
  std::vector<std::string> faultNames() const;

  EmulatedScanner& scanner() { return *scanner_; }
  EmulatedTilt& tilt() { return *tilt_; }
  const RigView& view() const { return view_; }

 private:
  Experiment experiment_;
  RigView view_;
  std::unique_ptr<EmulatedTilt> tilt_;
  std::unique_ptr<EmulatedScanner> scanner_;
};

}  // namespace tiltmap
