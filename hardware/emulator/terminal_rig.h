// The emulated rig behind pseudo terminals: any serial program may talk to it.
#pragma once

#include <memory>
#include <string>

#include "hardware/emulator/emulator_thread.h"
#include "hardware/emulator/rig.h"
#include "hardware/transport/pseudo_terminal.h"

namespace tiltmap {

// Runs on a thread of its own from the moment both ports are there. Calls of one thread.
class TerminalRig {
 public:
  // Links to make to the terminals; empty: none. Of a scanner at a network, the number of the port to listen
  // at. The clock must outlive it.
  static Result<std::unique_ptr<TerminalRig>> open(RealClock& clock, Experiment experiment,
                                                   const RigSettings& settings,
                                                   const std::string& scanner_link = {},
                                                   const std::string& tilt_link = {});

  // "/dev/pts/5", after a plug was pulled another one; "127.0.0.1:2111".
  const std::string& scannerPort() const { return scanner_->name(); }
  const std::string& tiltPort() const { return tilt_->name(); }

  int stop();
  Status moveTo(int stop);
  // A fault of either instrument, or "unplug-scanner", "unplug-tilt": the port goes and comes back at once
  // under another name (its link follows); in a network the connection ends.
  Status fault(const std::string& text);
  std::vector<std::string> faultNames() const;
  // For tests; look at nothing that changes while it runs.
  EmulatedRig& rig() { return rig_; }

 private:
  TerminalRig(RealClock& clock, Experiment experiment, const RigSettings& settings,
              std::unique_ptr<DeviceWire> scanner, std::unique_ptr<DeviceWire> tilt, std::string scanner_link,
              std::string tilt_link);
  Status replug(std::unique_ptr<DeviceWire>& terminal, const std::string& link, bool scanner);

  RealClock& clock_;
  std::string scanner_link_, tilt_link_;
  std::unique_ptr<DeviceWire> scanner_, tilt_;
  EmulatedRig rig_;
  EmulatorThread thread_;  // last: ends before what it runs
};

}  // namespace tiltmap
