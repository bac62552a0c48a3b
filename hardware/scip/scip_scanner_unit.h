// A Hokuyo URG or UTM, over USB, RS-232 or TCP, as capture wants it: streaming. SCIP 2.0.
//
// Written after what is public about the commands; no scanner was at hand.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "hardware/capture/device_clock.h"
#include "hardware/capture/scanner_unit.h"
#include "hardware/scip/scip_codec.h"
#include "hardware/transport/byte_channel.h"

namespace tiltmap {

struct ScipSettings {
  std::vector<int> bauds;    // tried in this order; empty: 115200, 19200, 38400. A network has none
  bool intensities = false;  // UTM types
  double latency_s = 0.002;  // what an adapter or a network may hold bytes back
};

class ScipScannerUnit : public ScannerUnit {
 public:
  using Opener = std::function<Result<std::unique_ptr<ByteChannel>>()>;
  // The clock must outlive the unit.
  ScipScannerUnit(Opener opener, Clock& clock, ScipSettings settings);
  ~ScipScannerUnit() override;

  const std::string& name() const override { return name_; }
  Status prepare(const JobControl& job) override;
  int columns() const override { return parameters_.columns(); }
  double azimuthStart() const override { return parameters_.azimuthStart(); }
  double azimuthStep() const override { return parameters_.azimuthStep(); }
  // Known where the scanner's clock could be read well enough; else it is captured line by line.
  double lineDuration() const override { return period_s_ > 0.0 ? turnDuration() : 0.0; }
  double turnDuration() const override { return parameters_.rpm > 0 ? 60.0 / parameters_.rpm : 0.0; }
  double linePeriod() const override { return period_s_; }
  Result<std::optional<ScannerEvent>> poll() override;
  Status release() override;
  std::vector<std::string> takeWarnings() override;
  std::vector<InstrumentFact> facts() const override {
    return {{"type", parameters_.model},
            {"turns", std::to_string(static_cast<int>(parameters_.rpm / 60.0 + 0.5)) + " a second"}};
  }

  // What it is, without letting it measure.
  struct Identity {
    scip::Properties version;
    scip::Parameters parameters;
    int baud = 0;
  };
  Result<Identity> identify(const JobControl& job);

 private:
  Status connect(const JobControl& job);
  Result<bool> answersAt(int baud, const JobControl& job);
  // Nothing where no answer came in time.
  Result<std::optional<scip::Reply>> ask(const std::string& command, const JobControl& job, double limit_s);
  Result<scip::Reply> demand(const std::string& command, const JobControl& job);
  Result<scip::Properties> properties(const std::string& command, const JobControl& job);
  Status receive();
  Status readClock(const JobControl& job);
  Status readRhythm(const JobControl& job);
  LineTimes timesOf(std::uint32_t time_ms);
  std::optional<ScannerEvent> beginning();
  Result<std::optional<ScannerEvent>> whole(const scip::Reply& reply);
  Status lost(Error error);

  Opener opener_;
  Clock& clock_;
  ScipSettings settings_;
  std::string name_ = "Hokuyo scanner";
  std::unique_ptr<ByteChannel> channel_;
  scip::Parameters parameters_;
  scip::ScanOrder order_;
  scip::ReplyReader reader_;
  std::vector<scip::ReplyReader::Item> items_;
  bool streaming_ = false;
  bool told_ = false;  // the scan under way has been announced
  Instant arrival_{};  // of the bytes that came last
  LineTimes times_;    // of the one that was announced
  DeviceClock device_clock_{1e-3, 24};
  // When its clock showed what, as it told on request; nothing where it did not or not well enough.
  struct Reading {
    Instant at;
    std::uint32_t time_ms;
  };
  std::optional<Reading> clock_reading_;
  Duration lag_{};         // from a scan's first beam to when device_clock_ has it
  double period_s_ = 0.0;  // from line to line, whole turns; 0: the instants of its beams are not known
  std::optional<ScannerEvent> held_;
};

}  // namespace tiltmap
