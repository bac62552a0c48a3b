// A scanner that is nothing but a clock: it sends what a function makes up. For tests.
#pragma once

#include <cmath>
#include <functional>

#include "hardware/capture/scanner_unit.h"

namespace tiltmap {

class MemoryScanner : public ScannerUnit {
 public:
  // Makes the line that is measured from that instant on.
  using Source = std::function<LineTaken(Instant from)>;

  MemoryScanner(Clock& clock, int columns, Source source, double period_s = 0.21312, double wire_s = 0.1906)
      : clock_(clock),
        columns_(columns),
        source_(std::move(source)),
        period_(durationOf(period_s)),
        wire_(durationOf(wire_s)) {}

  const std::string& name() const override { return name_; }
  Status prepare(const JobControl&) override {
    if (trouble_) return fail(*trouble_);
    sending_ = true;
    next_ = begin(clock_.now()) + period_;
    under_way_.reset();
    return {};
  }
  int columns() const override { return columns_; }
  double azimuthStart() const override { return 0.0; }
  double azimuthStep() const override { return 3.14159265358979323846 / (columns_ - 1); }
  double lineDuration() const override { return secondsOf(kMeasuring); }
  double turnDuration() const override { return 0.5 * secondsOf(kMeasuring); }
  double linePeriod() const override { return secondsOf(period_); }
  Result<std::optional<ScannerEvent>> poll() override {
    if (trouble_) return fail(*trouble_);
    if (!sending_ || silent_) return std::nullopt;
    const Instant now = clock_.now();
    if (under_way_ && now >= *under_way_ + wire_) {
      under_way_.reset();
      if (spoil_ > 0) {
        --spoil_;
        return ScannerEvent(LineSpoiled{"made so"});
      }
      return ScannerEvent(std::move(line_));
    }
    if (!under_way_ && now >= next_) {
      const Instant sent = begin(now);
      next_ = sent + period_;
      under_way_ = sent;
      line_ = source_(sent - kMeasuring);
      line_.measured = {sent - kMeasuring, sent};
      return ScannerEvent(LineBegun{{sent - kMeasuring, sent}});
    }
    return std::nullopt;
  }
  Status release() override {
    sending_ = false;
    return {};
  }

  void setTrouble(std::optional<Error> trouble) { trouble_ = std::move(trouble); }
  void setSilent(bool silent) { silent_ = silent; }
  void spoil(int lines) { spoil_ = lines; }

  static constexpr Duration kMeasuring = std::chrono::microseconds(26640);

 private:
  // The telegram under way at an instant began then.
  Instant begin(Instant at) const { return Instant{} + at.time_since_epoch() / period_ * period_; }

  Clock& clock_;
  int columns_;
  Source source_;
  Duration period_, wire_;
  std::string name_ = "scanner in memory";
  std::optional<Error> trouble_;
  bool sending_ = false, silent_ = false;
  int spoil_ = 0;
  Instant next_{};
  std::optional<Instant> under_way_;
  LineTaken line_;
};

}  // namespace tiltmap
