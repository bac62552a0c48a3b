// A tilt without a motor: the operator sets each angle and confirms it.
#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "hardware/tilt/tilt_unit.h"

namespace tiltmap {

// Asks a person and waits for the answer; what was typed, without its line end. Looks at the stop token and
// then fails with kCancelled. Called on a thread of its own.
using AskOperator = std::function<Result<std::string>(const std::string& question, std::stop_token stop)>;

// The answer is empty (it stands where it should) or the angle in degrees that the operator reads off.
class ManualTiltUnit : public TiltUnit {
 public:
  ManualTiltUnit(Clock& clock, AskOperator ask, double minimum_rad, double maximum_rad);
  ~ManualTiltUnit() override;

  const std::string& name() const override { return name_; }
  Status prepare(const JobControl& job) override;
  Status checkAngle(double angle_rad) const override;
  Status moveTo(double angle_rad) override;
  Result<std::optional<TiltReading>> poll() override;
  void stop() override;
  Status release() override { return {}; }

 private:
  struct Question;
  void dismiss();
  Clock& clock_;
  AskOperator ask_;
  double minimum_rad_, maximum_rad_;
  std::string name_ = "tilt set by hand";
  double target_rad_ = 0.0;
  std::shared_ptr<Question> question_;
  std::jthread asker_;
  std::optional<TiltReading> reading_;
};

}  // namespace tiltmap
