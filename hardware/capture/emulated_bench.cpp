#include <mutex>

#include "hardware/capture/instruments.h"
#include "hardware/capture/lms_scanner_unit.h"
#include "hardware/cola/cola_scanner_unit.h"
#include "hardware/emulator/terminal_rig.h"
#include "hardware/scip/scip_scanner_unit.h"
#include "hardware/tilt/epos_unit.h"
#include "hardware/tilt/mip50_unit.h"
#include "hardware/transport/memory_channel.h"
#include "hardware/transport/serial_port.h"
#include "hardware/transport/tcp_channel.h"

namespace tiltmap {

namespace {

LmsSettings scannerSettings(int baud) {
  LmsSettings settings;
  settings.baud = baud;
  settings.latency_s = 0.002;
  return settings;
}

TiltDrive driveOf(const RigSettings& settings) {
  TiltDrive drive;
  drive.counts_per_turn = settings.countsPerTurn();
  drive.level_count = settings.levelCount();
  return drive;
}

// The rate at which a program opens the port of the tilt unit.
int tiltBaud(const RigSettings& settings) {
  return settings.tilt_model == TiltModel::Epos ? settings.epos.baud : settings.tilt.baud;
}

std::unique_ptr<TiltUnit> tiltUnit(const RigSettings& settings, std::unique_ptr<ByteChannel> channel,
                                   Clock& clock) {
  if (settings.tilt_model == TiltModel::Epos)
    return std::make_unique<EposUnit>(std::move(channel), clock, driveOf(settings));
  return std::make_unique<Mip50Unit>(std::move(channel), clock, driveOf(settings));
}

std::unique_ptr<ScannerUnit> scannerUnit(const RigSettings& settings,
                                         std::function<Result<std::unique_ptr<ByteChannel>>()> opener,
                                         Clock& clock, int baud) {
  if (settings.scanner_model == ScannerModel::Cola)
    return std::make_unique<ColaScannerUnit>(std::move(opener), clock, ColaSettings{});
  if (settings.scanner_model == ScannerModel::Scip)
    return std::make_unique<ScipScannerUnit>(
        std::move(opener), clock, ScipSettings{.bauds = {}, .intensities = settings.scip.intensities});
  return std::make_unique<LmsScannerUnit>(std::move(opener), clock, scannerSettings(baud));
}

class MemoryBench : public EmulatedBench {
 public:
  MemoryBench(Experiment experiment, const RigSettings& settings, int baud)
      : baud_(baud),
        settings_(settings),
        scanner_wire_(MemoryPair::make(clock_, "emulated scanner")),
        tilt_wire_(MemoryPair::make(clock_, "emulated tilt")),
        rig_(clock_, std::move(experiment), settings, *scanner_wire_.device, *tilt_wire_.device) {
    clock_.attach(rig_.scanner());
    clock_.attach(rig_.tilt());
  }
  ~MemoryBench() override {
    clock_.detach(rig_.scanner());
    clock_.detach(rig_.tilt());
  }

  Clock& clock() override { return clock_; }
  Instruments instruments() override {
    Instruments instruments;
    instruments.clock = &clock_;
    instruments.open_scanner = [this]() -> Result<std::unique_ptr<ScannerUnit>> {
      return scannerUnit(
          settings_,
          [this]() -> Result<std::unique_ptr<ByteChannel>> {
            MemoryPair pair = MemoryPair::make(clock_, "emulated scanner",
                                               settings_.scannerOverNetwork() ? Pacing::None : Pacing::Baud);
            if (settings_.scannerOverNetwork())
              if (Status status = pair.host->setLine({100'000'000, Parity::None}); !status)
                return fail(status.error());
            rig_.scanner().plug(pair.device.get());
            scanner_wire_ = std::move(pair);
            return std::move(scanner_wire_.host);
          },
          clock_, baud_);
    };
    instruments.open_tilt = [this]() -> Result<std::unique_ptr<TiltUnit>> {
      MemoryPair pair = MemoryPair::make(clock_, "emulated tilt");
      if (Status status = pair.host->setLine({tiltBaud(settings_), Parity::None}); !status)
        return fail(status.error());
      rig_.tilt().rewire(*pair.device);
      tilt_wire_ = std::move(pair);
      return tiltUnit(settings_, std::move(tilt_wire_.host), clock_);
    };
    return instruments;
  }
  Status moveTo(int stop) override { return rig_.moveTo(stop); }
  Status fault(const std::string& text) override { return rig_.fault(text); }
  void unplug() override {
    scanner_wire_.unplug();
    tilt_wire_.unplug();
  }
  EmulatedRig& rig() override { return rig_; }

