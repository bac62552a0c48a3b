// A SICK LMS1xx, LMS5xx or TiM over TCP, as capture wants it: streaming. CoLa, dialect A.
//
// Written after what is public about the telegrams; no scanner was at hand. Nothing is stored in the scanner:
// what is set lasts until it is switched off.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "hardware/capture/device_clock.h"
#include "hardware/capture/scanner_unit.h"
#include "hardware/cola/cola_codec.h"

namespace tiltmap {

struct ColaSettings {
  // As the scanner is set where they are not given.
  std::optional<double> resolution_deg;
  std::optional<double> frequency_hz;
  double latency_s = 0.005;  // what the network may hold a telegram up at least
  double boot_s = 60.0;      // a scanner that was just switched on may take so long
};

class ColaScannerUnit : public ScannerUnit {
 public:
  using Opener = std::function<Result<std::unique_ptr<ByteChannel>>()>;
  // The clock must outlive the unit.
  ColaScannerUnit(Opener opener, Clock& clock, ColaSettings settings);
  ~ColaScannerUnit() override;

  const std::string& name() const override { return name_; }
  Status prepare(const JobControl& job) override;
  int columns() const override { return columns_; }
  double azimuthStart() const override { return azimuth_start_rad_; }
  double azimuthStep() const override { return azimuth_step_rad_; }
  // Known where its stamps make sense; without them it is captured line by line.
  double lineDuration() const override { return period_s_ > 0.0 ? turn_s_ : 0.0; }
  double turnDuration() const override { return turn_s_; }
  double linePeriod() const override { return period_s_; }
  Result<std::optional<ScannerEvent>> poll() override;
  Status release() override;
  std::vector<std::string> takeWarnings() override;
  std::vector<InstrumentFact> facts() const override {
    return {{"type", name_}, {"turns", std::to_string(static_cast<int>(1.0 / turn_s_ + 0.5)) + " a second"}};
  }

  // What it is and how it is set, without changing anything.
  struct Identity {
    std::string device;        // "LMS10x_FieldEval V1.31"
    std::optional<int> state;  // of STlms: 7 is ready
    cola::ScanSetting setting;
  };
  Result<Identity> identify(const JobControl& job);

 private:
  Status connect(const JobControl& job);
  Result<std::vector<std::string>> ask(const std::string& request, const JobControl& job,
                                       double limit_s = 2.0, int tries = 2);
  Error refused(const std::string& request, const std::string& code) const;
  Status speaksOtherDialect(const JobControl& job, Error otherwise);
  Status configure(const JobControl& job);
  Status startMeasuring(const JobControl& job);
  Result<std::optional<int>> state(const JobControl& job);
  Result<cola::ScanSetting> setting(const JobControl& job);
  Status awaitFirstScan(const JobControl& job);
  void readRhythm(const std::vector<cola::Scan>& scans);
  Status receive();
  Result<LineTaken> lineOf(const cola::Scan& scan);
  void watch(std::uint32_t device_status);
  Status lost(Error error);

  Opener opener_;
  Clock& clock_;
  ColaSettings settings_;
  std::string name_ = "SICK scanner";
  std::unique_ptr<ByteChannel> channel_;
  cola::Reader reader_;
  std::vector<cola::Reader::Item> items_;
  bool streaming_ = false;
  Instant arrival_{};  // of the bytes that came last
  DeviceClock device_clock_{1e-6, 32};
  double turn_s_ = 0.04;
  double period_s_ = 0.0;  // from line to line, whole turns; 0: its stamps do not tell
  int columns_ = 0;
  double azimuth_start_rad_ = 0.0, azimuth_step_rad_ = 0.0;
  std::optional<ScannerEvent> held_;
  std::vector<std::string> warnings_;
  std::uint32_t warned_ = 0;
};

}  // namespace tiltmap
