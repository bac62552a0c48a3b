// A tilt unit that is nothing but numbers: for tests, and for looking at a capture without a controller.
#pragma once

#include <algorithm>
#include <cmath>

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
    steady_.reset();
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
  SteadySpeed steadySpeed(double wished_rad_s) const override {
    const double rate = std::min(wished_rad_s, fastest());
    return {rate, 0.001 * drive_.speed / drive_.acceleration * rate / fastest(), drive_.approach_rad};
  }
  Status moveSteadily(double angle_rad, double rate_rad_s) override {
    if (trouble_) return fail(*trouble_);
    if (Status status = checkAngle(angle_rad); !status) return status;
    const SteadySpeed speed = steadySpeed(rate_rad_s);
    steady_ = SteadyMotion{clock_.now(), drive_.angleOf(counts_), drive_.angleOf(drive_.countsOf(angle_rad)),
                           speed.rate_rad_s, speed.ramp_s};
    started_ = clock_.now();
    before_ = counts_;
    counts_ = drive_.countsOf(angle_rad);
    arrival_ = steady_->end();
    ++moves_;
    return {};
  }
  std::optional<SteadyMotion> steadyMotion() const override { return steady_; }
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
    if (steady_ && at < arrival_ && at >= steady_->start) return steady_->angle(at);
    const double there = drive_.angleOf(counts_);
    return at >= arrival_ ? there : 0.5 * (there + drive_.angleOf(before_));
  }

 private:
  double fastest() const {
    return 1000.0 * drive_.speed * 2.0 * 3.14159265358979323846 / std::abs(drive_.counts_per_turn);
  }
  Clock& clock_;
  TiltDrive drive_;
  std::string name_;
  std::optional<Error> trouble_;
  bool ready_ = false;
  std::int64_t counts_ = 0, before_ = 0;
  Instant started_{}, arrival_{};
  std::optional<SteadyMotion> steady_;
  int moves_ = 0;
};

}  // namespace tiltmap
