// From what a command line names to instruments that can be opened, real or emulated.
#pragma once

#include <memory>
#include <string>

#include "hardware/capture/sweep.h"
#include "hardware/cola/cola_scanner_unit.h"
#include "hardware/emulator/rig.h"
#include "hardware/scip/scip_scanner_unit.h"
#include "hardware/tilt/epos_unit.h"
#include "hardware/tilt/manual_unit.h"
#include "hardware/transport/device_url.h"

namespace tiltmap {

// "lms2xx:PORT?baud=38400" and "mip50:PORT?level=312525", "epos:PORT" or "manual:". Checks the words, the
// table file of a MIP 50 and its drive, and opens nothing yet; each opening looks for the port anew. `ask`
// may be empty where no tilt is set by hand. The clock must outlive what is opened.
Result<Instruments> namedInstruments(const std::string& scanner_url, const std::string& tilt_url,
                                     RealClock& clock, AskOperator ask);

// The same of two recordings that were made together ("lms2xx:replay:FILE"), on one clock. On a virtual one
// the tilt is never later than it was then, however busy the machine is; a recording in which lines had to be
// taken again because it was too late may come out another way, and then ends with an error.
Result<Instruments> replayedInstruments(const std::string& scanner_url, const std::string& tilt_url,
                                        Clock& clock);

// A scanner at a network with the options of "lms1xx:HOST?...". The clock must outlive it.
Result<std::unique_ptr<ColaScannerUnit>> colaUnit(const DeviceUrl& url, ColaScannerUnit::Opener opener,
                                                  Clock& clock);
// A Hokuyo with the options of "urg:PORT?...". The clock must outlive it.
Result<std::unique_ptr<ScipScannerUnit>> scipUnit(const DeviceUrl& url, ScipScannerUnit::Opener opener,
                                                  Clock& clock);
// An EPOS with the options of "epos:PORT?...", behind a channel that is open. The clock must outlive it.
Result<std::unique_ptr<EposUnit>> eposUnit(const DeviceUrl& url, std::unique_ptr<ByteChannel> channel,
                                           Clock& clock);

// An emulated rig and the clock it lives on.
class EmulatedBench {
 public:
  // speed above 0: over pseudo terminals, so many times as fast as the instruments are. 0: in memory, on a
  // virtual clock, as fast as the machine can; the same bytes and times every run. Where there are no
  // pseudo terminals it is in memory as well.
  // The drivers work at scanner_baud.
  static Result<std::unique_ptr<EmulatedBench>> make(Experiment experiment, const RigSettings& settings,
                                                     double speed, int scanner_baud = 38400);
  virtual ~EmulatedBench() = default;

  virtual Clock& clock() = 0;
  // Its drive knows where level is.
  virtual Instruments instruments() = 0;
  virtual Status moveTo(int stop) = 0;
  // In real time by any thread.
  virtual Status fault(const std::string& text) = 0;
  // Pulls both plugs; opening an instrument finds it again.
  virtual void unplug() = 0;
  // Not while real time runs: for tests in memory.
  virtual EmulatedRig& rig() = 0;
};

}  // namespace tiltmap