 private:
  VirtualClock clock_;
  int baud_;
  RigSettings settings_;
  MemoryPair scanner_wire_, tilt_wire_;
  EmulatedRig rig_;
};

class TerminalBench : public EmulatedBench {
 public:
  static Result<std::unique_ptr<EmulatedBench>> make(Experiment experiment, const RigSettings& settings,
                                                     double speed, int baud) {
    auto clock = std::make_unique<RealClock>(speed);
    auto rig = TerminalRig::open(*clock, std::move(experiment), settings);
    if (!rig) return fail(rig.error());
    auto bench = std::make_unique<TerminalBench>();
    bench->clock_ = std::move(clock);
    bench->rig_ = std::move(*rig);
    bench->settings_ = settings;
    bench->baud_ = baud;
    return bench;
  }

  Clock& clock() override { return *clock_; }
  Instruments instruments() override {
    Instruments instruments;
    instruments.clock = clock_.get();
    instruments.open_scanner = [this]() -> Result<std::unique_ptr<ScannerUnit>> {
      return scannerUnit(
          settings_, [this] { return openScanner(); }, *clock_, baud_);
    };
    instruments.open_tilt = [this]() -> Result<std::unique_ptr<TiltUnit>> {
      auto channel = open(port(false), tiltBaud(settings_));
      if (!channel) return fail(channel.error());
      return tiltUnit(settings_, std::move(*channel), *clock_);
    };
    return instruments;
  }
  Status moveTo(int stop) override { return rig_->moveTo(stop); }
  Status fault(const std::string& text) override {
    const std::lock_guard lock(ports_mutex_);
    return rig_->fault(text);
  }
  void unplug() override {
    (void)fault("unplug-scanner");
    (void)fault("unplug-tilt");
  }
  EmulatedRig& rig() override { return rig_->rig(); }

 private:
  // Another one after a plug was pulled.
  std::string port(bool scanner) {
    const std::lock_guard lock(ports_mutex_);
    return scanner ? rig_->scannerPort() : rig_->tiltPort();
  }
  Result<std::unique_ptr<ByteChannel>> openScanner() {
    if (!settings_.scannerOverNetwork()) return open(port(true), 9600);
    const auto address = parseTcpAddress(port(true), 0);
    if (!address) return fail(address.error());
    auto channel = TcpChannel::connect(*address, *clock_);
    if (!channel) return fail(channel.error());
    return std::move(*channel);
  }
  Result<std::unique_ptr<ByteChannel>> open(const std::string& port, int baud) {
    auto channel = SerialPort::open(port, {baud, Parity::None}, *clock_);
    if (!channel) return fail(channel.error());
    return std::move(*channel);
  }

  std::unique_ptr<RealClock> clock_;
  std::mutex ports_mutex_;  // faults may be ordered by another thread than the drivers'
  std::unique_ptr<TerminalRig> rig_;
  RigSettings settings_;
  int baud_ = 38400;
};

}  // namespace

Result<std::unique_ptr<EmulatedBench>> EmulatedBench::make(Experiment experiment, const RigSettings& settings,
                                                           double speed, int scanner_baud) {
  if (speed > 0.0)
    if (auto bench = TerminalBench::make(experiment, settings, speed, scanner_baud)) return bench;
  return std::make_unique<MemoryBench>(std::move(experiment), settings, scanner_baud);
}

}  // namespace tiltmap
