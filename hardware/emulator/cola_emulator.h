// A SICK LMS1xx or LMS5xx seen from the network: CoLa, dialect A.
#pragma once

#include "hardware/cola/cola_codec.h"
#include "hardware/emulator/line_scanner_emulator.h"

namespace tiltmap {

struct ColaEmulatorSettings {
  std::string type = "LMS111", version = "V1.30";
  cola::ScanSetting setting;  // 270 deg by 0.5, 50 Hz
  float scale = 1.0F;         // millimetres a unit; 2 for the LMS5xx
  bool intensities = true;
  bool measuring = true;  // else it has to be started
  double start_s = 3.0;   // until its mirror measures
  std::string password = "F4724744";
  bool binary = false;       // speaks dialect B, of which it knows just its name
  bool has_state = true;     // a TiM has no STlms
  LineScannerTiming timing;  // turn_s follows the setting

  static ColaEmulatorSettings lms1xx();
  static ColaEmulatorSettings lms5xx();
  // What it can be set to: none for sets that its mirror cannot do.
  bool allows(const cola::ScanSetting& wanted) const;
};

class ColaEmulator : public LineScannerEmulator {
 public:
  ColaEmulator(const Clock& clock, SiteView& view, ColaEmulatorSettings settings = {});
  const cola::ScanSetting& setting() const { return settings_.setting; }
  bool loggedIn() const { return logged_in_; }

 private:
  void hear(std::span<const Byte> bytes, Instant now) override;
  void forgetOrders() override;
  void forgetSettings() override;
  bool streaming() const override { return streaming_ && ready_at_ <= now_; }
  ByteVector lineTelegram(const SentLine& line, Instant now) override;
  const ScannerGeometry& geometry() const override { return geometry_; }
  bool garbles() const override { return false; }
  void obey(const std::string& request, Instant now);
  void say(const std::string& text, Instant now);
  void sayScan(Instant now);
  std::string configured(const cola::ScanSetting& wanted);
  void applySetting();
  cola::Scan scanOf(const SentLine& line, Instant now);

  ColaEmulatorSettings settings_;
  cola::ScanSetting at_power_on_;
  ScannerGeometry geometry_;
  cola::Reader reader_;
  bool streaming_ = false, logged_in_ = false, measuring_ = true;
  Instant ready_at_{}, now_{};
  std::uint32_t telegrams_ = 0;
};

}  // namespace tiltmap
