// A tilt unit that is nothing but numbers: for tests, and for looking at a capture without a controller.
#pragma once

#include <algorithm>

#include "hardware/tilt/tilt_unit.h"

namespace tiltmap {

class MemoryTiltUnit : public TiltUnit {
 public:
  MemoryTiltUnit(Clock& clock, TiltDrive drive)
      : clock_(clock), drive_(drive), name_("tilt unit in memory") {}

  const std::string& name() const override { return name_; }
  Status prepare(const JobControl&) override {
    if (trouble_) return fail(*trouble_);
    ready_ = true;
    return {};
  }
  Status checkAngle(double angle_rad) const override {
    if (angle_rad >= drive_.minimum_rad && angle_rad <= drive_.maximum_rad) return {};
    return fail("the tilt lies outside the limits", name_, "choose another");
  }
  Status moveTo(double angle_rad) override {
    if (trouble_) return fail(*trouble_);
    if (!ready_) return fail("the tilt is not ready", name_, "prepare it first");
    if (Status status = checkAngle(angle_rad); !status) return status;
    const std::int64_t target = drive_.countsOf(angle_rad);
    double duration = 0.0;
    std::int64_t at = counts_;
    for (const std::int64_t station : segmentsOf(drive_, counts_, target)) {
      duration += drive_.moveDuration(static_cast<double>(station - at));
      at = station;
    }
    started_ = clock_.now();
    arrival_ = started_ + durationOf(duration);
    before_ = counts_;
    counts_ = target;
    ++moves_;
    return {};
  }
  Result<std::optional<TiltReading>> poll() override {
    if (trouble_) return fail(*trouble_);
    if (clock_.now() < arrival_) return std::nullopt;
    return TiltReading{drive_.angleOf(counts_), counts_, arrival_ + durationOf(drive_.settle_s)};
  }
  void stop() override { arrival_ = std::min(arrival_, clock_.now()); }
  Status release() override {
    ready_ = false;
    return {};
  }

  // Every call fails with it, until nothing is given.
  void setTrouble(std::optional<Error> trouble) { trouble_ = std::move(trouble); }
  int moves() const { return moves_; }
  // Where it is, halfway while it moves.
  double angle(Instant at) const {
    const double there = drive_.angleOf(counts_);
    return at >= arrival_ ? there : 0.5 * (there + drive_.angleOf(before_));
  }

 private:
  Clock& clock_;
  TiltDrive drive_;
  std::string name_;
  std::optional<Error> trouble_;
  bool ready_ = false;
  std::int64_t counts_ = 0, before_ = 0;
  Instant started_{}, arrival_{};
  int moves_ = 0;
};

}  // namespace tiltmap
