// A Hokuyo URG or UTM seen from the wire: SCIP 2.0.
#pragma once

#include "hardware/emulator/line_scanner_emulator.h"
#include "hardware/scip/scip_codec.h"

namespace tiltmap {

struct ScipEmulatorSettings {
  scip::Parameters parameters;  // of an URG-04LX
  std::string product = "SOKUIKI Sensor URG-04LX", firmware = "3.3.00", serial = "H0508486";
  bool network = false;
  int baud = 0;               // of RS-232; 0: USB or a network, which have none
  bool intensities = false;   // knows ME
  bool old_firmware = false;  // speaks SCIP 1 until it is told SCIP2.0
  bool other_check = false;   // counts the semicolon into the check characters of VV and PP
  LineScannerTiming timing;   // turn_s follows the parameters

  static ScipEmulatorSettings urg04lx();
  static ScipEmulatorSettings utm30lx();
  static ScipEmulatorSettings utm30lxEw();
};

class ScipEmulator : public LineScannerEmulator {
 public:
  ScipEmulator(const Clock& clock, SiteView& view,
               ScipEmulatorSettings settings = ScipEmulatorSettings::urg04lx());
  bool laserOn() const { return laser_; }
  int rate() const { return baud_; }

 private:
  void hear(std::span<const Byte> bytes, Instant now) override;
  void forgetOrders() override;
  void forgetSettings() override;
  bool streaming() const override { return order_.has_value(); }
  ByteVector lineTelegram(const SentLine& line, Instant now) override;
  const ScannerGeometry& geometry() const override { return geometry_; }
  int baud() const override { return baud_; }
  bool garbles() const override { return !settings_.network; }
  void obey(const std::string& command, Instant now);
  void order(const std::string& command, const scip::ScanOrder& order, Instant now);
  void say(const std::string& echo, const std::string& status, std::vector<std::string> lines, Instant now);
  std::vector<std::string> described(const scip::Properties& properties) const;
  scip::ScanData dataOf(const SentLine& line, const scip::ScanOrder& order) const;

  ScipEmulatorSettings settings_;
  ScannerGeometry geometry_;
  int baud_ = 0;
  std::string line_;
  bool laser_ = false, adjusting_ = false, scip2_ = true;
  std::optional<scip::ScanOrder> order_;
  int sent_ = 0, turns_ = 0;
};

}  // namespace tiltmap
